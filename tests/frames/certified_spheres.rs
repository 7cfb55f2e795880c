//! The channel `certified` where there are spheres: what is proven is right, most is proven, and nothing that cannot be is.

use crate::common;
use anamorph::internals::input::Limits;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::geometry::mesh::Mesh;
use anamorph::internals::geometry::place::merge;
use anamorph::internals::geometry::spheres::{Join, round_of, spheres_of};
use anamorph::internals::image::frame::{Channel, Frame, NO_ID};
use anamorph::internals::reference::image::image;
use anamorph::internals::scene::Scene;
use common::any::any_with_spheres;
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, raymap};
use common::file::camera_of;
use common::gpu::{Without, engine, ids};
use common::layered::{chain, wavy};
use common::rng::Rng;
use common::{ALL_T, FORWARD, camera, scene, soup};
use glam::DVec3;

const SIZE: (u32, u32) = (64, 48);

/// Share of an ordinary picture that is proven: all but pixels within rounding of an outline.
const PROVEN_LEAST: f64 = 0.999;

fn balls(list: &[(DVec3, f64)]) -> Mesh {
    let (centres, radii) = list.iter().copied().unzip();
    spheres_of(centres, radii, None, Limits::default()).unwrap()
}

/// Spheres of many sizes, some inside of others, and triangles and capsules that cut them.
fn mixed(seed: u64) -> Scene {
    let mut rng = Rng(seed);
    let mut list: Vec<(DVec3, f64)> = Vec::new();
    for k in 0..120 {
        let centre = if k % 5 == 4 { list[rng.below(list.len())].0 } else { rng.vector() };
        list.push((centre, 10f64.powf(-0.5 - 2.5 * rng.unit())));
    }
    let mut spheres = balls(&list);
    spheres.materials[0].two_sided = seed.is_multiple_of(2);
    let points: Vec<DVec3> = (0..40).map(|_| rng.vector()).collect();
    let radii = (0..40).map(|_| 10f64.powf(-1.0 - 1.5 * rng.unit())).collect();
    let capsules = round_of(points, radii, None, Some(Join::Pairs), Limits::default()).unwrap();
    scene(merge(vec![soup(&mut rng, 60, 0.5), spheres, capsules]).unwrap())
}

fn certified(engine: &mut Engine, scene: &Scene, camera: &Camera) -> Frame {
    let wanted = Wanted::of(vec![Channel::TriangleId, Channel::Certified]);
    engine.render(scene, camera, &wanted, &RunOptions::default()).unwrap().frame
}

fn proven(frame: &Frame) -> &[u32] {
    frame.u32(Channel::Certified).unwrap()
}

fn share(frame: &Frame) -> f64 {
    proven(frame).iter().filter(|p| **p > 0).count() as f64 / proven(frame).len() as f64
}

/// Every pixel that is proven shows what the reference does.
fn assert_right(name: &str, scene: &Scene, camera: &Camera, frame: &Frame) {
    let truth = image(scene, camera, &[Channel::TriangleId]);
    let wrong = |k: &usize| proven(frame)[*k] > 0 && ids(frame)[*k] != ids(&truth)[*k];
    let wrong: Vec<usize> = (0..ids(frame).len()).filter(wrong).collect();
    assert!(wrong.is_empty(), "{name}: {} proven pixels are wrong, the first is {}", wrong.len(), wrong[0]);
}

fn cameras() -> Vec<(String, Camera)> {
    let mut all: Vec<(String, Camera)> =
        glc_of_each_class().into_iter().map(|(name, kind)| (name.to_owned(), camera(kind, SIZE, FORWARD))).collect();
    let weighted = MeshShape { normalize: true, weights: true, discontinuous: false };
    for (k, shape) in [MeshShape::default(), weighted].into_iter().enumerate() {
        all.push((format!("mesh {shape:?}"), camera(mesh_camera(k as u64, 4, 3, shape), SIZE, ALL_T)));
    }
    all.push(("chain".into(), chain(9, 2, (3, 2), MeshShape::default(), SIZE)));
    all.push(("raymap".into(), raymap(SIZE.0, SIZE.1, FORWARD)));
    for kind in ["fisheye\"\nfov = 170", "cylinder\"\nvfov = 70", "panini\"\nfov = 120"] {
        let text = format!("kind = \"{kind}\neye = [0.5, 1.2, 2.5]\ntarget = [0, 0, 0]");
        all.push((kind.to_owned(), camera_of("", SIZE, &text).unwrap()));
    }
    all
}

#[test]
fn most_pixels_with_spheres_are_proven_and_nothing_proven_is_wrong() {
    let cameras = cameras();
    assert!(cameras.len() >= 12, "{}", cameras.len());
    for (k, (name, camera)) in cameras.iter().enumerate() {
        let Some(mut engine) = engine(camera, Without::Nothing) else { return };
        for seed in [k as u64, k as u64 + 101] {
            let scene = mixed(seed);
            let frame = certified(&mut engine, &scene, camera);
            assert_right(name, &scene, camera, &frame);
            println!("{name}, {seed}: {:.5} proven", share(&frame));
            assert!(share(&frame) >= PROVEN_LEAST, "{name}, {seed}: {} proven", share(&frame));
        }
    }
}

#[test]
fn nothing_proven_is_wrong_in_random_scenes() {
    let (mut scenes, mut sum) = (0, 0.0);
    for number in 0..60 {
        let (scene, camera) = any_with_spheres(&mut Rng(90_000 + number), (32, 32));
        let is_refused = camera.is_curved_or_layered() || scene.mesh.has_alpha_masks() || camera.optics.is_some();
        if is_refused {
            continue;
        }
        let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
        let frame = certified(&mut engine, &scene, &camera);
        assert_right(&format!("scene {number}, {}", camera.kind), &scene, &camera, &frame);
        (scenes, sum) = (scenes + 1, sum + share(&frame));
    }
    let mean = sum / f64::from(scenes);
    println!("{scenes} scenes: {mean:.4} proven");
    assert!(scenes > 20 && mean > 0.8, "{scenes} {mean}");
}

/// Equal spheres, one inside another that it touches, and two whose order f64 cannot tell, are nowhere proven; farther apart they are.
#[test]
fn an_order_within_rounding_is_not_proven() {
    let eye = camera_of("", SIZE, "kind = \"pinhole\"\neye = [0.1, 0.2, 4]\ntarget = [0, 0, 0]\nvfov = 40").unwrap();
    let Some(mut engine) = engine(&eye, Without::Nothing) else { return };
    for (other, is_told) in [(1.0, false), (1.0 + 1e-16, false), (1.0 - 1e-14, false), (0.999, true)] {
        let scene = scene(balls(&[(DVec3::ZERO, 1.0), (DVec3::ZERO, other)]));
        let frame = certified(&mut engine, &scene, &eye);
        assert_right("two", &scene, &eye, &frame);
        let hits: Vec<u32> =
            (0..ids(&frame).len()).filter(|k| ids(&frame)[*k] != NO_ID).map(|k| proven(&frame)[k]).collect();
        let told = hits.iter().filter(|p| **p > 0).count();
        assert!(hits.len() > 500, "{}", hits.len());
        assert!(
            if is_told { told as f64 > 0.999 * hits.len() as f64 } else { told == 0 },
            "{other}: {told} of {}",
            hits.len()
        );
    }
}

/// Rays a quarter apart, some of which touch a ball of radius 2: those alone are not proven.
#[test]
fn a_touching_ray_is_not_proven() {
    let along_z = "kind = \"orthographic\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nheight = 8.25";
    let eye = camera_of("", (33, 33), along_z).unwrap();
    let Some(mut engine) = engine(&eye, Without::Nothing) else { return };
    for (radius, touched) in [(2.0, 4), (1.25, 12), (2.0 + 1e-7, 0), (2.0 - 1e-7, 0)] {
        let scene = scene(balls(&[(DVec3::ZERO, radius)]));
        let frame = certified(&mut engine, &scene, &eye);
        assert_right("touching", &scene, &eye, &frame);
        let uncertain: Vec<(usize, usize)> =
            (0..33 * 33).filter(|k| proven(&frame)[*k] == 0).map(|k| (k % 33, k / 33)).collect();
        assert_eq!(uncertain.len(), touched, "{radius}: {uncertain:?}");
    }
}

#[test]
fn curves_are_refused_with_a_reason() {
    let camera = wavy(2, 0.4, false, SIZE);
    let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
    let wanted = Wanted::of(vec![Channel::TriangleId, Channel::Certified]);
    let error = engine.render(&mixed(1), &camera, &wanted, &RunOptions::default()).unwrap_err();
    assert!(error.exit_code() == 2 && error.to_string().contains("no pixel with spheres is certified"), "{error}");
}
