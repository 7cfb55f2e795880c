//! Frames aimed through another camera equal frames prepared for it, in every arithmetic.

use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::planned::Planned;
use anamorph::internals::engine::sequence::Sequence;
use anamorph::internals::engine::{Arithmetic, Capacities, Counts, Engine, RunOptions};
use anamorph::internals::geometry::generate::icosphere;
use anamorph::internals::gpu::Gpu;
use anamorph::internals::image::frame::Channel;
use common::cameras::{MeshShape, mesh_spec, pinhole, raymap};
use common::file::camera_of;
use common::gpu::{assert_right, engine_on, hits, wanted, words};
use common::{FORWARD, camera, layered, scene};
use glam::DVec3;
use std::sync::Arc;

const SIZE: (u32, u32) = (61, 45);

/// Every arithmetic, with and without culling.
fn runs() -> impl Iterator<Item = RunOptions> {
    let arithmetics = [Arithmetic::Rechecked, Arithmetic::Single, Arithmetic::Double];
    // lists that never grow: those that do are made anew for the camera that is there
    let n = 1 << 16;
    let capacities = Capacities { queue: n, work: n, tasks: n, pairs: n, recheck_items: n, edges: n };
    let run = move |arithmetic, no_cull| RunOptions {
        arithmetic,
        no_cull,
        capacities: Some(capacities),
        ..Default::default()
    };
    arithmetics.into_iter().flat_map(move |a| [false, true].map(|no_cull| run(a, no_cull)))
}

/// Pairs of cameras of pieces, of layers of them and of a field. The rays of a pair start at the same points, so that both have the same
/// anchor and pictures are equal to the byte.
fn pairs() -> [(&'static str, [Camera; 2]); 4] {
    let targets = [DVec3::ZERO, DVec3::new(0.3, -0.2, 0.1)];
    let eyes = targets.map(|target| camera(pinhole(DVec3::new(2.0, 1.0, 2.5), target, 60.0), SIZE, FORWARD));
    let pieces = [0.0, 0.2].map(|by| {
        let mut spec = mesh_spec(1, 3, 2, MeshShape::default());
        spec.vertices.iter_mut().for_each(|v| v.far.x += by);
        camera(spec, SIZE, FORWARD)
    });
    // in front of the ball, and within it
    let fields = [FORWARD, [0.45, f64::INFINITY]].map(|t_range| raymap(SIZE.0, SIZE.1, t_range));
    // the tiles of more layers need larger lists
    let chains = [2, 9].map(|layers| layered::chain(3, layers, (4, 3), MeshShape::default(), SIZE));
    [("pinhole", eyes), ("pieces", pieces), ("chain", chains), ("ray map", fields)]
}

fn check(engine: &mut Engine, what: &str) {
    let scene = scene(icosphere(2));
    let wanted = Wanted { channels: [wanted().channels, vec![Channel::ObjectId]].concat(), ..wanted() };
    for ((name, [first, second]), run) in pairs().iter().flat_map(|pair| runs().map(move |run| (pair, run))) {
        let name = format!("{name}, {what}, {:?}, no_cull {}", run.arithmetic, run.no_cull);
        let alone = [first, second].map(|camera| engine.render(&scene, camera, &wanted, &run).unwrap());
        assert!(hits(&alone[1].frame) > 100 && words(&alone[0].frame) != words(&alone[1].frame), "{name}");
        for (there, expected) in [(&[second][..], &alone[1]), (&[second, first], &alone[0])] {
            let mut frames = engine.prepare(&scene, first, &wanted, &run).unwrap();
            there.iter().for_each(|camera| frames.aim(camera).unwrap_or_else(|e| panic!("{name}: {e}")));
            let aimed = frames.finish().unwrap();
            assert!(words(&aimed.frame) == words(&expected.frame) && aimed.srgb8 == expected.srgb8, "{name}");
            // the order in which a GPU takes triangles says how many of them f32 proves to be behind another
            let counts = [&aimed, expected].map(|frame| Counts { rechecked: 0, ..frame.counts });
            assert_eq!((counts[0], &aimed.left_out), (counts[1], &expected.left_out), "{name}");
        }
    }
}

/// Removes features of an adapter.
type Less = fn(&mut Gpu);

#[test]
#[ignore = "slow: make test-all"]
fn frames_look_through_another_camera_in_every_arithmetic() {
    let less: [(&str, Less); 3] = [
        ("all", |_| {}),
        ("pair by pair", |gpu| gpu.has.lanes = false),
        ("32-bit atomics", |gpu| (gpu.has.lanes, gpu.has.atomics64) = (false, false)),
    ];
    for (what, less) in less {
        let Some(mut engine) = engine_on(less) else { return };
        check(&mut engine, what);
    }
}

/// Lenses around one eye, without the keys of a pose.
const LENSES: [(&str, &str); 4] = [
    ("fisheye", "kind = \"fisheye\"\nfov = 200"),
    ("cylinder", "kind = \"cylinder\"\nfov = 250"),
    ("sphere", "kind = \"sphere\""),
    ("panini", "kind = \"panini\"\nfov = 150"),
];

/// A lens stays on the device while its viewer turns and moves: the frames are those of an engine that sees each pose first, and right.
#[test]
fn a_viewer_that_moves_sees_what_a_new_one_sees() {
    let scene = scene(icosphere(3));
    let poses = [
        "[0, 0.2, 2.5]\ntarget = [0, 0, 0]",
        "[0.1, 0.2, 2.4]\ntarget = [0.5, 0, 0]",
        "[-3, 1, 0]\ntarget = [0, 0, 0]\nup = [1, 0, 0]",
    ];
    let less: [Less; 2] = [|_| {}, |gpu| gpu.has.f64 = false];
    for (arithmetic, less) in less.into_iter().enumerate() {
        let (Some(mut engine), Some(mut fresh)) = (engine_on(less), engine_on(less)) else { return };
        // f64 in 32-bit words takes long to compile
        for (name, lens) in &LENSES[..if arithmetic == 0 { 4 } else { 1 }] {
            let (mut sequence, mut last): (Sequence, Option<Planned>) = Default::default();
            for (k, pose) in poses.iter().enumerate() {
                let camera = Arc::new(camera_of("", SIZE, &format!("{lens}\neye = {pose}")).unwrap());
                let run = RunOptions::default();
                let planned = engine.planner().plan(&scene, camera.clone(), &wanted(), &run, last.as_ref()).unwrap();
                last = Some(planned.clone());
                let seen = sequence.render(&mut engine, planned, &run).unwrap().rendered();
                let expected = fresh.render(&scene, camera.clone(), &wanted(), &run).unwrap();
                assert!(
                    words(&seen.frame) == words(&expected.frame) && seen.srgb8 == expected.srgb8,
                    "{name}, pose {k}"
                );
                assert!(hits(&seen.frame) > 30, "{name}, pose {k}");
                assert_right(&format!("{name}, pose {k}"), &scene, &camera, &seen.frame);
            }
        }
    }
}
