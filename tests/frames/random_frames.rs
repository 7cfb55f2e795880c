//! Small random scenes against the reference; `examples/random_frames.rs` goes through as many as it is told.

use crate::common;

use anamorph::internals::engine::planned::Planned;
use anamorph::internals::engine::sequence::Sequence;
use anamorph::internals::engine::{Method, RunOptions};
use common::any::{Path, any, any_on_the_mesh};
use common::gpu::{assert_right, check, engine_on, wanted};
use common::rng::Rng;

const SIZE: (u32, u32) = (32, 32);

/// Of these, straight curves that lie in a triangle's plane were once seen.
const ONCE_WRONG: [u64; 4] = [1_002_937, 1_007_237, 1_008_488, 1_008_808];

#[test]
fn every_safe_pixel_of_random_scenes_has_the_reference_s_triangle() {
    for number in ONCE_WRONG.into_iter().chain(0..60) {
        let (scene, camera) = any(&mut Rng(number), SIZE);
        if check(&format!("scene {number}, {}", camera.kind), &scene, &camera).is_none() {
            return;
        }
    }
}

#[test]
fn every_safe_pixel_is_right_where_the_camera_lies_on_the_mesh() {
    for number in 0..150 {
        let (scene, camera) = any_on_the_mesh(&mut Rng(number), SIZE);
        if check(&format!("scene {number}, {}", camera.kind), &scene, &camera).is_none() {
            return;
        }
    }
}

/// Poses of cameras of all kept kinds, and triangles that move between them, on a device that has shown all that went before.
#[test]
fn every_safe_pixel_of_a_path_is_right_on_a_device_that_keeps_what_it_can() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let (mut sequence, mut last): (Sequence, Option<Planned>) = Default::default();
    let wanted = wanted();
    for (number, is_placed) in (0..25).map(|number| (number, false)).chain((0..12).map(|number| (number, true))) {
        let rng = &mut Rng(number);
        let mut path = if is_placed { Path::placed(rng, SIZE) } else { Path::new(rng, SIZE) };
        let method = if is_placed { Method::Trace } else { Method::Auto };
        let run = RunOptions { method, ..RunOptions::default() };
        for pose in 0..4 {
            let camera = path.step(rng);
            let planned = engine.planner().plan(&path.scene, &camera, &wanted, &run, last.as_ref()).unwrap();
            last = Some(planned.clone());
            let rendered = sequence.render(&mut engine, planned, &run).unwrap().rendered();
            let frame = rendered.frame;
            let is_traced_in_places = rendered.method.why == "meshes stand in several places";
            assert_eq!(is_traced_in_places, is_placed && !path.is_reflected(), "scene {number}, pose {pose}");
            assert_right(&format!("scene {number}, {}, pose {pose}", camera.kind), &path.scene, &camera, &frame);
        }
    }
}
