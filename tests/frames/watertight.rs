//! Surfaces without holes are drawn without holes, and no pixel belongs to two triangles that join there. Nothing to do
//! without an adapter.

use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::camera::kinds::glc::Glc;
use anamorph::internals::camera::kinds::orthographic::Orthographic;
use anamorph::internals::camera::spec::CameraKind;
use anamorph::internals::geometry::generate;
use anamorph::internals::geometry::mesh::Mesh;
use anamorph::internals::image::frame::NO_ID;
use common::cameras::{glc_of_each_class, pinhole};
use common::gpu::{Without, ids, render_with};
use common::rng::Rng;
use common::{FORWARD, camera, mesh, moved, picked, scene, unjoined};
use glam::DVec3;

const SIZE: (u32, u32) = (96, 72);

/// Asserts that every pixel of `inside` is hit by exactly one triangle: the whole mesh leaves no hole, and of two halves
/// of its triangles, however they are drawn, each pixel is hit in one and not in the other. False without an
/// adapter.
fn assert_hit_once(name: &str, mesh: &Mesh, camera: &Camera, seed: u64, inside: impl Fn(u32, u32) -> bool) -> bool {
    let mut rng = Rng(seed);
    let n = mesh.triangles.len();
    let pixels =
        || (0..camera.height).flat_map(|j| (0..camera.width).map(move |i| (i, j))).filter(|&(i, j)| inside(i, j));
    let hits = |order: &[usize]| {
        let frame = render_with(&scene(picked(mesh, order)), camera, Without::Nothing, &Default::default())?.frame;
        let hit = |(i, j): (u32, u32)| ids(&frame)[(j * camera.width + i) as usize] != NO_ID;
        Some(pixels().map(hit).collect::<Vec<bool>>())
    };
    let all: Vec<usize> = (0..n).collect();
    let Some(whole) = hits(&all) else { return false };
    let holes: Vec<_> = pixels().zip(&whole).filter(|(_, hit)| !**hit).map(|(p, _)| p).take(5).collect();
    assert!(holes.is_empty(), "{name}: holes at {holes:?}");
    for partition in 0..3 {
        // even and odd ids first, then any halves
        let (mut left, mut right): (Vec<usize>, Vec<usize>) =
            all.iter().partition(|&&k| if partition == 0 { k % 2 == 0 } else { rng.below(2) == 0 });
        left.sort_unstable();
        right.sort_unstable();
        let (Some(a), Some(b)) = (hits(&left), hits(&right)) else { return false };
        let wrong: Vec<_> = pixels().zip(a.iter().zip(&b)).filter(|(_, (a, b))| a == b).take(5).collect();
        assert!(wrong.is_empty(), "{name}, seed {seed}, partition {partition}: hit in both or neither: {wrong:?}");
    }
    true
}

/// Cameras whose rays all start inside the ball of radius 1/2 about `at`: pinholes and a GLC of each class.
fn cameras_inside(at: DVec3) -> Vec<(String, Camera)> {
    let mut list: Vec<(String, CameraKind)> = [DVec3::X, DVec3::Y, DVec3::new(-1.0, -0.4, 0.8)]
        .into_iter()
        .map(|to| (format!("pinhole towards {to}"), pinhole(at, at + to, 110.0)))
        .collect();
    for (name, kind) in glc_of_each_class() {
        let Some(&Glc { near, far }) = kind.recipe() else { unreachable!() };
        let placed = |v: [DVec3; 3]| v.map(|p| at + 0.1 * p);
        list.push((name.into(), CameraKind::new("glc", Glc { near: placed(near), far: placed(far) })));
    }
    list.into_iter().map(|(name, kind)| (name, camera(kind, SIZE, FORWARD))).collect()
}

/// A box of side 2 about the origin, each face divided into unequal cells.
fn divided_box() -> Mesh {
    let mut cube = generate::cube();
    cube.positions.iter_mut().for_each(|p| *p *= 2.0);
    cube.normals.clear();
    cube.corner_normals.clear();
    for _ in 0..3 {
        let mut triangles = Vec::new();
        for t in &cube.triangles {
            let [a, b, c] = t.map(|k| cube.positions[k as usize]);
            let k = cube.positions.len() as u32;
            cube.positions.push((a + b + c) / 3.0);
            triangles.extend([[t[0], t[1], k], [t[1], t[2], k], [t[2], t[0], k]]);
        }
        cube.triangles = triangles;
    }
    cube.material_of = vec![0; cube.triangles.len()];
    cube
}

#[test]
#[ignore = "slow: make test-all"]
fn convex_shells_from_inside_at_any_offset() {
    for offset in [0.0, 1e3, 1e6] {
        let at = offset * DVec3::new(1.0, -0.7, 0.3);
        let ball = generate::icosphere(3);
        for (name, shell) in
            [("ball", ball.clone()), ("ball of doubled seams", unjoined(&ball)), ("box", divided_box())]
        {
            for (view, camera) in cameras_inside(at) {
                let name = format!("{name} at {offset} by {view}");
                if !assert_hit_once(&name, &moved(shell.clone(), at), &camera, 1, |_, _| true) {
                    return;
                }
            }
        }
    }
}

#[test]
fn a_dented_ball_from_its_middle() {
    let mut rng = Rng(2);
    let mut ball = generate::icosphere(4);
    // along its own ray from the middle every surface stays single
    ball.positions.iter_mut().for_each(|p| *p *= 1.0 + 0.4 * rng.signed());
    for to in [DVec3::X, DVec3::NEG_Y, DVec3::new(1.0, 2.0, 3.0)] {
        let camera = camera(pinhole(DVec3::ZERO, to, 100.0), SIZE, FORWARD);
        if !assert_hit_once("dented ball", &ball, &camera, 3, |_, _| true) {
            return;
        }
    }
}

/// Pixels per side of the aligned pictures; halves and sixty-fourths make every number below exact.
const ALIGNED: u32 = 64;

/// Cameras whose pixel rays are exact in f64: steps of powers of two, no rotation.
fn exact_cameras() -> Vec<(&'static str, Camera)> {
    let side = ALIGNED as f64;
    let v = DVec3::new;
    let orthographic = CameraKind::new(
        "orthographic",
        Orthographic { eye: v(0.0, 0.0, 8.0), target: DVec3::ZERO, up: DVec3::Y, height: side },
    );
    let glc = |near, far| CameraKind::new("glc", Glc { near, far });
    // every ray through the origin: a pinhole whose angles need no tangent
    let central = glc([DVec3::ZERO; 3], [v(-32.0, 32.0, -1.0), v(32.0, 32.0, -1.0), v(-32.0, -32.0, -1.0)]);
    let cross_slit = glc(
        [v(0.0, 0.0, 0.0), v(64.0, 0.0, 0.0), v(0.0, 16.0, 0.0)],
        [v(0.0, 0.0, -1.0), v(32.0, 0.0, -1.0), v(0.0, 64.0, -1.0)],
    );
    let bilinear = glc(
        [v(0.0, 0.0, 0.0), v(64.0, 0.0, 0.0), v(0.0, 64.0, 0.0)],
        [v(0.0, 0.0, -1.0), v(64.0, 8.0, -1.0), v(-8.0, 64.0, -1.0)],
    );
    let list =
        [("orthographic", orthographic), ("pinhole", central), ("cross-slit", cross_slit), ("bilinear", bilinear)];
    list.into_iter().map(|(name, kind)| (name, camera(kind, (ALIGNED, ALIGNED), FORWARD))).collect()
}

/// The point of the ray of pixel place (i, j), beyond the image too, at `t`: exact for small dyadic t.
fn on_ray(camera: &Camera, i: i32, j: i32, t: f64) -> DVec3 {
    let (_, b) = camera.pixel(0, 0, 0).unwrap();
    let ray = b.ray(i as f64, j as f64);
    ray.origin + t * ray.direction
}

/// Two triangles for each cell between every `step`th pixel, every corner on its pixel's ray, at t near `depth`.
fn pixel_grid(camera: &Camera, rng: &mut Rng, step: i32, depth: f64) -> Mesh {
    let n = ALIGNED as i32 / step + 5;
    let place = |k: i32| (k - 2) * step;
    let mut positions = Vec::new();
    for (i, j) in (0..n).flat_map(|j| (0..n).map(move |i| (i, j))) {
        // few bits, so that the corner is on the ray exactly
        let t = depth * (1.0 + rng.below(8) as f64 / 256.0);
        positions.push(on_ray(camera, place(i), place(j), t));
    }
    let mut triangles = Vec::new();
    for (i, j) in (0..n - 1).flat_map(|j| (0..n - 1).map(move |i| (i as u32, j as u32))) {
        let k = j * n as u32 + i;
        let below = k + n as u32;
        let halves = if rng.below(2) == 0 {
            [[k, k + 1, below], [below + 1, k + 1, below]]
        } else {
            [[k, k + 1, below + 1], [k, below + 1, below]]
        };
        triangles.extend(halves.map(|[a, b, c]| [[a, b, c], [b, c, a], [c, b, a]][rng.below(3)]));
    }
    mesh(positions, triangles)
}

#[test]
fn corners_and_edges_exactly_on_pixel_centres() {
    for (name, camera) in exact_cameras() {
        for (seed, step) in (0..).zip([1, 2, 4, 8]) {
            let mut rng = Rng(seed);
            let grid = pixel_grid(&camera, &mut rng, step, 4.0);
            let name = format!("{name}, a corner every {step} px");
            if !assert_hit_once(&name, &grid, &camera, seed, |_, _| true) {
                return;
            }
            if !assert_hit_once(&format!("{name}, doubled"), &unjoined(&grid), &camera, seed, |_, _| true) {
                return;
            }
        }
    }
}

/// A fan of triangles about a corner within `off` px of one pixel's centre, for every eighth pixel each way.
fn fans(camera: &Camera, rng: &mut Rng, off: f64) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (i, j) in (4..ALIGNED as i32).step_by(8).flat_map(|j| (4..ALIGNED as i32).step_by(8).map(move |i| (i, j))) {
        let apex = positions.len() as u32;
        let (_, b) = camera.pixel(0, 0, 0).unwrap();
        let ray = b.ray(i as f64 + off * rng.signed(), j as f64 + off * rng.signed());
        positions.push(ray.origin + 4.0 * ray.direction);
        let n = 4 + rng.below(8) as u32;
        for k in 0..n {
            let angle = (k as f64 + 0.4 * rng.signed()) * std::f64::consts::TAU / n as f64;
            let radius = 2.5 + rng.signed();
            let ray = b.ray(i as f64 + radius * angle.cos(), j as f64 + radius * angle.sin());
            positions.push(ray.origin + (4.0 + 0.1 * rng.signed()) * ray.direction);
        }
        for k in 0..n {
            let t = [apex, apex + k + 1, apex + (k + 1) % n + 1];
            triangles.push([[t[0], t[1], t[2]], [t[1], t[2], t[0]], [t[0], t[2], t[1]]][rng.below(3)]);
        }
    }
    mesh(positions, triangles)
}

#[test]
fn the_pixel_at_the_corner_of_a_fan_belongs_to_one_triangle() {
    for (name, camera) in exact_cameras() {
        // on the centre, and off by so little that no sign is proven
        for (seed, off) in (0..).zip([0.0, 0.0, 0.0, 0.0, 1e-15, 1e-14, 1e-13]) {
            let fans = fans(&camera, &mut Rng(seed), off);
            let apex = |i: u32, j: u32| i % 8 == 4 && j % 8 == 4;
            if !assert_hit_once(&format!("fans off by {off:e} px by {name}"), &fans, &camera, seed, apex) {
                return;
            }
        }
    }
}

#[test]
fn corners_within_rounding_of_a_pixel_centre_are_on_it_for_all_their_edges() {
    // between the signs that f64 proves and those it does not
    for (name, camera) in exact_cameras() {
        for (seed, power) in (0..).zip(3..=14) {
            let fans = fans(&camera, &mut Rng(seed), 10f64.powi(-power));
            let apex = |i: u32, j: u32| i % 8 == 4 && j % 8 == 4;
            if !assert_hit_once(&format!("fans off by 1e-{power} px by {name}"), &fans, &camera, seed, apex) {
                return;
            }
        }
    }
}

#[test]
fn an_aligned_grid_far_from_the_origin() {
    // corners meant for pixel centres, off by what f64 rounds at `offset`: 2^-53 of it, up to 1e-6 px here
    for (offset, height) in [(1e3, 0.64), (1e4, 0.64), (1e4, 6.4), (1e6, 64.0), (1e6, 6.4), (1e7, 64.0)] {
        let target = offset * DVec3::new(1.1, -0.7, 0.3);
        let eye = target + DVec3::new(0.0, 0.0, height);
        let kind = CameraKind::new("orthographic", Orthographic { eye, target, up: DVec3::Y, height });
        let camera = camera(kind, (ALIGNED, ALIGNED), FORWARD);
        let grid = pixel_grid(&camera, &mut Rng(1), 1, height);
        let name = format!("a grid at {offset:e}, {height} high");
        if !assert_hit_once(&name, &grid, &camera, 1, |_, _| true) {
            return;
        }
    }
}
