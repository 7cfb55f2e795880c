//! solve, of curves between control surfaces: what the kernel proves, against its twin from the same bytes and against the host; and lines of
//! `project` and pictures of points with its help.

use crate::common::needs;
use crate::common::projection::gpu;
use crate::common::rng::Rng;
use crate::common::written;
use anamorph::internals::camera::project::Projector;
use anamorph::internals::camera::{Camera, Curves, Rays};
use anamorph::internals::engine::plan::solve::cells::CellTable;
use anamorph::internals::engine::stage::solve::{Solve, Solved};
use anamorph::internals::engine::stage::splat::Splat;
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::kernels::{File, Files};
use anamorph::internals::gpu::layout::{NONE, SolveImage};
use anamorph::internals::jobs::project::project_many;
use anamorph::internals::jobs::splat::splat;
use anamorph_lab::twin::solve_cell::solve_cell;
use glam::{DVec2, DVec3};

/// The last tiles are cut off.
const SIZE: (u32, u32) = (404, 243);

/// Errors of cameras between planes, px: what f32 rounds.
const ROUNDED_PX: f64 = 0.01;

/// With the share of points seen in the image of which all is proven, at least.
fn cameras() -> Vec<(String, Camera, f64)> {
    let mut all = Vec::new();
    for (table, least) in [
        ("kind = 'twist'\nangle = 60\ndegree = 2", 0.97),
        ("kind = 'twist'\nangle = -200\ndegree = 3", 0.97),
        ("kind = 'curved_convergence'\nbend = [0.5, -0.25]", 0.97),
        ("kind = 'ortho_to_perspective'\nblend = [[0, 1], [0.5, 0.25]]", 0.97),
        ("kind = 'street'\nviews = [{ at = 0.3, width = 0.4, angle = 80, turn = 10 }]", 0.4),
        // about the pole rays end in one place
        ("kind = 'occlusion'\njoin = 'bezier'\ndistortion = [0.02, 0.05]", 0.6),
        (
            "kind = 'projector'\nsurfaces = [{ kind = 'cylinder', center = [0, 0, 0], axis = [0, 1, 0], radius = 1, height = 2, from = -50, to = 60 },
            { kind = 'sphere', center = [0, 0, 0], radius = 2, lon = [-60, 50], lat = [40, -40] },
            { kind = 'cylinder', center = [0, 0, 0.5], axis = [0, 1, 0], radius = 4, height = 5, from = -40, to = 50 }]",
            0.9,
        ),
        (
            "kind = 'projector'\nsurfaces = [{ kind = 'disc', center = [0, 0, 2], normal = [0, 0, 1], radius = 1 }, { kind = 'disc', center = [0.3, 0, 0], normal = [0, 0, 1], radius = 1.5 },
            { kind = 'disc', center = [0, 0, -2], normal = [0, 0, 1], radius = 2 }]",
            0.8,
        ),
    ] {
        all.push((table.to_string(), written::camera(table, SIZE), least));
    }
    // the middle surface turns the image over to the left of its middle
    let folded =
        "kind = 'projector'\nsurfaces = [{ kind = 'plane', origin = [-1, 1, 2], u = [2, 0, 0], v = [0, -2, 0] },
        { kind = 'bezier', points = [[[2, 1, 0], [-4, 1, 0.3], [2, 1, 0]], [[2, -1, 0], [-4, -1, 0.5], [2, -1, 0.2]]] },
        { kind = 'plane', origin = [-1, 1, -2], u = [2, 0, 0], v = [0, -2, 0] }]";
    all.push(("folded".to_string(), written::camera(folded, SIZE), 0.97));
    for seed in 0..8 {
        let least = if seed < 4 { 0.97 } else { 0.9 };
        let table = random_volume(seed, if seed < 4 { 0.25 } else { 0.8 });
        all.push((format!("random volume {seed}"), written::camera(&table, SIZE), least));
    }
    all
}

/// Three or four Bezier patches of degrees 1 to 3, each point moved by up to `off` of the distance between surfaces: a large one folds them.
fn random_volume(seed: u64, off: f64) -> String {
    let mut rng = Rng(seed);
    let surfaces: Vec<String> = (0..3 + seed % 2)
        .map(|k| {
            let [columns, rows] = [0, 1].map(|_| 2 + rng.below(3));
            let point = |i: usize, j: usize, rng: &mut Rng| {
                let share = DVec2::new(i as f64 / (columns - 1) as f64 - 0.5, 0.5 - j as f64 / (rows - 1) as f64);
                let p = (2.0 * share * (1.0 + 0.3 * k as f64)).extend(2.0 - 1.3 * k as f64) + off * rng.vector();
                format!("[{}, {}, {}]", p.x, p.y, p.z)
            };
            let row = |j: usize, rng: &mut Rng| {
                let all: Vec<String> = (0..columns).map(|i| point(i, j, rng)).collect();
                format!("[{}]", all.join(", "))
            };
            let all: Vec<String> = (0..rows).map(|j| row(j, &mut rng)).collect();
            format!("{{ kind = 'bezier', points = [{}] }}", all.join(", "))
        })
        .collect();
    format!("kind = 'projector'\nsurfaces = [{}]", surfaces.join(", "))
}

/// A place where the volume folds over: slopes turn about between it and the next one. `None`: none found.
fn fold(curves: &Curves, rng: &mut Rng) -> Option<(DVec2, f64)> {
    let (y, t, width) = (f64::from(curves.height) * rng.unit(), rng.unit(), f64::from(curves.width));
    let turn = |x: f64| {
        let at = |dx: f64, dy: f64| Some(curves.at_place(DVec2::new(x + dx, y + dy))?.1);
        let along = |dx: f64, dy: f64| Some(at(dx, dy)?.at(t) - at(-dx, -dy)?.at(t));
        Some(along(0.01, 0.0)?.cross(along(0.0, 0.01)?).dot(at(0.0, 0.0)?.tangent(t)) > 0.0)
    };
    let places = (1..40).map(|k| width * f64::from(k) / 40.0);
    let start = places.clone().zip(places.skip(1)).find(|(a, b)| turn(*a).zip(turn(*b)).is_some_and(|(a, b)| a != b));
    let (mut a, mut b) = start?;
    for _ in 0..40 {
        let middle = 0.5 * (a + b);
        *if turn(middle)? == turn(a)? { &mut a } else { &mut b } = middle;
    }
    Some((DVec2::new(a, y), t))
}

/// Seen somewhere, near what is seen, far off; at corners of pixels and tiles at ends of spans; at folds; on borders of the image and of t,
/// and just beyond them.
fn points(camera: &Camera, seed: u64, count: usize) -> Vec<DVec3> {
    let mut rng = Rng(seed);
    let Rays::Curves(curves) = &camera.layers[0] else { panic!("{}", camera.kind) };
    let size = DVec2::new(camera.width.into(), camera.height.into());
    (0..count)
        .map(|k| {
            let (mut place, mut t) = (size * DVec2::new(rng.unit(), rng.unit()), rng.unit());
            let mut off = DVec3::ZERO;
            match k % 8 {
                0..4 => {}
                4 if k % 16 == 4 => {
                    // the other image is as far on the other side
                    if let Some((at, of)) = fold(curves, &mut rng) {
                        (place, t) = (at + DVec2::new(1.5 * rng.signed().powi(3), 0.0), of);
                    }
                }
                4 => off = 0.3 * rng.vector(),
                5 => off = 1e3 * rng.vector(),
                6 => {
                    place = if k % 16 == 6 { place.round() } else { 8.0 * (place / 8.0).round() };
                    t = if k % 32 < 16 { (8.0 * t).round() / 8.0 } else { t };
                }
                _ => {
                    let beyond = [0.0, 1e-10, 1e-3, -1e-6][rng.below(4)];
                    match rng.below(4) {
                        0 => place.x = size.x + beyond,
                        1 => place.y = -beyond,
                        2 => t = -beyond,
                        _ => t = 1.0 + beyond,
                    }
                }
            }
            curves.at_place(place).map_or(DVec3::NAN, |(_, c)| c.at(t) + off)
        })
        .collect()
}

fn found_in(gpu: &Gpu, projector: &Projector, points: &[DVec3]) -> (CellTable, Solved) {
    let camera = projector.camera();
    let Rays::Curves(curves) = &camera.layers[0] else { panic!("{}", camera.kind) };
    let table = CellTable::new(camera, curves, projector.trees().next().unwrap());
    let mut kernel = Solve::with_curves(gpu, projector).unwrap();
    kernel.adapt(points).unwrap();
    let started = kernel.start(points).unwrap();
    let found = kernel.finish(started).unwrap();
    (table, found)
}

/// u, v and s of an image, and its error.
fn place_in_cell(table: &CellTable, image: &SolveImage) -> (DVec3, DVec3) {
    let cell = &table.cells[image.piece as usize];
    let s = 16.0 * (f64::from(image.t) - f64::from(cell.middle));
    let error = f64::from(image.error_px) / 4.0;
    (
        DVec3::new(f64::from(image.x_px) / 4.0, f64::from(image.y_px) / 4.0, s),
        DVec3::new(error, error, 16.0 * f64::from(image.error_t)),
    )
}

#[test]
#[ignore = "slow: make test-all"]
fn proven_images_are_those_of_the_twin() {
    let Some(gpu) = gpu() else { return };
    for (name, camera, _) in cameras() {
        let projector = Projector::new(&camera);
        let points = points(&camera, 5, 24);
        let (table, found) = found_in(gpu, &projector, &points);
        let (mut of_twin, mut proven, mut unknown) = (0, 0, 0);
        for (k, point) in points.iter().enumerate() {
            let Some(images) = found.images(0, k) else { continue };
            // in every cell, and on no border of one: there the image is one of two cells by the rest that the twin leaves out
            let mut all = Vec::new();
            for (number, cell) in table.cells.iter().enumerate() {
                let end = DVec3::new(cell.end[0].into(), cell.end[1].into(), 1.0);
                match solve_cell(cell, &table.point(*point), DVec3::splat(-1.0), end) {
                    Some(roots) => all.extend(roots.into_iter().map(|r| (number, r))),
                    None => unknown += 1,
                }
            }
            for image in images {
                let (at, error) = place_in_cell(&table, image);
                let is_it = |(number, r): &&(usize, DVec3)| {
                    *number == image.piece as usize && (*r - at).abs().cmple(error).all()
                };
                assert_eq!(all.iter().filter(is_it).count(), 1, "{name}: {point}: {image:?} of {all:?}");
            }
            assert_eq!(all.len(), images.len(), "{name}: {point}: {images:?} of {all:?}");
            of_twin += all.len();
            proven += 1;
        }
        println!("{name}: {proven} points proven, {of_twin} images");
        assert!(of_twin > 8 && unknown == 0, "{name}: {of_twin} images, {unknown} cells not searched");
    }
}

#[test]
fn a_wrong_cell_is_found_out() {
    let camera = written::camera("kind = 'twist'\nangle = 60\ndegree = 2", SIZE);
    let projector = Projector::new(&camera);
    let Rays::Curves(curves) = &camera.layers[0] else { unreachable!() };
    let table = CellTable::new(&camera, curves, projector.trees().next().unwrap());
    let point = curves.at_place(DVec2::new(21.3, 34.8)).unwrap().1.at(0.32);
    let number = (4 * 51 + 2) * 8 + 2;
    let cell = &table.cells[number];
    let roots = |cell| solve_cell(cell, &table.point(point), DVec3::splat(-1.0), DVec3::ONE).unwrap();
    let [at] = roots(cell)[..] else { panic!() };
    // what f32 has rounded
    assert!(
        (4.0 * at.x + f64::from(cell.base_x) - 21.3).abs() < 1e-4
            && (4.0 * at.y + f64::from(cell.base_y) - 34.8).abs() < 1e-4
    );
    assert!((f64::from(cell.middle) + at.z / 16.0 - 0.32).abs() < 1e-5);
    let mut wrong = *cell;
    wrong.terms[4][0] *= 1.01;
    assert!(roots(&wrong).iter().all(|r| (*r - at).length() > 1e-4));
}

#[test]
#[ignore = "slow: make test-all"]
fn nothing_is_lost_and_images_are_the_hosts() {
    let Some(gpu) = gpu() else { return };
    let mut seen = [0; 4];
    for (name, camera, least) in cameras() {
        let projector = Projector::new(&camera);
        // where many rays end in a place, or are steep, the host takes 10 ms for a point
        let is_slow = ["'street'", "'occlusion'", "'disc'"].iter().any(|kind| name.contains(kind));
        let points = points(&camera, 7, if is_slow { 400 } else { 2000 });
        let (table, found) = found_in(gpu, &projector, &points);
        let (mut proven, mut all, mut worst) = (0, 0, 0.0_f64);
        for (k, point) in points.iter().enumerate() {
            all += usize::from(k % 8 < 4);
            let host = projector.project(*point);
            let lines = [host.clone(), projector.project_below(*point, |layer| found.nodes(layer, k))]
                .map(|images| serde_json::to_string(&images).unwrap());
            assert_eq!(lines[0], lines[1], "{name}: {point}");
            let Some(images) = found.images(0, k) else { continue };
            proven += usize::from(k % 8 < 4);
            seen[images.len().min(3)] += 1;
            assert_eq!(host.degenerate, None, "{name}: {point} has {images:?}");
            same_images(&table, &host.images, images).unwrap_or_else(|e| panic!("{name}: point {k} {point}: {e}"));
            for image in images {
                worst = worst.max(image.error_px.into());
                if image.pixel != NONE {
                    let place = table.place_px(image);
                    assert_eq!(
                        image.pixel,
                        place.y.floor() as u32 * SIZE.0 + place.x.floor() as u32,
                        "{name}: {image:?}"
                    );
                }
            }
        }
        let share = proven as f64 / all as f64;
        println!("{name}: {share:.4} proven, error up to {worst:.2e} px");
        assert!(share > least, "{name}: {share}");
        let is_of_planes = ["'twist'", "'curved_convergence'"].iter().any(|kind| name.contains(kind));
        assert!(worst < if is_of_planes { ROUNDED_PX } else { 0.5 }, "{name}: {worst}");
    }
    println!("points with 0, 1, 2, 3 images: {seen:?}");
    assert!(seen[0] > 1000 && seen[1] > 1000 && seen[2] > 100, "{seen:?}");
}

/// Each of the host's images is within the bounds of one of the kernel's, and there are no more.
fn same_images(
    table: &CellTable,
    host: &[anamorph::internals::camera::project::Image],
    images: &[SolveImage],
) -> Result<(), String> {
    if host.len() != images.len() {
        return Err(format!("{host:?} are not {images:?}"));
    }
    for image in images {
        let place = table.place_px(image);
        let is_it = |a: &&anamorph::internals::camera::project::Image| {
            let off = (DVec2::new(a.x, a.y) - place).abs().max_element();
            off <= f64::from(image.error_px) && (a.t - f64::from(image.t)).abs() <= f64::from(image.error_t)
        };
        if host.iter().filter(is_it).count() != 1 {
            return Err(format!("{image:?} at {place} is beyond its bounds of {host:?}"));
        }
    }
    Ok(())
}

#[test]
#[ignore = "slow: make test-all"]
fn numbers_within_a_bound_and_pictures_of_points() {
    let Some(gpu) = gpu() else { return };
    for (name, camera, _) in cameras().into_iter().step_by(4).filter(|c| !c.0.contains("'street'")) {
        let projector = Projector::new(&camera);
        let points: Vec<DVec3> = points(&camera, 11, 3000);
        let [host, same, near] = [(None, 0.0), (Some(gpu), 0.0), (Some(gpu), 0.1)]
            .map(|(gpu, within)| project_many(&projector, &points, gpu, within).unwrap());
        assert!(host.x == same.x && host.y == same.y && host.t == same.t && host.first == same.first, "{name}");
        assert!(same.by_kernel == 0 && near.by_kernel > 1000, "{name}: {}", near.by_kernel);
        assert_eq!((&host.first, &host.piece), (&near.first, &near.piece), "{name}");
        for k in 0..host.x.len() {
            let off = (host.x[k] - near.x[k]).abs().max((host.y[k] - near.y[k]).abs());
            assert!(off <= 0.1 && (host.t[k] - near.t[k]).abs() < 0.05, "{name}: image {k} is off by {off} px");
        }
        let [without, with] = [None, Some(gpu)].map(|gpu| splat(&camera, &points, gpu).unwrap());
        assert!(without.index == with.index && without.t == with.t, "{name}");
        println!(
            "{name}: {} of {} points by the kernel alone; {} hidden",
            near.by_kernel,
            points.len(),
            with.by_kernel
        );
    }
}

/// Surfaces without bounds, other layers: all is left to the host.
#[test]
fn what_has_no_bounds_is_left_to_the_host() {
    let Some(gpu) = gpu() else { return };
    let nurbs = "kind = 'nurbs', degree = 2, weights = [[1, 1, 1], [1, 3, 1], [1, 1, 1]], points";
    let rows = |z: f64| {
        format!(
            "[[[-1, 1, {z}], [0, 1, {z}], [1, 1, {z}]], [[-1, 0, {z}], [0, 0, {z}], [1, 0, {z}]], [[-1, -1, {z}], [0, -1, {z}], [1, -1, {z}]]]"
        )
    };
    let table = format!(
        "kind = 'projector'\nsurfaces = [{{ {nurbs} = {} }}, {{ {nurbs} = {} }}, {{ {nurbs} = {} }}]",
        rows(1.0),
        rows(0.2),
        rows(-1.0)
    );
    let camera = written::camera(&table, SIZE);
    let projector = Projector::new(&camera);
    let solve = Solve::with_curves(gpu, &projector).unwrap();
    assert!(!solve.solves(0) && Splat::new(gpu, &projector).unwrap().is_none());
    let points = points(&camera, 3, 200);
    let [host, near] =
        [(None, 0.0), (Some(gpu), 0.1)].map(|(gpu, within)| project_many(&projector, &points, gpu, within).unwrap());
    assert_eq!(host, near);
}

/// What the kernels say of some cameras' points, against the host.
fn compared(gpu: &Gpu) -> Result<(), String> {
    for (name, camera, _) in cameras().into_iter().filter(|c| ["folded", "random volume 6"].contains(&c.0.as_str())) {
        let projector = Projector::new(&camera);
        let points: Vec<DVec3> = points(&camera, 13, 3000).into_iter().filter(|p| p.is_finite()).collect();
        let (table, found) = found_in(gpu, &projector, &points);
        for (k, point) in points.iter().enumerate() {
            let Some(images) = found.images(0, k) else { continue };
            let host = projector.project(*point);
            same_images(&table, &host.images, images).map_err(|e| format!("{name}: {point}: {e}"))?;
        }
    }
    Ok(())
}

#[test]
fn errors_planted_in_the_kernel_are_noticed() {
    let Some(mut gpu) = needs::adapter() else { return };
    compared(&gpu).unwrap();
    for (name, right, wrong) in [
        ("project/solved/curves.wgsl", "found.within = 1.01 * (", "found.within = 0.01 * ("),
        ("project/solved/curves.wgsl", "found.within += bent;", "found.within += 0.0 * bent;"),
    ] {
        let own = Files::own().get(name).unwrap();
        assert_eq!(own.text.matches(right).count(), 1, "{name}: {right}");
        let text: &'static str = Box::leak(own.text.replace(right, wrong).into_boxed_str());
        gpu.replaced = vec![Box::leak(Box::new(File::new(name, text)))];
        let said = compared(&gpu);
        assert!(said.is_err(), "nobody notices {wrong:?} in {name}");
        println!("{wrong}: {}", said.unwrap_err());
    }
}
