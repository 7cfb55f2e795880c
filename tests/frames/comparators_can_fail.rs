//! What judges frames must be able to condemn one: a single wrong value, planted anywhere in a right frame, is
//! reported, and only as what it is.

use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::geometry::generate;
use anamorph::internals::image::compare::{Comparison, compare};
use anamorph::internals::image::frame::{Channel, Frame, NO_ID, Plane};
use anamorph::internals::reference::image::{image, judge};
use anamorph::internals::scene::Scene;
use common::cameras::{MeshShape, mesh_camera, pinhole};
use common::rng::Rng;
use common::{FORWARD, camera, scene};
use glam::DVec3;

const SIZE: (u32, u32) = (48, 40);

fn scene_and_cameras() -> (Scene, [Camera; 2]) {
    let kinds = [pinhole(DVec3::new(0.3, 0.4, 3.0), DVec3::ZERO, 50.0), mesh_camera(1, 4, 3, MeshShape::default())];
    (scene(generate::icosphere(2)), kinds.map(|k| camera(k, SIZE, FORWARD)))
}

fn u32s(frame: &mut Frame, channel: Channel) -> &mut Vec<u32> {
    match frame.planes.iter_mut().find(|(c, _)| *c == channel) {
        Some((_, Plane::U32(values))) => values,
        _ => panic!("no plane {channel:?}"),
    }
}

fn f32s(frame: &mut Frame, channel: Channel) -> &mut Vec<f32> {
    match frame.planes.iter_mut().find(|(c, _)| *c == channel) {
        Some((_, Plane::F32(values))) => values,
        _ => panic!("no plane {channel:?}"),
    }
}

/// The judgement and comparison of a right frame with `spoil` done to pixel `at`.
fn verdict(scene: &Scene, camera: &Camera, right: &Frame, spoil: impl Fn(&mut Frame)) -> (Comparison, u64) {
    let mut frame = right.clone();
    spoil(&mut frame);
    let judged = judge(scene, camera, &frame);
    (compare(&frame, &judged.truth, Some(&judged.safe), Some(&judged.scales)).unwrap(), judged.not_near)
}

/// Some pixels of each kind: safe hits, safe misses.
fn picked(scene: &Scene, camera: &Camera, right: &Frame) -> (Vec<usize>, Vec<usize>) {
    let judged = judge(scene, camera, right);
    let ids = right.u32(Channel::TriangleId).unwrap();
    let mut rng = Rng(4);
    let mut some = |hit: bool| {
        let all: Vec<usize> = (0..ids.len()).filter(|&k| judged.safe[k] && (ids[k] != NO_ID) == hit).collect();
        assert!(all.len() > 100);
        (0..4).map(|_| all[rng.below(all.len())]).collect()
    };
    (some(true), some(false))
}

#[test]
fn a_right_frame_is_found_right() {
    let (scene, cameras) = scene_and_cameras();
    for camera in &cameras {
        let right = image(&scene, camera, &Channel::ALL);
        let (seen, not_near) = verdict(&scene, camera, &right, |_| ());
        assert_eq!(
            (seen.wrong_triangle, seen.wrong_safe, seen.wrong_hit_miss, not_near),
            (Some(0), Some(0), Some(0), 0)
        );
        assert_eq!((seen.t_relative.unwrap().max.0, seen.identical), (0.0, Some(true)));
        let share = seen.unsafe_share.unwrap();
        assert!(share > 0.0 && share < 0.5, "{share}: neither kind of pixel is missing");
    }
}

#[test]
fn one_wrong_id_on_a_safe_pixel_is_counted() {
    let (scene, cameras) = scene_and_cameras();
    for camera in &cameras {
        let right = image(&scene, camera, &Channel::ALL);
        for at in picked(&scene, camera, &right).0 {
            // a neighbour in the file, and an id that no triangle has
            for wrong in [right.u32(Channel::TriangleId).unwrap()[at] ^ 1, 1 << 20] {
                let (seen, not_near) = verdict(&scene, camera, &right, |f| u32s(f, Channel::TriangleId)[at] = wrong);
                assert_eq!((seen.wrong_triangle, seen.wrong_safe, not_near), (Some(1), Some(1), 1), "pixel {at}");
                assert_eq!(seen.wrong_hit_miss, Some(0));
            }
        }
    }
}

#[test]
fn one_hit_for_a_miss_and_one_miss_for_a_hit_are_counted() {
    let (scene, cameras) = scene_and_cameras();
    for camera in &cameras {
        let right = image(&scene, camera, &Channel::ALL);
        let (hits, misses) = picked(&scene, camera, &right);
        for (at, id) in hits.into_iter().map(|k| (k, NO_ID)).chain(misses.into_iter().map(|k| (k, 7))) {
            let (seen, not_near) = verdict(&scene, camera, &right, |f| u32s(f, Channel::TriangleId)[at] = id);
            assert_eq!((seen.wrong_triangle, seen.wrong_safe, seen.wrong_hit_miss), (Some(1), Some(1), Some(1)));
            assert_eq!(not_near, 1, "pixel {at}");
        }
    }
}

#[test]
fn an_unsafe_pixel_may_name_a_candidate_and_nothing_else() {
    let (scene, cameras) = scene_and_cameras();
    let camera = &cameras[0];
    let right = image(&scene, camera, &Channel::ALL);
    let judged = judge(&scene, camera, &right);
    let unsafe_hits =
        (0..judged.safe.len()).filter(|&k| !judged.safe[k] && right.u32(Channel::TriangleId).unwrap()[k] != NO_ID);
    let (mut borders, mut tried) = (0, 0);
    for at in unsafe_hits.step_by(7).take(20) {
        let (seen, not_near) = verdict(&scene, camera, &right, |f| u32s(f, Channel::TriangleId)[at] = 1 << 20);
        assert_eq!((seen.wrong_triangle, seen.wrong_safe, not_near), (Some(1), Some(0), 1), "pixel {at}");
        // of all ids only those of the triangles that meet there pass
        let accepted = (0..scene.mesh.triangles.len() as u32)
            .step_by(16)
            .filter(|&id| verdict(&scene, camera, &right, |f| u32s(f, Channel::TriangleId)[at] = id).1 == 0)
            .count();
        assert!(accepted <= 6, "pixel {at}: {accepted} of every 16th triangle pass");
        borders += accepted;
        tried += 1;
        if tried == 3 {
            break;
        }
    }
    println!("{borders} candidates among every 16th triangle at {tried} pixels");
    assert!(tried > 0);
}

#[test]
fn one_wrong_t_is_the_largest_error() {
    let (scene, cameras) = scene_and_cameras();
    for camera in &cameras {
        let right = image(&scene, camera, &Channel::ALL);
        let extent = scene.bounds().map(|(lo, hi)| (hi - lo).length()).unwrap();
        for at in picked(&scene, camera, &right).0 {
            let direction = camera.ray(at as u32 % SIZE.0, at as u32 / SIZE.0).unwrap().direction.length();
            let t = right.f32(Channel::T).unwrap()[at];
            let (seen, not_near) = verdict(&scene, camera, &right, |f| f32s(f, Channel::T)[at] = t * 1.001);
            let expected = 0.001 * t as f64 / (t as f64).max(extent / direction);
            let found = seen.t_relative.unwrap();
            // f32 rounds the planted error, a thousandth, to 2^-24 of t: 6e-5 of it
            assert!(
                (found.max.0 / expected - 1.0).abs() < 1e-3 && found.median.0 == 0.0,
                "{seen} instead of {expected}"
            );
            assert_eq!((seen.wrong_triangle, not_near), (Some(0), 0));
            let (seen, _) = verdict(&scene, camera, &right, |f| f32s(f, Channel::T)[at] = f32::NAN);
            assert_eq!(seen.t_relative.unwrap().max.0, f64::INFINITY);
        }
    }
}

#[test]
fn one_wrong_colour_weight_and_depth_are_seen() {
    let (scene, [camera, _]) = scene_and_cameras();
    let right = image(&scene, &camera, &Channel::ALL);
    let at = picked(&scene, &camera, &right).0[0];
    let spoilt = |channel: Channel, by: f32| verdict(&scene, &camera, &right, |f| f32s(f, channel)[at] += by).0;
    for channel in [Channel::R, Channel::G, Channel::B] {
        let seen = spoilt(channel, 0.25);
        // one of three times as many values as pixels is off by a quarter, or by what the clamp leaves of it
        let floor = -10.0 * (0.0625 / (3.0 * (SIZE.0 * SIZE.1) as f64)).log10();
        assert!(
            seen.identical == Some(false) && seen.psnr.unwrap() >= floor - 0.01 && seen.psnr.unwrap() < 80.0,
            "{seen}"
        );
    }
    assert!((spoilt(Channel::BaryU, 0.125).bary_max.unwrap().0 - 0.125).abs() < 1e-6);
    assert!(spoilt(Channel::Z, 0.1).z_relative.unwrap().max.0 > 1e-3);
}
