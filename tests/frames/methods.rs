//! What raster finds, trace finds, to the last bit; and `--method auto` traces where that costs less.

use crate::common;
use anamorph::internals::input::Loading;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::sequence::Sequence;
use anamorph::internals::engine::{Engine, Method, Rendered, RunOptions};
use anamorph::internals::geometry::mesh::Mesh;
use anamorph::internals::geometry::{generate, place};
use anamorph::internals::image::frame::Channel;
use anamorph::internals::scene::Scene;
use anamorph::internals::tools::example::EXAMPLES;
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, pinhole, raymap};
use common::file::camera_of;
use common::gpu::{Without, engine, engine_on, render_with, words};
use common::layered;
use common::rng::Rng;
use common::{ALL_T, FORWARD, camera, scene, soup};
use glam::DVec3;
use std::sync::Arc;

const SIZE: (u32, u32) = (61, 45);

const EYE: &str = r#"eye = { kind = "pinhole", eye = [0.2, 0.4, 4], target = [0, 0, 0], vfov = 40 }"#;

/// Every class of rays: pieces of all kinds, a field, chains, curves of each degree, and rays that bounce.
fn cameras() -> Vec<(&'static str, Camera)> {
    let mut list: Vec<(&str, Camera)> =
        glc_of_each_class().into_iter().map(|(name, kind)| (name, camera(kind, SIZE, ALL_T))).collect();
    let shape = MeshShape { discontinuous: true, ..Default::default() };
    let optics = |keys: &str| camera_of("", SIZE, &format!("{keys}\n{EYE}")).unwrap();
    list.extend([
        ("mesh", camera(mesh_camera(1, 9, 7, shape), SIZE, FORWARD)),
        ("ray map", raymap(SIZE.0, SIZE.1, FORWARD)),
        ("chain", layered::chain(3, 3, (4, 3), MeshShape::default(), SIZE)),
        ("curves of degree 2", layered::wavy(2, 0.5, true, SIZE)),
        ("curves of degree 3", layered::wavy(3, 1.5, false, SIZE)),
        ("straight, then curved", layered::straight_then_curved(SIZE)),
        (
            "mirror",
            optics(
                "kind = \"reflection\"\nfacets = \"normals\"\ndepth = 3\nmirror = { shape = \"torus\", axis = [0.3, 1, 0.5], radius = 0.9, tube = 0.4, count = 300 }",
            ),
        ),
        (
            "glass",
            optics(
                "kind = \"refraction\"\nior = 1.5\nfresnel = true\ndepth = 3\nlens = { shape = \"sphere\", center = [0, 0, 0.4], radius = 0.8 }",
            ),
        ),
    ]);
    list
}

/// A ball, triangles of all sizes through each other, some of them one-sided.
fn crowd() -> Mesh {
    let mut rng = Rng(1);
    let mut all =
        place::merge(vec![generate::icosphere(3), soup(&mut rng, 400, 0.5), soup(&mut rng, 300, 0.02)]).unwrap();
    let one_sided = anamorph::internals::geometry::mesh::Material { two_sided: false, ..all.materials[0].clone() };
    all.materials.push(one_sided);
    let last = all.materials.len() as u32 - 1;
    all.material_of.iter_mut().step_by(3).for_each(|material| *material = last);
    all
}

fn scaled(mesh: &Mesh, by: f64, to: DVec3) -> Mesh {
    Mesh { positions: mesh.positions.iter().map(|p| by * *p + to).collect(), ..mesh.clone() }
}

fn by(method: Method) -> RunOptions {
    RunOptions { method, ..RunOptions::default() }
}

fn assert_same(name: &str, raster: &Rendered, other: &Rendered) {
    assert!(words(&raster.frame) == words(&other.frame) && raster.srgb8 == other.srgb8, "{name}");
}

#[test]
fn trace_gives_the_bytes_of_raster() {
    let crowd = crowd();
    let scenes = [
        ("crowd", scene(crowd.clone())),
        // many in a pixel
        ("grains", scene(soup(&mut Rng(5), 4000, 0.01))),
        ("without triangles", scene(Mesh { triangles: Vec::new(), material_of: Vec::new(), ..crowd })),
    ];
    for (k, (name, camera)) in cameras().into_iter().enumerate() {
        for (what, scene) in &scenes {
            // of a crowd alone by what costs less, and every other camera in two dispatches, the others with depths in f32
            let (all, methods) = match *what {
                "crowd" => (
                    vec![Without::Nothing, [Without::Int64Atomics, Without::F64Depths][k % 2]],
                    vec![Method::Trace, Method::Auto],
                ),
                _ => (vec![Without::Nothing], vec![Method::Trace]),
            };
            for without in all {
                let Some(raster) = render_with(scene, &camera, without, &by(Method::Raster)) else { return };
                for &method in &methods {
                    let other = render_with(scene, &camera, without, &by(method)).unwrap();
                    assert_same(&format!("{name}, {what}, {without:?}, {method:?}"), &raster, &other);
                }
                assert_eq!(raster.method.name, "raster");
            }
        }
    }
}

#[test]
fn every_method_gives_the_same_bytes_at_any_size_and_far_away() {
    let eye =
        |at: f64, by: f64| camera(pinhole(DVec3::new(at, 0.1 * by, 3.0 * by), DVec3::X * at, 40.0), SIZE, FORWARD);
    for (scale, to) in [(1e-9, 0.0), (1e9, 0.0), (3e19, 0.0), (1e25, 0.0), (1.0, 1e6), (1e-3, 1e3)] {
        let scene = scene(scaled(&crowd(), scale, DVec3::X * to));
        let camera = eye(to, scale);
        let Some(raster) = render_with(&scene, &camera, Without::Nothing, &by(Method::Raster)) else { return };
        for (without, method) in [(Without::Nothing, Method::Trace), (Without::F64Depths, Method::Raster)] {
            let other = render_with(&scene, &camera, without, &by(method)).unwrap();
            assert_same(&format!("{scale} at {to}, {without:?}, {method:?}"), &raster, &other);
        }
        let seen = raster.frame.u32(Channel::TriangleId).unwrap();
        assert!(seen.iter().any(|id| *id != seen[0]), "{scale} at {to}: nothing is seen");
    }
}

#[test]
fn what_is_behind_the_ends_of_t_is_left_out() {
    let camera = camera(pinhole(DVec3::new(0.1, 0.2, 3.0), DVec3::ZERO, 40.0), SIZE, [2.3, 3.1]);
    let scene = scene(crowd());
    let Some(raster) = render_with(&scene, &camera, Without::Nothing, &by(Method::Raster)) else { return };
    for (without, method) in [(Without::Nothing, Method::Trace), (Without::F64Depths, Method::Raster)] {
        let other = render_with(&scene, &camera, without, &by(method)).unwrap();
        assert_same("a thin slice", &raster, &other);
    }
}

/// An engine that rates raster and trace as on a software adapter: a GPU builds no hierarchy for scenes of this size.
fn rated_as_software() -> Option<Engine> {
    engine_on(|gpu| gpu.has.software = true)
}

#[test]
fn trace_takes_over_where_raster_costs_more() {
    // each triangle covers the image
    let heavy = scene(soup(&mut Rng(7), 3000, 30.0));
    let light = scene(soup(&mut Rng(7), 300, 0.1));
    // so large that the tiles of a triangle cost more than building a hierarchy with it
    let size = (2 * SIZE.0, 2 * SIZE.1);
    let camera = Arc::new(camera(pinhole(DVec3::new(0.1, 0.2, 9.0), DVec3::ZERO, 40.0), size, FORWARD));
    let Some(mut engine) = rated_as_software() else { return };
    let wanted = Wanted::of(vec![Channel::T, Channel::TriangleId]);
    let mut run = |scene: &Scene, method, repeat| {
        let run = RunOptions { repeat, ..by(method) };
        engine.render(scene, camera.clone(), &wanted, &run).unwrap()
    };
    for repeat in [0, 3] {
        let auto = run(&heavy, Method::Auto, repeat);
        assert_eq!((auto.method.name, auto.grown), ("trace", 1), "{}", auto.method.why);
        assert!(auto.stages.is_empty() || auto.stages.iter().any(|stage| stage.0 == "trace"));
        assert_same("heavy", &run(&heavy, Method::Raster, 0), &auto);
        let auto = run(&light, Method::Auto, repeat);
        assert_eq!((auto.method.name, auto.grown), ("raster", 0), "{}", auto.method.why);
        assert_same("light", &run(&light, Method::Raster, 0), &auto);
    }
}

#[test]
fn frames_that_repeat_are_traced_once_that_has_paid() {
    // dear for raster, but not so that building a hierarchy for one frame pays
    let dense = scene(generate::icosphere(5));
    let camera = Arc::new(camera(pinhole(DVec3::new(0.0, 0.0, 9.0), DVec3::ZERO, 40.0), (24, 18), FORWARD));
    let Some(mut engine) = rated_as_software() else { return };
    let wanted = Wanted::of(vec![Channel::T, Channel::TriangleId]);
    let mut frames = engine.prepare(&dense, camera, &wanted, &RunOptions::default()).unwrap();
    for _ in 0..8 {
        frames.frame().unwrap();
    }
    assert_eq!(frames.finish().unwrap().method.name, "trace");
}

#[test]
fn what_takes_pairs_is_rastered_and_says_so() {
    let camera = Arc::new(camera(pinhole(DVec3::new(0.1, 0.2, 3.0), DVec3::ZERO, 40.0), SIZE, FORWARD));
    let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
    let all = scene(crowd());
    for wanted in [
        Wanted { samples: 4, srgb8: true, ..Wanted::of(Vec::new()) },
        Wanted::of(vec![Channel::Certified, Channel::TriangleId]),
    ] {
        let seen = engine.render(&all, camera.clone(), &wanted, &by(Method::Trace)).unwrap();
        assert!(seen.method.name == "raster" && seen.method.why.contains("pairs"), "{:?}", seen.method);
    }
}

/// Poses of a path that trace took over are traced from the start, until raster is tried again.
#[test]
fn a_path_that_was_traced_leaves_raster_out() {
    let heavy = scene(soup(&mut Rng(7), 3000, 30.0));
    let light = scene(soup(&mut Rng(7), 300, 0.1));
    let Some(mut engine) = rated_as_software() else { return };
    let wanted = Wanted::of(vec![Channel::T, Channel::TriangleId]);
    let (run, mut sequence, mut last) = (RunOptions::default(), Sequence::default(), None);
    let mut render = |scene: &Scene, k: u32| {
        let eye = DVec3::new(0.1, 0.01 * f64::from(k), 9.0);
        let camera = camera(pinhole(eye, DVec3::ZERO, 40.0), (2 * SIZE.0, 2 * SIZE.1), FORWARD);
        let planned = engine.planner().plan(scene, Arc::new(camera), &wanted, &run, last.as_ref()).unwrap();
        last = Some(planned.clone());
        let rendered = sequence.render(&mut engine, planned, &run).unwrap().rendered();
        (rendered.method.name, rendered.counts.cull_items > 0)
    };
    let is_tried: Vec<bool> = (0..9)
        .map(|k| {
            let (name, is_tried) = render(&heavy, k);
            assert_eq!(name, "trace", "pose {k}");
            is_tried
        })
        .collect();
    // after one frame, two and four
    assert_eq!(is_tried, [true, false, true, false, false, true, false, false, false]);
    // other triangles are new
    for k in 0..3 {
        assert_eq!(render(&light, k), ("raster", true), "pose {k}");
    }
}

/// A software adapter ends the loops of threads that together took 65535 rounds: many triangles near curves that bend much. Such a frame is
/// rasterized, and where tracing was asked for refused.
#[test]
#[ignore = "slow: make test-all"]
fn what_takes_too_many_rounds_is_rasterized() {
    let folder = tempfile::tempdir().unwrap();
    let example = EXAMPLES.iter().find(|e| e.name == "tree").unwrap();
    let keys = ["image.width=120", "image.height=90", "camera.near=70", "camera.cut=60"].map(str::to_owned);
    let scene = Scene::load(&example.write(folder.path()).unwrap(), &keys, 0.0, &Loading::default()).unwrap();
    let camera = scene.camera().unwrap();
    let Some((frame, ..)) = common::gpu::check("tree", &scene, &camera) else { return };
    assert!(common::gpu::hits(&frame) > 5000);
    let Some(mut engine) = engine_on(|_| {}) else { return };
    // a GPU has no such limit
    if let Err(error) = engine.render(&scene, &camera, &common::gpu::wanted(), &by(Method::Trace)) {
        assert!(error.to_string().contains("too many steps here; use --method raster"), "{error}");
    }
    // so is a frame that follows another one
    let run = RunOptions::default();
    let planned = engine.planner().plan(&scene, camera, &common::gpu::wanted(), &run, None).unwrap();
    let mut sequence = Sequence::default();
    for _ in 0..2 {
        let next = sequence.render(&mut engine, planned.clone(), &run).unwrap().rendered();
        assert_eq!(next.frame.u32(Channel::TriangleId), frame.u32(Channel::TriangleId));
    }
}
