//! Lists that run over grow until they hold everything, and what cannot be held is an error that says so. Nothing to do
//! without an adapter.

use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Arithmetic, Capacities, Engine, Method, RunOptions};
use anamorph::internals::image::frame::Channel;
use anamorph::internals::input::Error;
use anamorph::internals::scene::Scene;
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, raymap};
use common::file::camera_of;
use common::gpu::{Without, engine_on, limit_bindings, render_with, wanted, words};
use common::rng::Rng;
use common::{FORWARD, camera, mesh, scene, soup};
use glam::DVec3;

const SIZE: (u32, u32) = (101, 77);

/// Optics before a crowd: facets whose rays meet them again, and a smooth surface.
const MIRROR: &str = r#"kind = "reflection"
eye = { kind = "pinhole", eye = [0.2, 0.4, 4], target = [0, 0, 0], vfov = 40 }
mirror = { shape = "torus", axis = [0.3, 1, 0.5], radius = 0.9, tube = 0.4, count = 300 }
facets = "normals"
depth = 3"#;
const LENS: &str = r#"kind = "refraction"
eye = { kind = "pinhole", eye = [0.2, 0.4, 4], target = [0, 0, 0], vfov = 40 }
lens = { shape = "lens", center = [0, 0, 1.5], axis = [0, 0, -1], radius = 0.9, thickness = 0.6, curvatures = [0.5, -0.6] }
ior = 1.5
depth = 2"#;

fn crowd() -> Scene {
    scene(soup(&mut Rng(9), 1000, 0.8))
}

fn cameras() -> Vec<(&'static str, Camera)> {
    let (name, kind) = glc_of_each_class().swap_remove(6);
    vec![
        (name, camera(kind, SIZE, FORWARD)),
        ("mesh", camera(mesh_camera(1, 16, 16, MeshShape::default()), SIZE, FORWARD)),
        ("ray map", raymap(SIZE.0, SIZE.1, FORWARD)),
        ("mirror", camera_of("", SIZE, MIRROR).unwrap()),
        ("lens", camera_of("", SIZE, LENS).unwrap()),
    ]
}

#[test]
fn lists_of_one_item_grow_to_the_identical_image() {
    let scene = crowd();
    for (name, camera) in cameras() {
        for without in [Without::Nothing, Without::Int64Atomics, Without::F64Depths] {
            let Some(ample) =
                render_with(&scene, &camera, without, &RunOptions { method: Method::Raster, ..Default::default() })
            else {
                return;
            };
            let large = Capacities {
                queue: 1 << 20,
                work: 1 << 20,
                tasks: 1 << 20,
                pairs: 1 << 20,
                recheck_items: 1 << 20,
                edges: 1 << 20,
            };
            for start in [
                Capacities { queue: 1, work: 1, tasks: 1, pairs: 1, recheck_items: 1, edges: 1 },
                Capacities { queue: 1, ..large },
                Capacities { work: 1, ..large },
                Capacities { tasks: 1, ..large },
                Capacities { pairs: 1, ..large },
                Capacities { recheck_items: 1, ..large },
            ] {
                let run = RunOptions { capacities: Some(start), method: Method::Raster, ..Default::default() };
                let grown = render_with(&scene, &camera, without, &run).unwrap();
                // a frame that shows three levels of nodes has two queues, and each fills the next
                let most = if start.pairs == 1 && start.work == 1 { 8 } else { 4 };
                let queued = start.queue > 1 || grown.grown > 0 || name == "mesh";
                assert!(
                    grown.grown <= most && (start.queue == 1 || grown.grown > 0) && queued,
                    "{name} {start:?}: {}",
                    grown.grown
                );
                assert!(words(&grown.frame) == words(&ample.frame) && grown.srgb8 == ample.srgb8, "{name} {start:?}");
                // tile by tile, what is left out behind the rest depends on the order of pairs
                assert!(without != Without::Int64Atomics || grown.counts == ample.counts, "{name} {start:?}");
            }
            assert_eq!(
                render_with(
                    &scene,
                    &camera,
                    without,
                    &RunOptions { capacities: Some(large), method: Method::Raster, ..Default::default() }
                )
                .unwrap()
                .grown,
                0
            );
        }
    }
}

/// Raster takes some 12,000 pairs of a tile at once, and the rest in as many rounds as it needs.
#[test]
fn more_pairs_of_one_tile_than_raster_takes_at_once_give_the_same_image() {
    let (_, kind) = glc_of_each_class().swap_remove(0);
    let camera = camera(kind, (8, 8), FORWARD);
    let scene = scene(soup(&mut Rng(6), 60_000, 2.0));
    let wanted = Wanted { counting: true, ..wanted() };
    let frame = |lanes: bool| {
        let mut engine = engine_on(|gpu| gpu.has.lanes &= lanes)?;
        Some(engine.render(&scene, &camera, &wanted, &RunOptions::default()).unwrap())
    };
    let (Some(by_tile), Some(by_pair)) = (frame(true), frame(false)) else { return };
    // no fewer are listed where tiles are taken whole
    assert!(by_pair.counts.pairs_kept > 50_000, "{:?}", by_pair.counts);
    assert!(words(&by_tile.frame) == words(&by_pair.frame) && by_tile.srgb8 == by_pair.srgb8);
    assert!(by_tile.counts.fragments_kept <= by_pair.counts.fragments_kept);
}

/// A triangle that fills 256 x 256 tiles: more than a loop has rounds on a software adapter.
#[test]
fn a_triangle_over_more_tiles_than_a_loop_has_rounds_fills_them_all() {
    let (x, y, z) = (DVec3::new(-100.0, -100.0, 0.5), DVec3::new(300.0, -100.0, 0.5), DVec3::new(-100.0, 300.0, 0.5));
    let scene = scene(mesh(vec![x, y, z], vec![[0, 1, 2]]));
    let (_, kind) = glc_of_each_class().into_iter().find(|c| c.0 == "orthographic").expect("one of that name");
    let camera = camera(kind, (2048, 2048), FORWARD);
    for lanes in [true, false] {
        let Some(mut engine) = engine_on(|gpu| gpu.has.lanes &= lanes) else { return };
        let wanted = Wanted::of(vec![Channel::TriangleId]);
        let frame = engine.render(&scene, &camera, &wanted, &RunOptions::default()).unwrap().frame;
        assert!(frame.u32(Channel::TriangleId).unwrap().iter().all(|id| *id == 0), "lanes {lanes}");
    }
}

/// Bytes of a binding on a very small adapter.
const SMALL_BINDING: u64 = 1 << 16;

fn small() -> Option<Engine> {
    engine_on(|gpu| limit_bindings(gpu, SMALL_BINDING))
}

fn error_of(scene: &Scene, camera: &Camera, wanted: &Wanted, run: &RunOptions) -> Option<Error> {
    let error = small()?.render(scene, camera, wanted, run).expect_err("an error");
    println!("{error}");
    assert_eq!(error.exit_code(), 1);
    assert!(!error.to_string().contains('\n'));
    Some(error)
}

#[test]
fn recheck_items_of_one_cluster_that_no_list_can_hold_are_an_error_with_stage_need_and_capacity() {
    // one cluster of 64 triangles over all of some 100 tiles: twice 64 halves of each are left to recheck, and a list holds 8,192
    let wall = |k: u32| {
        let z = k as f64 / 64.0;
        [DVec3::new(-200.0, -100.0, z), DVec3::new(200.0, -100.0, z), DVec3::new(0.0, 300.0, z)]
    };
    let triangles = (0..64).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let scene = scene(mesh((0..64).flat_map(wall).collect(), triangles));
    let (_, kind) = glc_of_each_class().swap_remove(0);
    let camera = camera(kind, SIZE, FORWARD);
    let few = Wanted::of(vec![Channel::TriangleId]);
    let run = RunOptions { arithmetic: Arithmetic::Double, ..Default::default() };
    let Some(error) = error_of(&scene, &camera, &few, &run) else { return };
    let text = error.to_string();
    assert!(text.contains("recheck") && text.contains(&(SMALL_BINDING / 8).to_string()), "{text}");
}

#[test]
fn an_image_too_wide_for_a_binding_is_an_error_that_names_the_limit() {
    let scene = crowd();
    let (_, kind) = glc_of_each_class().swap_remove(0);
    let camera = camera(kind, (1000, 8), FORWARD);
    let Some(error) = error_of(&scene, &camera, &wanted(), &RunOptions::default()) else { return };
    assert!(error.to_string().contains(&SMALL_BINDING.to_string()), "{error}");
    // fewer channels fit
    let few = Wanted::of(vec![Channel::TriangleId]);
    small().unwrap().render(&scene, &camera, &few, &RunOptions::default()).unwrap();
}
