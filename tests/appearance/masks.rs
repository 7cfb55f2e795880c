//! Alpha masks and blended surfaces where rays are traced: raster's triangles, and where raster cannot be asked, the reference's.

use crate::common;
use crate::textures::{families, masked_shapes};
use anamorph::internals::camera::Camera;
use anamorph::internals::camera::exposure::{Exposure, LineOrder, Lines, Readout, Sample};
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Method, RunOptions};
use anamorph::internals::geometry::place::merge;
use anamorph::internals::geometry::spheres::spheres_of;
use anamorph::internals::geometry::time_steps::{TimeStep, TimeSteps};
use anamorph::internals::image::frame::{Channel, Frame};
use anamorph::internals::input::Limits;
use anamorph::internals::reference::image::image;
use anamorph::internals::scene::Scene;
use common::cameras::MeshShape;
use common::gpu::{Without, check, engine, hits, ids, render, render_with, words};
use common::layered::chain;
use common::rng::Rng;
use common::scene;
use glam::DVec3;
use std::sync::Arc;

const SIZE: (u32, u32) = (48, 36);

fn by(method: Method) -> RunOptions {
    RunOptions { method, ..RunOptions::default() }
}

fn render_of(scene: &Scene, camera: &Camera, channels: Vec<Channel>) -> Option<Frame> {
    let mut engine = engine(camera, Without::Nothing)?;
    Some(engine.render(scene, camera, &Wanted::of(channels), &RunOptions::default()).unwrap().frame)
}

fn cameras() -> impl Iterator<Item = (&'static str, Camera)> {
    families(SIZE).into_iter().chain([("chain", chain(3, 3, (4, 3), MeshShape::default(), SIZE))])
}

/// The scene with both of its materials blended.
fn blended(masked: &Scene) -> Scene {
    let mut scene = masked.clone();
    let materials = &mut Arc::make_mut(&mut scene.mesh).materials;
    (materials[0].blend, materials[1].blend) = (Some(0.8), Some(0.4));
    scene
}

/// Pixels of a frame that see other triangles than without masks, as a share of its hits.
fn share_behind_holes(scene: &Scene, camera: &Camera, frame: &Frame) -> f64 {
    let mut solid = scene.clone();
    let materials = &mut Arc::make_mut(&mut solid.mesh).materials;
    materials.iter_mut().for_each(|material| (material.texture, material.blend) = (None, None));
    let solid = render(&solid, camera).unwrap();
    let differ = ids(&solid).iter().zip(ids(frame)).filter(|(a, b)| a != b).count();
    differ as f64 / hits(frame) as f64
}

#[test]
fn traced_rays_pass_through_the_holes_that_raster_leaves() {
    let masked = masked_shapes();
    let blended = blended(&masked);
    for (name, camera) in cameras() {
        let sample = camera.of_sample([0.2, -0.3].into(), Sample { number: 1, count: 3 }).unwrap();
        for (scene, camera) in [(&masked, &camera), (&blended, &sample)] {
            let Some(raster) = render_with(scene, camera, Without::Nothing, &by(Method::Raster)) else { return };
            let traced = render_with(scene, camera, Without::Nothing, &by(Method::Trace)).unwrap();
            assert!(traced.passes.total() < raster.passes.total(), "{name}: it was rasterized");
            assert!(words(&traced.frame) == words(&raster.frame), "{name}");
            assert!(share_behind_holes(scene, camera, &traced.frame) > 0.3, "{name}");
        }
    }
}

#[test]
fn holes_move_with_their_triangles() {
    let mut scene = masked_shapes();
    let at = |x: f64| TimeStep {
        positions: scene.mesh.positions.iter().map(|p| *p + DVec3::X * x * (1.0 + p.y)).collect(),
        normals: scene.mesh.normals.clone(),
    };
    scene.steps = TimeSteps::new(vec![0.0, 1.0, 2.0], vec![at(0.0), at(0.2), at(0.1)]).map(Arc::new);
    let lines = Lines { first: 0.0, line_time: 2.0 / f64::from(SIZE.1), order: LineOrder::Down, count: SIZE.1 };
    scene.exposure = Exposure { readout: Readout::Lines(lines), shutter: 0.0, is_even: false };
    for (name, camera) in cameras() {
        let Some((frame, ..)) = check(name, &scene, &camera) else { return };
        assert!(share_behind_holes(&scene, &camera, &frame) > 0.3, "{name}");
    }
}

/// How many pixels are proven, and how many of these show another triangle than the reference of `truth`.
fn proven_and_wrong(scene: &Scene, camera: &Camera, truth: &Scene) -> Option<(usize, usize)> {
    let frame = render_of(scene, camera, vec![Channel::TriangleId, Channel::Certified])?;
    let truth = image(truth, camera, &[Channel::TriangleId]);
    let truth = truth.u32(Channel::TriangleId).unwrap();
    let certified = frame.u32(Channel::Certified).unwrap();
    let proven: Vec<usize> = (0..certified.len()).filter(|&k| certified[k] > 0).collect();
    Some((proven.len(), proven.iter().filter(|&&k| ids(&frame)[k] != truth[k]).count()))
}

#[test]
fn proofs_know_of_holes() {
    let masked = masked_shapes();
    let blended = blended(&masked);
    let mut moved = masked.clone();
    Arc::make_mut(&mut moved.mesh).uvs.iter_mut().for_each(|uv| uv.x += 1.0 / 32.0);
    let beside_spheres = with_small_spheres();
    let pixels = (SIZE.0 * SIZE.1) as usize;
    for (name, camera) in cameras().filter(|(_, camera)| !camera.is_curved_or_layered() && camera.optics.is_none()) {
        let sample = camera.of_sample([0.2, -0.3].into(), Sample { number: 1, count: 3 }).unwrap();
        for (what, scene, camera) in
            [("masked", &masked, &camera), ("blended", &blended, &sample), ("beside spheres", &beside_spheres, &camera)]
        {
            let Some((proven, wrong)) = proven_and_wrong(scene, camera, scene) else { return };
            println!("{name}, {what}: {proven} of {pixels} proven, {wrong} wrong");
            assert!(wrong == 0 && 100 * proven > 97 * pixels, "{name}, {what}: {proven} proven, {wrong} wrong");
        }
        // a mask that is off by a texel would show
        assert!(proven_and_wrong(&masked, &camera, &moved).unwrap().1 > 5, "{name}");
    }
}

fn with_small_spheres() -> Scene {
    let mut rng = Rng(6);
    let centres = (0..60).map(|_| 0.8 * rng.vector()).collect();
    let spheres = spheres_of(centres, vec![0.1; 60], None, Limits::default()).unwrap();
    scene(merge(vec![(**masked_shapes().mesh).clone(), spheres]).unwrap())
}

#[test]
fn spheres_are_seen_through_holes() {
    let scene = with_small_spheres();
    for (name, camera) in cameras() {
        let Some((frame, ..)) = check(name, &scene, &camera) else { return };
        let spheres = ids(&frame).iter().filter(|&&id| scene.mesh.radius(id).is_some()).count();
        assert!(spheres > 50, "{name}: {spheres} pixels see spheres");
        assert!(share_behind_holes(&scene, &camera, &frame) > 0.1, "{name}");
    }
}
