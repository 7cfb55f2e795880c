//! The same input gives the same bytes, whatever the order of threads, triangles and batches. Nothing to do without an
//! adapter.

use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::plan::variant::variant;
use anamorph::internals::engine::plan::{Plan, SceneContents, SceneExtent, SceneShape, Wanted};
use anamorph::internals::engine::{Method, RunOptions};
use anamorph::internals::geometry::{generate, place};
use anamorph::internals::gpu::kernels::SurfaceKind;
use anamorph::internals::image::frame::Channel;
use anamorph::internals::scene::Scene;
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, raymap};
use common::file::camera_of;
use common::gpu::{Without, engine, engine_on, ids, limit_bindings, render, render_with, wanted, words};
use common::rng::Rng;
use common::{ALL_T, FORWARD, camera, picked, scene, soup};

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

/// With all its lists.
fn by_raster() -> RunOptions {
    RunOptions { method: Method::Raster, ..RunOptions::default() }
}

fn crowd() -> Scene {
    scene(place::merge(vec![generate::icosphere(3), soup(&mut Rng(1), 500, 0.5)]).unwrap())
}

fn cameras() -> Vec<(&'static str, Camera)> {
    let (name, kind) = glc_of_each_class().swap_remove(3);
    vec![
        (name, camera(kind, SIZE, ALL_T)),
        ("mesh", camera(mesh_camera(1, 9, 7, MeshShape { discontinuous: true, ..Default::default() }), SIZE, FORWARD)),
        ("ray map", raymap(SIZE.0, SIZE.1, FORWARD)),
        ("mirror", camera_of("", SIZE, MIRROR).unwrap()),
        ("lens", camera_of("", SIZE, LENS).unwrap()),
    ]
}

/// Each camera tile by tile, where what is tested depends on the order of pairs, as those behind what is there are left out; and pair
/// by pair.
fn in_both_ways() -> impl Iterator<Item = ((&'static str, Camera), Without)> {
    cameras().into_iter().flat_map(|c| [Without::Nothing, Without::Lanes].map(|without| (c.clone(), without)))
}

#[test]
fn ten_runs_give_the_same_bytes() {
    let scene = crowd();
    for ((name, camera), without) in in_both_ways() {
        let run = || render_with(&scene, &camera, without, &RunOptions::default());
        let Some(first) = run() else { return };
        for k in 1..10 {
            let again = run().unwrap();
            assert!(words(&again.frame) == words(&first.frame) && again.srgb8 == first.srgb8, "{name}, run {k}");
            assert!(without == Without::Nothing || again.counts == first.counts, "{name}, run {k}");
        }
    }
}

#[test]
fn repeated_frames_leave_the_first_as_it_was() {
    let scene = crowd();
    for (name, camera) in cameras() {
        let Some(first) = render(&scene, &camera) else { return };
        for moving in [false, true] {
            let run = RunOptions { repeat: 3, moving, ..Default::default() };
            let again = render_with(&scene, &camera, Without::Nothing, &run).unwrap();
            assert_eq!(again.frame_ms.len(), 3);
            assert!(words(&again.frame) == words(&first), "{name}, moving {moving}");
        }
    }
}

#[test]
fn the_order_of_triangles_changes_their_ids_alone() {
    let scene = crowd();
    for (name, camera) in cameras() {
        let Some(first) = render(&scene, &camera) else { return };
        for seed in 0..3 {
            let order = Rng(seed).shuffled(scene.mesh.triangles.len());
            let shuffled = Scene { mesh: picked(&scene.mesh, &order).into(), ..scene.clone() };
            let again = render(&shuffled, &camera).unwrap();
            let back = |id: u32| order.get(id as usize).map_or(id, |&k| k as u32);
            let other = |&k: &usize| back(ids(&again)[k]) != ids(&first)[k];
            let (t, u) = (first.f32(Channel::T).unwrap(), again.f32(Channel::T).unwrap());
            // two triangles at one depth: the lower id is another one now
            assert!((0..t.len()).filter(other).all(|k| t[k] == u[k]), "{name}, seed {seed}");
            let ties = (0..t.len()).filter(other).count();
            assert!(ties <= t.len() / 1000, "{name}, seed {seed}: {ties} ties");
            for channel in Channel::ALL.into_iter().filter(|c| *c != Channel::TriangleId) {
                let (Some(a), Some(b)) = (first.f32(channel), again.f32(channel)) else { continue };
                let same = |k: usize| other(&k) || a[k].to_bits() == b[k].to_bits();
                assert!((0..a.len()).all(same), "{name}, seed {seed}: {}", channel.name());
            }
        }
    }
}

#[test]
fn two_32_bit_dispatches_give_the_bytes_of_one_of_64_bits() {
    let scene = crowd();
    for (name, camera) in cameras() {
        let Some(wide) = render_with(&scene, &camera, Without::Nothing, &RunOptions::default()) else { return };
        let narrow = render_with(&scene, &camera, Without::Int64Atomics, &RunOptions::default()).unwrap();
        assert!(words(&wide.frame) == words(&narrow.frame) && wide.srgb8 == narrow.srgb8, "{name}");
        // tile by tile f32 proves a little more, or less
        let by_pair = render_with(&scene, &camera, Without::Lanes, &RunOptions::default()).unwrap();
        assert!(words(&by_pair.frame) == words(&narrow.frame) && by_pair.srgb8 == narrow.srgb8, "{name}");
        assert_eq!(by_pair.counts, narrow.counts, "{name}");
    }
}

#[test]
fn counting_and_fewer_channels_change_no_value() {
    let scene = crowd();
    for ((name, camera), without) in in_both_ways() {
        let Some(all) = render_with(&scene, &camera, without, &by_raster()) else { return };
        let render = |wanted: &Wanted| {
            let mut engine = engine(&camera, without)?;
            engine.render(&scene, &camera, wanted, &by_raster()).ok()
        };
        let counted = render(&Wanted { counting: true, ..wanted() }).unwrap();
        assert!(words(&counted.frame) == words(&all.frame) && counted.srgb8 == all.srgb8, "{name}");
        let (some, none) = (counted.counts, all.counts);
        assert!(some.fragments_kept > 0 && some.fragments_tested > some.fragments_kept, "{name}: {some:?}");
        assert!(some.pairs_kept > 0 && some.pairs_tested >= some.pairs_kept, "{name}: {some:?}");
        assert!(without == Without::Nothing || some.rechecked == none.rechecked, "{name}");
        for channels in [vec![Channel::T], vec![Channel::BaryV, Channel::R], vec![]] {
            let few = render(&Wanted { srgb8: true, ..Wanted::of(channels.clone()) }).unwrap();
            assert!(few.srgb8 == all.srgb8 && few.frame.planes.len() == channels.len(), "{name} {channels:?}");
            for c in channels {
                let bits = |f: &[f32]| f.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
                assert_eq!(few.frame.f32(c).map(bits), all.frame.f32(c).map(bits), "{name} {c:?}");
            }
        }
    }
}

/// Bytes of a binding that split this file's pictures into bands and their meshes into chunks and batches.
const SMALL_BINDING: u64 = 1 << 16;

#[test]
#[ignore = "slow: make test-all"]
fn bands_chunks_and_batches_give_the_bytes_of_one_piece() {
    // large triangles: of the pairs of a chunk in a band, some 2,000 to 5,000, a list holds 8,192
    let scene = scene(soup(&mut Rng(4), 4000, 8.0));
    let mut cameras = cameras();
    cameras.push(("pieces", camera(mesh_camera(2, 5, 4, MeshShape::default()), SIZE, FORWARD)));
    let Some(mut small) = engine_on(|gpu| limit_bindings(gpu, SMALL_BINDING)) else { return };
    for (name, camera) in cameras {
        let Some(whole) = render_with(&scene, &camera, Without::Nothing, &RunOptions::default()) else { return };
        let extent = SceneExtent::of(&camera, SceneShape::of(&scene));
        let (contents, has) = (SceneContents::of(&scene), small.gpu.has);
        let variant = variant(&camera, contents, &wanted(), has, &RunOptions::default());
        let plan = Plan::new(variant, &camera, contents, extent, &wanted(), has, SMALL_BINDING);
        let chunks = anamorph::internals::engine::clusters::cluster(
            &*scene.mesh,
            extent.anchor,
            SurfaceKind::Plain,
            SMALL_BINDING,
        )
        .chunks
        .len();
        assert!(plan.bands.len() > 5 && chunks > 1, "{name}");
        let parts = small.render(&scene, &camera, &wanted(), &RunOptions::default()).unwrap();
        assert!(words(&parts.frame) == words(&whole.frame) && parts.srgb8 == whole.srgb8, "{name}");
        // no fewer are listed where tiles are taken whole
        let counting = Wanted { counting: true, ..wanted() };
        let by_pair = engine(&camera, Without::Lanes).unwrap().render(&scene, &camera, &counting, &by_raster());
        let kept = by_pair.unwrap().counts.pairs_kept;
        let lists = (plan.bands.len() * chunks) as u64;
        let in_one_batch = lists * SMALL_BINDING / 8;
        println!("{name}: {kept} pairs over {lists} lists, {in_one_batch} at most in one batch each");
        assert!(kept > in_one_batch / 4, "{name}: the lists are too short to need batches");
    }
}
