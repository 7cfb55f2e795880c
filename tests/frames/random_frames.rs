//! Small random scenes against the reference; `examples/random_frames.rs` goes through as many as it is told.

use crate::common;

use anamorph::internals::engine::combinations::Feature;
use anamorph::internals::engine::planned::Planned;
use anamorph::internals::engine::sequence::Sequence;
use anamorph::internals::engine::{Method, RunOptions};
use common::any::{Path, any, any_on_the_mesh};
use common::combined::{Case, SMALL, compared};
use common::gpu::{assert_right, check, engine_on, limit_bindings, wanted};
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

/// Sets of features whose frames were once wrong, or called wrong: samples of blended surfaces in pixels that are sorted by their rays, capsules
/// of 400,000 km along curves, rays that start on the edge of a triangle or of a hole, triangles too thin to have a plane.
const ONCE_WRONG_TOGETHER: [(u64, &[Feature]); 5] = [
    (60_718, &[Feature::Samples, Feature::Blended]),
    (61_898, &[Feature::Spheres]),
    (50_460, &[Feature::Rows, Feature::Spheres]),
    (609, &[Feature::Samples, Feature::AlphaMasks, Feature::Pictures]),
    (60_032, &[Feature::Certified, Feature::Curves]),
];

/// `examples/random_frames` goes through as many sets of features as it is told.
#[test]
fn frames_that_combine_features_are_right() {
    let random = (0..8).map(|set| (set, Case::any_features(&mut Rng(set))));
    let known = ONCE_WRONG_TOGETHER.into_iter().map(|(number, features)| (number, features.to_vec()));
    for (first, features) in known.chain(random) {
        let is_small = features.iter().any(|feature| matches!(feature, Feature::Bands | Feature::Chunks));
        let engine = engine_on(|gpu| {
            if is_small {
                limit_bindings(gpu, SMALL);
            }
        });
        let Some(mut engine) = engine else { return };
        for number in first..first + 3 {
            let case = Case::any(&mut Rng(number), &features, SIZE);
            let what = format!("scene {number}, {features:?}, {}", case.camera.kind);
            let compared = match compared(&case, &mut engine) {
                Ok(compared) => compared,
                Err(e) if e.to_string().contains("the adapter binds") => continue,
                Err(e) => panic!("{what}: {e}"),
            };
            let of_samples = compared.samples.iter().map(|(_, verdict)| verdict);
            let wrong: u64 = compared.centres.iter().chain(of_samples).map(|verdict| verdict.wrong()).sum();
            assert_eq!(wrong, 0, "{what}");
        }
    }
}
