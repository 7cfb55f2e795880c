//! Triangles that no modeller meant: whatever finite numbers a file holds, a frame comes out, and the good triangles of
//! the scene are where they belong. Nothing to do without an adapter.

mod common;

use anamorph::internals::camera::Camera;
use anamorph::internals::camera::optics::{Bounce, Facets, Law, Optics, Surface};
use anamorph::internals::engine::RunOptions;
use anamorph::internals::geometry::generate;
use anamorph::internals::geometry::mesh::Mesh;
use anamorph::internals::geometry::place::merge;
use anamorph::internals::image::frame::{Channel, NO_ID};
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, pinhole, raymap};
use common::gpu::{Without, assert_right, check, engine, hits, ids, render, wanted};
use common::rng::Rng;
use common::{ALL_T, FORWARD, camera, mesh, scene, soup};
use glam::DVec3;
use std::sync::Arc;

const SIZE: (u32, u32) = (61, 45);

/// Triangles of their own vertices.
fn loose(corners: Vec<[DVec3; 3]>) -> Mesh {
    let triangles = (0..corners.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    mesh(corners.into_iter().flatten().collect(), triangles)
}

/// Renders a good ball among `garbage`, before and after it in the file, and compares it with the reference.
fn check_among(name: &str, garbage: impl Fn(&mut Rng) -> [DVec3; 3]) {
    let mut rng = Rng(5);
    let mut lot = || loose((0..40).map(|_| garbage(&mut rng)).collect());
    let scene = scene(merge(vec![lot(), generate::icosphere(2), lot()]).unwrap());
    for (kind_name, kind) in glc_of_each_class().into_iter().step_by(2) {
        let Some((frame, ..)) = check(&format!("{name} by {kind_name}"), &scene, &camera(kind, SIZE, ALL_T)) else {
            return;
        };
        let ball = ids(&frame).iter().filter(|id| (40..360).contains(*id)).count();
        println!("{name} by {kind_name}: {ball} pixels of the ball, {} hits", hits(&frame));
    }
    check(&format!("{name} by pieces"), &scene, &camera(mesh_camera(1, 5, 4, MeshShape::default()), SIZE, FORWARD));
    check(&format!("{name} by a ray map"), &scene, &raymap(SIZE.0, SIZE.1, FORWARD));
}

#[test]
fn triangles_without_area() {
    check_among("points", |rng| [1.2 * rng.vector(); 3]);
    check_among("lines", |rng| {
        let (a, b) = (1.2 * rng.vector(), 1.2 * rng.vector());
        [[a, b, a], [a, a, b], [a, b, 0.5 * (a + b)]][rng.below(3)]
    });
    check_among("lines of whole numbers", |rng| {
        let (a, e) = ((8.0 * rng.vector()).round() / 8.0, (8.0 * rng.vector()).round() / 8.0);
        [a, a + e, a + 2.0 * e]
    });
}

#[test]
fn needles() {
    for width in [1e-3, 1e-6, 1e-9, 1e-12] {
        check_among(&format!("needles of {width:e}"), |rng| {
            let (a, e) = (1.2 * rng.vector(), rng.vector());
            [a, a + e, a + 0.5 * e + width * rng.vector()]
        });
    }
}

#[test]
fn small_and_denormal_triangles() {
    for size in [1e-6, 1e-12, 1e-20, 1e-40, 1e-300, 1e-310] {
        check_among(&format!("size {size:e}"), |rng| {
            let at = if rng.below(2) == 0 { DVec3::ZERO } else { 1.2 * rng.vector() };
            [(); 3].map(|()| at + size * rng.vector())
        });
    }
}

#[test]
fn huge_triangles() {
    for size in [1e3, 1e6] {
        check_among(&format!("size {size:e}"), |rng| [(); 3].map(|()| size * rng.vector()));
    }
}

#[test]
fn numbers_near_the_end_of_f32_are_right_and_beyond_an_error() {
    for size in [1e9, 1e18, 5e29, 1e60] {
        let mut rng = Rng(6);
        let far = loose((0..20).map(|_| [(); 3].map(|()| size * rng.vector())).collect());
        let scene = scene(merge(vec![generate::icosphere(2), far]).unwrap());
        for (name, kind) in glc_of_each_class() {
            let camera = camera(kind, SIZE, ALL_T);
            let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
            match engine.render(&scene, &camera, &wanted(), &RunOptions::default()) {
                Ok(rendered) => drop(assert_right(&format!("{name}, {size:e}"), &scene, &camera, &rendered.frame)),
                Err(e) => assert!(size > 1e30 && e.to_string().contains("the scene extends"), "{name}, {size:e}: {e}"),
            }
        }
    }
}

#[test]
fn every_kind_at_once() {
    check_among("mixture", |rng| {
        let size = 10f64.powi(rng.below(13) as i32 - 9);
        let at = rng.vector();
        let e = size * rng.vector();
        match rng.below(4) {
            0 => [at, at + e, at + e],
            1 => [at, at + e, at + 0.3 * e],
            _ => [at, at + e, at + size * rng.vector()],
        }
    });
}

#[test]
fn a_scene_without_triangles_is_background() {
    for camera in [
        camera(pinhole(DVec3::Z, DVec3::ZERO, 40.0), SIZE, FORWARD),
        camera(mesh_camera(1, 3, 3, MeshShape::default()), SIZE, FORWARD),
        raymap(SIZE.0, SIZE.1, FORWARD),
    ] {
        let lone_points = mesh(vec![DVec3::ZERO, DVec3::X], vec![]);
        for empty in [Mesh::default(), lone_points, loose(vec![[DVec3::ZERO; 3]])] {
            let scene = scene(empty);
            let Some(frame) = render(&scene, &camera) else { return };
            assert_eq!(hits(&frame), 0);
            for (channel, value) in [
                (Channel::R, scene.background[0]),
                (Channel::G, scene.background[1]),
                (Channel::B, scene.background[2]),
                (Channel::A, 0.0),
                (Channel::Z, f32::INFINITY),
                (Channel::T, f32::INFINITY),
                (Channel::BaryU, 0.0),
                (Channel::BaryV, 0.0),
            ] {
                assert!(frame.f32(channel).unwrap().iter().all(|v| *v == value), "{}", channel.name());
            }
            assert!(frame.u32(Channel::PieceId).unwrap().iter().all(|id| *id == NO_ID));
        }
    }
}

#[test]
fn one_triangle() {
    let v = DVec3::new;
    let one = scene(loose(vec![[v(-1.0, -0.8, 0.0), v(0.9, -0.7, 0.2), v(0.1, 1.0, -0.3)]]));
    for (name, kind) in glc_of_each_class() {
        let Some((frame, ..)) = check(name, &one, &camera(kind, SIZE, FORWARD)) else { return };
        assert!(hits(&frame) > 300, "{name}: {} hits", hits(&frame));
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn of_thousands_of_coincident_triangles_the_lowest_id_is_seen() {
    let mut rng = Rng(8);
    let corners = soup(&mut rng, 1, 1.5).positions;
    let orders = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    let triangles: Vec<[u32; 3]> = (0..5000).map(|_| orders[rng.below(6)]).collect();
    let stack = scene(mesh(corners, triangles.clone()));
    // the first one that shows its face where the others do not
    let mut one_sided = stack.clone();
    Arc::make_mut(&mut one_sided.mesh).materials[0].two_sided = false;
    for (name, kind) in glc_of_each_class() {
        let camera = camera(kind, SIZE, ALL_T);
        let Some((frame, ..)) = check(name, &stack, &camera) else { return };
        assert!(ids(&frame).iter().all(|&id| id == 0 || id == NO_ID), "{name}");
        let Some((frame, ..)) = check(name, &one_sided, &camera) else { return };
        let reversed = |id: usize| orders.iter().position(|o| *o == triangles[id]).unwrap() >= 3;
        let first_other = (0..5000).find(|&k| reversed(k) != reversed(0)).unwrap() as u32;
        assert!(ids(&frame).iter().all(|&id| [0, first_other, NO_ID].contains(&id)), "{name}");
        assert!(hits(&frame) > 100, "{name}");
    }
}

/// A camera before a mirror or a lens of these facets.
fn through(facets: Facets, law: Law, bounce: Bounce, eye: DVec3, depth: u32) -> Camera {
    let mut camera = camera(pinhole(eye, DVec3::ZERO, 60.0), SIZE, FORWARD);
    let surface = Surface::Facets { facets, law };
    camera.optics = Some(Optics { tint: [0.9; 3], base: [0.5; 3], ..Optics::new(bounce, surface, depth) }.into());
    camera
}

/// Facets anywhere, with normals that are not theirs: up, down, along them.
#[test]
fn optics_of_any_triangles_with_any_normals() {
    let mut rng = Rng(12);
    let scene = scene(generate::icosphere(2));
    for seed in 0..4 {
        let mut mesh = soup(&mut Rng(seed), 60, [0.6, 0.2][seed as usize % 2]);
        mesh.positions.iter_mut().for_each(|p| *p = 1.5 * *p + DVec3::new(0.0, 0.0, 1.5));
        mesh.normals = (0..180).map(|_| rng.direction().as_vec3()).collect();
        mesh.corner_normals = mesh.triangles.clone();
        let facets = Facets::of_mesh(&mesh).unwrap();
        let eye = DVec3::new(0.3, 0.2, 5.0);
        for bounce in [Bounce::Reflect, Bounce::Refract { ior: 1.4 }] {
            for (law, depth) in [(Law::Normals, 3), (Law::Flat { eye }, 1)] {
                let name = format!("{seed}, {bounce:?}, {law:?}");
                if check(&name, &scene, &through(facets.clone(), law, bounce, eye, depth)).is_none() {
                    return;
                }
            }
        }
    }
}
