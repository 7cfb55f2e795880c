//! Meshes that stand in several places are traced there: frames are those of a copy of each mesh at each place.

use crate::common;
use anamorph::internals::camera::Camera;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::planned::Planned;
use anamorph::internals::engine::sequence::Sequence;
use anamorph::internals::engine::{Method, RunOptions};
use anamorph::internals::geometry::generate;
use anamorph::internals::geometry::instances::{Instances, at_places};
use anamorph::internals::geometry::mesh::{Material, Mesh};
use anamorph::internals::geometry::scene_mesh::SceneMesh;
use anamorph::internals::image::frame::{Channel, Frame};
use anamorph::internals::reference::image;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::Light;
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, pinhole, raymap};
use common::gpu::{Without, assert_right, engine_on, hits, ids, render_with, wanted, words};
use common::rng::Rng;
use common::{FORWARD, camera, layered, scene, soup};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use std::sync::Arc;

const SIZE: (u32, u32) = (61, 45);

/// A matrix that turns, shears, scales and now and then mirrors, and puts the middle of the mesh anywhere in the cube of half-size `far`.
fn matrix(rng: &mut Rng, far: f64) -> DAffine3 {
    let turn = DMat3::from_rotation_y(3.0 * rng.signed()) * DMat3::from_rotation_x(rng.signed());
    let shear = DMat3::from_cols(DVec3::X, DVec3::new(0.3 * rng.signed(), 1.0, 0.0), DVec3::Z);
    let mirror = if rng.below(4) == 0 { -1.0 } else { 1.0 };
    let scale = DMat3::from_diagonal(DVec3::new(mirror, 1.0, 1.0) * (0.2 + 0.1 * rng.signed()));
    DAffine3 { matrix3: turn * shear * scale, translation: far * rng.vector() }
}

/// A ball with normals, some triangles of which show one side alone.
fn ball() -> Mesh {
    let mut ball = generate::icosphere(3);
    ball.normals = ball.positions.iter().map(|p| p.as_vec3().normalize() + Vec3::splat(0.1)).collect();
    ball.corner_normals.clone_from(&ball.triangles);
    ball.materials.push(Material { two_sided: false, diffuse: [0.9, 0.3, 0.1], ..ball.materials[0].clone() });
    ball.material_of.iter_mut().step_by(3).for_each(|material| *material = 1);
    ball.colors = ball.positions.iter().map(|p| (0.5 * p.as_vec3() + Vec3::splat(0.5)).to_array()).collect();
    ball.corner_colors.clone_from(&ball.triangles);
    ball
}

/// The largest difference of colours at pixels of the same triangle.
fn color_difference(a: &Frame, b: &Frame) -> f32 {
    let same = ids(a).iter().zip(ids(b)).map(|(a, b)| a == b);
    let same: Vec<bool> = same.collect();
    let of = |channel: Channel| {
        let both = a.f32(channel).unwrap().iter().zip(b.f32(channel).unwrap());
        let differences = both.zip(&same).filter(|(_, same)| **same).map(|((a, b), _)| (a - b).abs());
        differences.fold(0.0, f32::max)
    };
    [Channel::R, Channel::G, Channel::B].into_iter().map(of).fold(0.0, f32::max)
}

/// Balls and crowds of triangles in 40 places, and some triangles that stand once.
fn instances(seed: u64) -> Instances {
    let mut rng = Rng(seed);
    let [balls, crowds] = [30, 10].map(|n| (0..n).map(|_| matrix(&mut rng, 0.9)).collect::<Vec<_>>());
    let parts = vec![
        at_places(ball(), balls),
        (soup(&mut rng, 40, 0.3), None),
        at_places(soup(&mut rng, 200, 0.4), crowds),
        at_places(soup(&mut rng, 5, 0.3), []),
    ];
    Instances::new(parts).unwrap()
}

fn scene_of(instances: Instances) -> Scene {
    Scene { mesh: Arc::new(Arc::new(instances).into()), ..scene(Mesh::default()) }
}

/// The same with one mesh.
fn copied(scene: &Scene) -> Scene {
    Scene { mesh: Arc::new(SceneMesh::from(scene.mesh.mesh().clone())), ..scene.clone() }
}

fn cameras() -> Vec<(&'static str, Camera)> {
    let mut list: Vec<(&str, Camera)> =
        glc_of_each_class().into_iter().map(|(name, kind)| (name, camera(kind, SIZE, FORWARD))).collect();
    let shape = MeshShape { discontinuous: true, ..Default::default() };
    list.extend([
        ("pinhole", camera(pinhole(DVec3::new(0.3, 0.5, 4.0), DVec3::ZERO, 40.0), SIZE, FORWARD)),
        ("pinhole among the meshes", camera(pinhole(DVec3::new(0.1, 0.2, 0.3), DVec3::Z, 90.0), SIZE, FORWARD)),
        ("range", camera(pinhole(DVec3::new(0.3, 0.5, 4.0), DVec3::ZERO, 40.0), SIZE, [3.5, 4.25])),
        ("mesh", camera(mesh_camera(1, 9, 7, shape), SIZE, FORWARD)),
        ("ray map", raymap(SIZE.0, SIZE.1, FORWARD)),
        ("chain", layered::chain(3, 3, (4, 3), MeshShape::default(), SIZE)),
    ]);
    list
}

const TRACED: &str = "meshes stand in several places";

/// Compares frames of meshes in their places with the reference, and with frames of copies, by each of some ways to do without features.
fn compare(cameras: Vec<(&str, Camera)>, ways: impl Fn(usize) -> Vec<Without>) {
    let placed = scene_of(instances(1));
    let copies = copied(&placed);
    for (k, (name, camera)) in cameras.into_iter().enumerate() {
        let truth = image::image(&placed, &camera, &wanted().channels);
        assert!(words(&truth) == words(&image::image(&copies, &camera, &wanted().channels)), "{name}");
        for without in ways(k) {
            let Some(rendered) = render_with(&placed, &camera, without, &RunOptions::default()) else { return };
            assert_eq!(rendered.method.why, TRACED);
            assert_right(&format!("{name}, {without:?}"), &placed, &camera, &rendered.frame);
            assert!(hits(&rendered.frame) > 300 || name == "range", "{name}: {} hits", hits(&rendered.frame));
            let run = RunOptions { method: Method::Trace, ..RunOptions::default() };
            let traced = render_with(&copies, &camera, without, &run).unwrap();
            let differ = ids(&rendered.frame).iter().zip(ids(&traced.frame)).filter(|(a, b)| a != b).count();
            // rounded in another way: a pixel or two may lie within it of an edge
            assert!(differ <= 2, "{name}, {without:?}: {differ} pixels differ from those of copies");
            // f32 normals that were turned in f32, and weights of corners
            let color = color_difference(&rendered.frame, &traced.frame);
            assert!(color < 1e-3, "{name}, {without:?}: colours differ by {color}");
        }
    }
}

#[test]
fn meshes_are_seen_in_their_places() {
    let few = ["pinhole among the meshes", "mesh", "ray map"];
    let cameras = cameras().into_iter().filter(|(name, _)| few.contains(name)).collect();
    compare(cameras, |_| vec![Without::Nothing]);
}

#[test]
#[ignore = "slow: make test-all"]
fn every_camera_sees_meshes_in_their_places() {
    compare(cameras(), |k| vec![Without::Nothing, [Without::Int64Atomics, Without::F64][k % 2]]);
}

#[test]
fn meshes_of_any_size_and_far_away() {
    for (scale, to) in [(1e-9, 0.0), (1e9, 0.0), (1e15, 0.0), (1.0, 1e6), (1e-3, 1e3)] {
        let mut all = instances(2);
        for instance in &mut all.list {
            let own = instance.matrix.unwrap_or(DAffine3::IDENTITY);
            let scaled = DAffine3::from_scale(DVec3::splat(scale)) * own;
            instance.matrix = Some(DAffine3::from_translation(to * DVec3::X) * scaled);
        }
        let placed = scene_of(all);
        let eye = DVec3::new(to, 0.1 * scale, 3.0 * scale);
        let camera = camera(pinhole(eye, DVec3::X * to, 40.0), SIZE, FORWARD);
        let Some(rendered) = render_with(&placed, &camera, Without::Nothing, &RunOptions::default()) else { return };
        assert_eq!(rendered.method.why, TRACED);
        assert_right(&format!("scale {scale}, at {to}"), &placed, &camera, &rendered.frame);
        assert!(hits(&rendered.frame) > 500, "scale {scale}, at {to}");
    }
}

#[test]
fn what_places_are_not_traced_for_is_rendered_of_copies() {
    let shadow = Light { casts_shadows: true, ..Light::distant(DVec3::new(0.3, -1.0, -0.2)) };
    let plain = scene_of(instances(3));
    let eye = camera(pinhole(DVec3::new(0.3, 0.5, 4.0), DVec3::ZERO, 40.0), SIZE, FORWARD);
    let with = |method| RunOptions { method, ..RunOptions::default() };
    let samples = Wanted { samples: 4, ..wanted() };
    let mut flat = instances(3);
    flat.list[4].matrix = Some(DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0)));
    let cases = [
        ("raster", plain.clone(), eye.clone(), wanted(), with(Method::Raster)),
        ("shadows", Scene { lights: vec![shadow], ..plain.clone() }, eye.clone(), wanted(), with(Method::Auto)),
        ("samples", plain.clone(), eye.clone(), samples, with(Method::Auto)),
        ("curves", plain, layered::wavy(2, 0.5, true, SIZE), wanted(), with(Method::Auto)),
        ("a matrix without inverse", scene_of(flat), eye, wanted(), with(Method::Trace)),
    ];
    for (name, placed, camera, wanted, run) in cases {
        let Some(mut engine) = engine_on(|_| {}) else { return };
        let rendered = engine.render(&placed, &camera, &wanted, &run).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_ne!(rendered.method.why, TRACED, "{name}");
        let of_copies = engine.render(&copied(&placed), &camera, &wanted, &run).unwrap();
        assert!(rendered.frame == of_copies.frame && rendered.srgb8 == of_copies.srgb8, "{name}");
    }
}

#[test]
fn meshes_that_get_other_places_are_seen_as_by_a_device_that_saw_nothing_before() {
    let (Some(mut kept), Some(mut fresh)) = (engine_on(|_| {}), engine_on(|_| {})) else { return };
    let mut rng = Rng(4);
    let mut scene = scene_of(instances(4));
    let wanted = Wanted { srgb8: true, ..Wanted::of(vec![Channel::T, Channel::NormalX, Channel::TriangleId]) };
    let (run, mut sequence) = (RunOptions::default(), Sequence::default());
    let mut last: Option<Planned> = None;
    for step in 0..8 {
        // one mesh, all of them, and the camera alone
        let moved = if step == 4 { 0..30 } else { 3 * step..3 * step + usize::from(step != 2) };
        for k in moved {
            Arc::make_mut(&mut scene.mesh).place(k, Some(matrix(&mut rng, 0.9)));
        }
        // in the third step so far away that places are relative to another anchor
        let far = if step == 2 { 40.0 } else { 4.0 };
        let eye = DVec3::new(0.3 + 0.1 * step as f64, 0.5, far);
        let camera = Arc::new(camera(pinhole(eye, DVec3::ZERO, 40.0), SIZE, FORWARD));
        let planned = kept.planner().plan(&scene, camera.clone(), &wanted, &run, last.as_ref()).unwrap();
        last = Some(planned.clone());
        let followed = sequence.render(&mut kept, planned, &run).unwrap().rendered();
        assert_eq!(followed.method.why, TRACED);
        let anew = fresh.render(&scene, camera, &wanted, &run).unwrap();
        assert!(followed.frame == anew.frame && followed.srgb8 == anew.srgb8, "step {step}");
    }
}
