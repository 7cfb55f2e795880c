//! Frames through chains and curved rays against the reference.

use crate::common;

use anamorph::internals::camera::mesh::spec::MeshCameraSpec;
use anamorph::internals::camera::{Camera, Rays};
use anamorph::internals::engine::RunOptions;
use anamorph::internals::geometry::{generate, place};
use anamorph::internals::image::frame::{Channel, NO_ID};
use anamorph::internals::scene::Scene;
use common::cameras::{MeshShape, mesh_spec};
use common::gpu::{self, Without, check, hits, ids, render, words};
use common::rng::Rng;
use common::{layered, scene};
use glam::DVec3;

const SIZE: (u32, u32) = (101, 77);

/// A ball in a cloud of small triangles, some of them one-sided.
fn ball_in_cloud() -> Scene {
    let cloud = common::soup(&mut Rng(1), 240, 0.3);
    let mut ball = generate::icosphere(3);
    ball.positions.iter_mut().for_each(|p| *p *= 0.7);
    let mut mesh = place::merge(vec![ball, cloud]).unwrap();
    mesh.materials[1].two_sided = false;
    scene(mesh)
}

fn cameras() -> Vec<(String, Camera)> {
    let plain = MeshShape::default();
    let chain = |layers, shape| layered::chain(8, layers, (5, 4), shape, SIZE);
    let mut list = vec![
        ("chain".to_string(), chain(3, plain)),
        ("weighted chain".into(), chain(4, MeshShape { weights: true, ..plain })),
        ("discontinuous chain".into(), chain(2, MeshShape { discontinuous: true, ..plain })),
        ("chain of 16".into(), chain(16, plain)),
        ("straight, then curved".into(), layered::straight_then_curved(SIZE)),
    ];
    for (degree, bend) in [(1, 0.0), (2, 0.3), (2, 2.0), (3, 0.3), (3, 2.0)] {
        let holes = bend > 1.0;
        list.push((format!("degree {degree} bent by {bend}"), layered::wavy(degree, bend, holes, SIZE)));
    }
    list
}

#[test]
fn chains_and_curves_are_right_by_margin() {
    let scene = ball_in_cloud();
    for (name, camera) in cameras() {
        let Some((frame, ..)) = check(&name, &scene, &camera) else { return };
        assert!(hits(&frame) > 1000, "{name}: {} hits", hits(&frame));
    }
}

#[test]
fn without_64_bit_atomics_chains_are_right_too() {
    let scene = ball_in_cloud();
    for (name, camera) in cameras() {
        let Some(whole) = gpu::render_with(&scene, &camera, Without::Nothing, &RunOptions::default()) else { return };
        let two = gpu::render_with(&scene, &camera, Without::Int64Atomics, &RunOptions::default()).unwrap();
        assert_eq!(words(&whole.frame), words(&two.frame), "{name}: two 32-bit atomics are one of 64");
    }
}

/// Kernels with f64 in words take a software adapter long to compile: one kind of pieces, one of curves.
#[test]
#[ignore = "slow: make test-all"]
fn without_f64_chains_are_right_too() {
    let scene = ball_in_cloud();
    let few = cameras().into_iter().filter(|(name, _)| ["chain", "degree 2 bent by 0.3"].contains(&name.as_str()));
    let mut count = 0;
    for (name, camera) in few {
        let Some(whole) = gpu::render_with(&scene, &camera, Without::Nothing, &RunOptions::default()) else { return };
        gpu::assert_same_without_f64(&name, &scene, &camera, &whole.frame);
        count += 1;
    }
    assert_eq!(count, 2);
}

/// Rays that go on straight through every face are those of one camera: the same triangles, the same lengths.
#[test]
fn a_chain_of_straight_rays_is_the_camera_without_faces() {
    let whole = mesh_spec(6, 4, 3, MeshShape::default());
    let part = |from: f64, to: f64| {
        let mut spec = whole.clone();
        for v in &mut spec.vertices {
            (v.near, v.far) = (v.near.lerp(v.far, from), v.near.lerp(v.far, to));
        }
        spec
    };
    let scene = ball_in_cloud();
    let one = layered::of_layers(vec![part(0.0, 1.0)], SIZE);
    let in_layers = layered::of_layers(vec![part(0.0, 0.25), part(0.25, 0.5), part(0.5, 1.0)], SIZE);
    let (Some(one), Some(in_layers)) = (render(&scene, &one), render(&scene, &in_layers)) else { return };
    let differ = (0..ids(&one).len()).filter(|&k| ids(&one)[k] != ids(&in_layers)[k]).count();
    // rays that pass an edge within rounding may fall to either side
    assert!(differ <= 2, "{differ} pixels differ");
    let (z, z_in_layers) = (one.f32(Channel::Z).unwrap(), in_layers.f32(Channel::Z).unwrap());
    let (t, t_in_layers) = (one.f32(Channel::T).unwrap(), in_layers.f32(Channel::T).unwrap());
    let mut layers = [0; 3];
    for k in (0..z.len()).filter(|&k| ids(&one)[k] != NO_ID && ids(&one)[k] == ids(&in_layers)[k]) {
        // lengths of up to three segments, each and their sum rounded to f32
        assert!((z[k] - z_in_layers[k]).abs() <= 8.0 * f32::EPSILON * z[k], "Z {} and {}", z[k], z_in_layers[k]);
        let (layer, local) = (t_in_layers[k].floor().min(2.0), t_in_layers[k]);
        let joined = [0.25 * local, 0.25 + 0.25 * (local - 1.0), 0.5 + 0.5 * (local - 2.0)][layer as usize];
        assert!((joined - t[k]).abs() <= 1e-6, "t {} of layer {layer} for {}", t_in_layers[k], t[k]);
        layers[layer as usize] += 1;
    }
    assert!(layers.iter().all(|n| *n > 50), "every layer is seen: {layers:?}");
}

/// What lies exactly in a face between two segments is found once, by the lower layer.
#[test]
fn a_surface_in_a_shared_face_shows_no_crack() {
    let whole = mesh_spec(6, 4, 3, MeshShape::default());
    // the faces of the cells bend: two triangles each, in space as in the image
    let middle = |v: &anamorph::internals::camera::mesh::spec::CameraVertex| {
        v.near.lerp(v.far, 0.4) + 0.1 * DVec3::new(v.near.y, v.near.z, v.near.x)
    };
    let (mut before, mut after) = (whole.clone(), whole.clone());
    for (k, v) in whole.vertices.iter().enumerate() {
        before.vertices[k].far = middle(v);
        after.vertices[k].near = middle(v);
    }
    let face = common::mesh(whole.vertices.iter().map(middle).collect(), whole.triangles.clone());
    for offset in [DVec3::ZERO, DVec3::new(300.0, -70.0, 10.0)] {
        let scene = scene(common::moved(face.clone(), offset));
        let shifted = |spec: &MeshCameraSpec| {
            let mut spec = spec.clone();
            spec.vertices.iter_mut().for_each(|v| (v.near, v.far) = (v.near + offset, v.far + offset));
            spec
        };
        let camera = layered::of_layers(vec![shifted(&before), shifted(&after)], SIZE);
        let Some(frame) = render(&scene, &camera) else { return };
        assert_eq!(hits(&frame), (SIZE.0 * SIZE.1) as usize, "no pixel falls through the face");
        let pieces = frame.u32(Channel::PieceId).unwrap();
        let alone = |k: usize| camera.near(0, k as u32 % SIZE.0, k as u32 / SIZE.0).0.len() == 1;
        let own = (0..pieces.len()).filter(|&k| alone(k)).all(|k| pieces[k] == ids(&frame)[k]);
        assert!(own, "each piece of the lower layer ends in its own triangle");
        assert!(frame.f32(Channel::T).unwrap().iter().all(|t| (t - 1.0).abs() <= 1e-6));
    }
}

/// Degree elevation changes no curve: straight rays as cubics are straight rays.
#[test]
fn straight_curves_are_rays() {
    let spec = mesh_spec(6, 1, 1, MeshShape::default());
    let camera = layered::of_layers(vec![spec], SIZE);
    let mut curved = camera.clone();
    let map = std::sync::Arc::new(layered::Elevated { of: camera.clone(), degree: 3 });
    curved.layers = vec![Rays::Curves(anamorph::internals::camera::Curves::new(SIZE.0, SIZE.1, map))];
    let scene = ball_in_cloud();
    let (Some(rays), Some(curves)) = (render(&scene, &camera), render(&scene, &curved)) else { return };
    let differ = (0..ids(&rays).len()).filter(|&k| ids(&rays)[k] != ids(&curves)[k]).count();
    assert!(differ <= 2, "{differ} pixels differ");
    let (z, z_curved) = (rays.f32(Channel::Z).unwrap(), curves.f32(Channel::Z).unwrap());
    for k in (0..z.len()).filter(|&k| ids(&rays)[k] != NO_ID && ids(&rays)[k] == ids(&curves)[k]) {
        assert!((z[k] - z_curved[k]).abs() <= 16.0 * f32::EPSILON * z[k], "Z {} and {}", z[k], z_curved[k]);
    }
}
