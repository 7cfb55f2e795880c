//! solve: what the kernel proves, against its twin from the same bytes, for cameras of pieces; and lines of `project` with its help.

use crate::common::cameras::{MeshShape, glc_of_each_class, mesh_camera, pinhole};
use crate::common::needs;
use crate::common::projection::gpu;
use crate::common::rng::Rng;
use crate::common::{ALL_T, FORWARD, camera};
use anamorph::internals::camera::kinds::glc::Glc;
use anamorph::internals::camera::project::Projector;
use anamorph::internals::camera::spec::CameraKind;
use anamorph::internals::camera::{Camera, Rays};
use anamorph::internals::engine::plan::solve::SolveTable;
use anamorph::internals::engine::stage::solve::Solve;
use anamorph::internals::engine::stage::splat::Splat;
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::kernels::{File, Files};
use anamorph::internals::gpu::layout::NONE;
use anamorph_lab::twin::solve::solve;
use glam::DVec3;

const SIZE: (u32, u32) = (120, 88);

/// With the share of random points of which all is proven, at least.
fn cameras() -> Vec<(String, Camera, f64)> {
    let mut all = vec![(
        "pinhole".to_string(),
        camera(pinhole(DVec3::new(0.3, 0.4, 4.0), DVec3::ZERO, 40.0), SIZE, FORWARD),
        0.99,
    )];
    for (name, kind) in glc_of_each_class() {
        all.push((name.into(), camera(kind, SIZE, ALL_T), 0.9));
    }
    for seed in 0..20 {
        let mut rng = Rng(seed);
        let near = [0; 3].map(|_| 3.0 * rng.vector());
        let far = [0; 3].map(|_| 3.0 * rng.vector());
        all.push((format!("glc {seed}"), camera(CameraKind::new("glc", Glc { near, far }), SIZE, ALL_T), 0.9));
        let range = [rng.signed(), 1.0 + rng.unit()];
        all.push((
            format!("glc {seed} in {range:?}"),
            camera(CameraKind::new("glc", Glc { near, far }), SIZE, range),
            0.9,
        ));
    }
    for weights in [false, true] {
        let shape = MeshShape { weights, discontinuous: weights, ..Default::default() };
        // of pieces torn apart a point has some 60 candidates, and all must be proven
        let least = if weights { 0.3 } else { 0.9 };
        all.push((format!("{shape:?}"), camera(mesh_camera(3, 20, 15, shape), SIZE, FORWARD), least));
    }
    all
}

/// In the middle of the scene, far off, on rays through pixels' corners and borders of pieces, on eyes, and none at all.
fn points(camera: &Camera, seed: u64, count: usize) -> Vec<DVec3> {
    let mut rng = Rng(seed);
    (0..count)
        .map(|k| match k % 8 {
            0..4 => 0.6 * rng.vector(),
            4 => 40.0 * rng.vector(),
            5 => 1e5 * rng.vector(),
            _ => {
                let (i, j) = (rng.below(camera.width as usize) as u32, rng.below(camera.height as usize) as u32);
                let t = if k % 16 == 6 { 0.0 } else { 4.0 * rng.signed() };
                camera.ray(i, j).map_or(DVec3::NAN, |r| r.origin + t * r.direction)
            }
        })
        .collect()
}

#[test]
fn proven_images_are_those_of_the_twin_and_nothing_is_lost() {
    let Some(gpu) = gpu() else { return };
    let mut seen = [0; 4];
    for (name, camera, least) in cameras() {
        let projector = Projector::new(&camera);
        let Rays::Pieces(pieces) = &camera.layers[0] else { panic!("{name}") };
        let table = SolveTable::new(&camera, pieces, projector.trees().next().unwrap());
        let points = points(&camera, 7, 2000);
        let mut kernel = Solve::new(gpu, &projector).unwrap();
        kernel.adapt(&points).unwrap();
        let started = kernel.start(&points).unwrap();
        let found = kernel.finish(started).unwrap();
        let (mut proven, mut random, mut worst) = (0, 0, 0.0_f64);
        for (k, point) in points.iter().enumerate() {
            random += usize::from(k % 8 < 4);
            let Some(images) = found.images(0, k) else { continue };
            proven += usize::from(k % 8 < 4);
            seen[images.len().min(3)] += 1;
            // each is the twin's, within its bounds
            for image in images {
                let twin = solve(&table.pieces[image.piece as usize], &table.point(*point)).unwrap();
                let is_it = |r: &&anamorph_lab::twin::solve::Through| {
                    let off = (r.place_px - glam::DVec2::new(image.x_px.into(), image.y_px.into())).abs().max_element();
                    off <= f64::from(image.error_px) && (r.t - f64::from(image.t)).abs() <= f64::from(image.error_t)
                };
                let same = twin.iter().filter(is_it).count();
                assert_eq!(same, 1, "{name}: {point}: {image:?} of {twin:?}");
                worst = worst.max(image.error_px.into());
                if image.pixel != NONE {
                    let p = &table.pieces[image.piece as usize];
                    let (x, y) =
                        (f64::from(p.base_x) + f64::from(image.x_px), f64::from(p.base_y) + f64::from(image.y_px));
                    assert_eq!(image.pixel, y.floor() as u32 * camera.width + x.floor() as u32, "{name}: {image:?}");
                }
            }
            // and the host finds as many
            let host = projector.project(*point);
            assert_eq!(host.degenerate, None, "{name}: {point} has {images:?}");
            assert_eq!(host.images.len(), images.len(), "{name}: {point}: {host:?} {images:?}");
            for (a, b) in host.images.iter().zip(images) {
                assert_eq!(a.piece, b.piece, "{name}: {point}");
                let p = &table.pieces[b.piece as usize];
                let off = (a.x - f64::from(p.base_x) - f64::from(b.x_px))
                    .abs()
                    .max((a.y - f64::from(p.base_y) - f64::from(b.y_px)).abs());
                assert!(off <= f64::from(b.error_px), "{name}: {point}: {a:?} {b:?}");
                assert!((a.t - f64::from(b.t)).abs() <= f64::from(b.error_t), "{name}: {point}: {a:?} {b:?}");
            }
        }
        let share = proven as f64 / random as f64;
        println!("{name}: {share:.4} proven, error up to {worst:.2e} px");
        assert!(share > least, "{name}: {share}");
    }
    println!("points with 0, 1, 2, 3 images: {seen:?}");
    assert!(seen[0] > 1000 && seen[1] > 1000 && seen[2] > 100 && seen[3] > 0, "{seen:?}");
}

#[test]
fn a_wrong_piece_is_found_out() {
    let camera = camera(pinhole(DVec3::new(0.3, 0.4, 4.0), DVec3::ZERO, 40.0), SIZE, FORWARD);
    let projector = Projector::new(&camera);
    let Rays::Pieces(pieces) = &camera.layers[0] else { unreachable!() };
    let table = SolveTable::new(&camera, pieces, projector.trees().next().unwrap());
    let point = DVec3::new(0.1, 0.2, -0.3);
    let right = solve(&table.pieces[0], &table.point(point)).unwrap();
    let own = projector.project(point).images[0];
    let at = right.iter().find(|r| (r.t - own.t).abs() < 1e-5).unwrap();
    // what f32 has rounded
    assert!((at.place_px.x + f64::from(table.pieces[0].base_x) - own.x).abs() < 1e-3);
    let mut wrong = table.pieces[0];
    wrong.p1[0] += 1e-3;
    let other = solve(&wrong, &table.point(point)).unwrap();
    assert!(other.iter().all(|r| (r.place_px - at.place_px).length() > 1e-4), "{other:?}");
}

#[test]
fn lines_with_its_help_are_the_same() {
    let Some(gpu) = gpu() else { return };
    for (name, camera, _) in cameras() {
        let projector = Projector::new(&camera);
        let mut points = points(&camera, 9, 1000);
        points.extend([DVec3::NAN, DVec3::INFINITY, 1e30 * DVec3::ONE, DVec3::ZERO, DVec3::new(0.3, 0.4, 4.0)]);
        let mut kernel = Solve::new(gpu, &projector).unwrap();
        let started = kernel.start(&points).unwrap();
        let found = kernel.finish(started).unwrap();
        for (k, point) in points.iter().enumerate() {
            let lines = [projector.project(*point), projector.project_below(*point, |layer| found.nodes(layer, k))]
                .map(|images| serde_json::to_string(&images).unwrap());
            assert_eq!(lines[0], lines[1], "{name}: {point}");
        }
    }
}

/// A point that is left out is hidden: each pixel's nearest in f64 is one of those that the kernels leave.
#[test]
fn the_nearest_point_of_each_pixel_is_left() {
    let Some(gpu) = gpu() else { return };
    for (name, camera, _) in cameras() {
        let projector = Projector::new(&camera);
        let points: Vec<DVec3> = (0..12_000)
            .map({
                let mut rng = Rng(3);
                move |_| 0.6 * rng.vector()
            })
            .collect();
        let mut splat = Splat::new(gpu, &projector).unwrap().unwrap();
        splat.adapt(&points).unwrap();
        let mut left = vec![false; points.len()];
        for (part, chunk) in points.chunks(5000).enumerate() {
            let started = splat.start(chunk).unwrap();
            splat.finish(started).unwrap().into_iter().for_each(|k| left[part * 5000 + k] = true);
        }
        let mut nearest = vec![(f64::INFINITY, usize::MAX); (SIZE.0 * SIZE.1) as usize];
        for (k, point) in points.iter().enumerate() {
            for image in projector.project(*point).images {
                let (x, y) = ((image.x as usize).min(SIZE.0 as usize - 1), (image.y as usize).min(SIZE.1 as usize - 1));
                let own = &mut nearest[y * SIZE.0 as usize + x];
                if image.t < own.0 {
                    *own = (image.t, k);
                }
            }
        }
        assert!(nearest.iter().all(|(_, k)| *k == usize::MAX || left[*k]), "{name}");
        let count = left.iter().filter(|l| **l).count();
        println!(
            "{name}: {count} of {} left, {} pixels",
            points.len(),
            nearest.iter().filter(|n| n.1 != usize::MAX).count()
        );
    }
}

/// What the kernels say of some cameras' points, against the host.
fn compared(gpu: &Gpu) -> Result<(), String> {
    for (name, camera, _) in cameras().into_iter().take(12).step_by(3) {
        let projector = Projector::new(&camera);
        let points: Vec<DVec3> = points(&camera, 11, 3000).into_iter().filter(|p| p.is_finite()).collect();
        let mut solve = Solve::new(gpu, &projector).unwrap();
        let table_of = |solve: &Solve, k: u32| solve.table(0).unwrap().pieces[k as usize];
        let started = solve.start(&points).unwrap();
        let found = solve.finish(started).unwrap();
        for (k, point) in points.iter().enumerate() {
            let host = projector.project(*point);
            if projector.project_below(*point, |layer| found.nodes(layer, k)) != host {
                return Err(format!("{name}: {point} lost images"));
            }
            let Some(images) = found.images(0, k) else { continue };
            for (a, b) in host.images.iter().zip(images) {
                let piece = table_of(&solve, b.piece);
                let (x, y) = (a.x - f64::from(piece.base_x), a.y - f64::from(piece.base_y));
                let off = (x - f64::from(b.x_px)).abs().max((y - f64::from(b.y_px)).abs());
                if off > f64::from(b.error_px) || (a.t - f64::from(b.t)).abs() > f64::from(b.error_t) {
                    return Err(format!("{name}: {point}: {a:?} is beyond the bounds of {b:?}"));
                }
            }
        }
        let splat = Splat::new(gpu, &projector).unwrap().unwrap();
        let started = splat.start(&points).unwrap();
        let left = splat.finish(started).unwrap();
        let mut nearest = vec![(f64::INFINITY, usize::MAX); (SIZE.0 * SIZE.1) as usize];
        for (k, point) in points.iter().enumerate() {
            for image in projector.project(*point).images {
                let (x, y) = ((image.x as usize).min(SIZE.0 as usize - 1), (image.y as usize).min(SIZE.1 as usize - 1));
                let own = &mut nearest[y * SIZE.0 as usize + x];
                *own = if image.t < own.0 { (image.t, k) } else { *own };
            }
        }
        if nearest.iter().any(|(_, k)| *k != usize::MAX && !left.contains(k)) {
            return Err(format!("{name}: a nearest point is left out"));
        }
    }
    Ok(())
}

#[test]
fn errors_planted_in_the_kernels_are_noticed() {
    let Some(mut gpu) = needs::adapter() else { return };
    compared(&gpu).unwrap();
    for (name, right, wrong) in [
        ("project/solved/pieces.wgsl", "is_done = all(b > zero) || all(b < -zero);", "is_done = b.x > zero.x;"),
        (
            "project/solved/pieces.wgsl",
            "is_outside = is_outside || along < -(margin",
            "is_outside = is_outside || along < 0.5 - (margin",
        ),
        ("project/chart.wgsl", "if least > error * (", "if least > -1e4 * error * ("),
        ("project/prove.wgsl", "let need = 1.01 * f * rows;", "let need = 0.001 * f * rows;"),
        ("claim.wgsl", "image.t + image.error_t", "image.t - 0.1"),
        ("contend.wgsl", "<= nearest[image.pixel]", "> nearest[image.pixel]"),
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
