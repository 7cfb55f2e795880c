//! The whole pipeline by its twins, on the host alone, against the reference: safe pixels right, near candidates elsewhere.

use crate::bounced;
use crate::common;
use crate::stages;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::geometry::generate::{icosphere, teapot};
use anamorph::internals::image::compare::compare;
use anamorph::internals::image::frame::{Channel, Frame, NO_ID, Plane};
use anamorph::internals::reference::image::judge;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::Light;
use anamorph_lab::twin::render;
use common::cameras::{self, MeshShape};
use common::rng::Rng;
use common::{ALL_T, FORWARD, camera, scene, soup};
use glam::DVec3;

/// Far above any table of these frames.
const WHOLE: u64 = 1 << 27;
/// t and Z are f64 numbers stored as f32, 2^-24; t of a key lacks its lowest bits, which is less.
const T_ERROR: f64 = 1.5e-7;
/// The planes' f32 rounding of weights up to 1, and f64 rounding of positions stored to 2^-48.
const BARY_ERROR: f64 = 1e-6;
/// Colour in decibels: f32 rounding of both frames leaves more than 130.
const PSNR_MIN: f64 = 120.0;

fn draw(scene: &Scene, camera: &Camera, binding_limit: u64) -> Frame {
    let wanted = Wanted { srgb8: true, ..Wanted::of(Channel::ALL.to_vec()) };
    let (frame, srgb8) = render(scene, camera, &wanted, binding_limit);
    assert_eq!(srgb8.map(|p| p.len()), Some((camera.width * camera.height) as usize));
    frame
}

fn check(name: &str, scene: &Scene, camera: &Camera, binding_limit: u64) {
    let frame = draw(scene, camera, binding_limit);
    let judged = judge(scene, camera, &frame);
    let seen = compare(&frame, &judged.truth, Some(&judged.safe), Some(&judged.scales)).unwrap();
    println!("{name}: {seen}");
    let hits = frame.u32(Channel::TriangleId).unwrap().iter().filter(|id| **id != NO_ID).count();
    assert!(hits * 10 > judged.safe.len(), "{name}: {hits} hits");
    assert_eq!((seen.wrong_safe, judged.not_near), (Some(0), 0), "{name}: {seen}");
    // the twin decides as the reference does but for ties that rounding decides
    assert!(seen.wrong_triangle.unwrap() * 1000 <= judged.safe.len() as u64, "{name}: {seen}");
    assert!(seen.t_relative.unwrap().p99.0 <= T_ERROR && seen.z_relative.unwrap().p99.0 <= T_ERROR, "{name}: {seen}");
    assert!(seen.bary_max.unwrap().0 <= BARY_ERROR, "{name}: {seen}");
    let same = seen.wrong_triangle == Some(0);
    assert!(!same || seen.psnr.unwrap() >= PSNR_MIN, "{name}: {seen}");
    let (pieces, truth) = (frame.u32(Channel::PieceId).unwrap(), judged.truth.u32(Channel::PieceId).unwrap());
    assert!(pieces.iter().zip(truth).all(|(a, b)| a == b || *a == NO_ID || *b == NO_ID), "{name}: pieces differ");
}

#[test]
fn every_class_of_glc() {
    for (k, (name, kind)) in cameras::glc_of_each_class().into_iter().enumerate() {
        let scene = scene(soup(&mut Rng(k as u64), 200, 0.4));
        check(name, &scene, &camera(kind.clone(), (48, 40), FORWARD), WHOLE);
        check(name, &scene, &camera(kind, (40, 25), ALL_T), WHOLE);
    }
}

#[test]
fn meshes_of_pieces() {
    for (normalize, weights, discontinuous) in
        [(false, false, false), (false, true, false), (true, true, false), (true, true, true)]
    {
        let shape = MeshShape { normalize, weights, discontinuous };
        let mut scene = scene(icosphere(2));
        scene.lights = vec![Light::distant(DVec3::new(-1.0, -2.0, -1.0))];
        check(&format!("{shape:?}"), &scene, &camera(cameras::mesh_camera(9, 5, 4, shape), (60, 52), FORWARD), WHOLE);
    }
}

#[test]
fn ray_fields() {
    check("ball", &scene(icosphere(2)), &cameras::raymap(56, 44, FORWARD), WHOLE);
    check("soup", &scene(soup(&mut Rng(50), 150, 0.5)), &cameras::raymap(33, 47, [-0.5, 0.7]), WHOLE);
}

/// Every ninth pixel's ray meets a vertex, up to rounding: the twin's ties may fall another way than the reference's,
/// but only onto a neighbour.
#[test]
fn vertices_on_rays() {
    for (name, kind) in cameras::glc_of_each_class() {
        let camera = camera(kind, (43, 37), FORWARD);
        let scene = scene(stages::slab_on_rays(&camera, 3));
        let frame = draw(&scene, &camera, WHOLE);
        let judged = judge(&scene, &camera, &frame);
        let seen = compare(&frame, &judged.truth, Some(&judged.safe), None).unwrap();
        println!("{name}: {seen}");
        assert_eq!((seen.wrong_safe, judged.not_near), (Some(0), 0), "{name}: {seen}");
        // the slab has no holes, so only its own border may differ
        let border = 2 * (43 + 37);
        assert!(seen.wrong_hit_miss.unwrap() <= border, "{name}: {seen}");
        let ids = frame.u32(Channel::TriangleId).unwrap();
        let inside = (1..36u32).flat_map(|j| (1..42u32).map(move |i| (j * 43 + i) as usize));
        assert!(inside.into_iter().all(|k| ids[k] != NO_ID), "{name}: a hole");
    }
}

#[test]
fn mirrors_and_lenses() {
    // from far away nothing of the scene is seen
    for case in bounced::cases().into_iter().filter(|c| !c.name.contains("10000")) {
        check(&case.name, &case.scene, &case.camera, case.band_limit);
    }
}

#[test]
fn bands_chunks_and_many_levels() {
    let kind = cameras::glc_of_each_class().swap_remove(3).1;
    let mut mesh = teapot(2);
    mesh.positions.iter_mut().for_each(|p| *p /= 2.0);
    let camera = camera(kind, (280, 150), FORWARD);
    // 12 rows of ten channels, 250 triangles
    check("bands and chunks", &scene(mesh), &camera, 281 * 40 * 50);
}

#[test]
fn a_planted_error_is_seen() {
    let scene = scene(icosphere(1));
    let camera = camera(cameras::pinhole(3.0 * DVec3::Z, DVec3::ZERO, 40.0), (40, 40), FORWARD);
    let mut frame = draw(&scene, &camera, WHOLE);
    let judged = judge(&scene, &camera, &frame);
    assert_eq!(judged.not_near, 0);
    let at = (0..1600).find(|&k| judged.safe[k] && judged.truth.u32(Channel::TriangleId).unwrap()[k] != NO_ID).unwrap();
    for (channel, plane) in &mut frame.planes {
        if let (Channel::TriangleId, Plane::U32(ids)) = (*channel, plane) {
            ids[at] ^= 1;
        }
    }
    let judged = judge(&scene, &camera, &frame);
    let seen = compare(&frame, &judged.truth, Some(&judged.safe), None).unwrap();
    assert_eq!((judged.not_near, seen.wrong_safe), (1, Some(1)));
}
