//! Frames aimed through another camera equal frames prepared for it, in every arithmetic.

use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::camera::exposure::{Exposure, LineOrder, Lines, Readout};
use anamorph::internals::camera::spec::CameraKind;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::planned::Planned;
use anamorph::internals::engine::sequence::Sequence;
use anamorph::internals::engine::{Arithmetic, Capacities, Counts, Engine, RunOptions};
use anamorph::internals::geometry::generate::icosphere;
use anamorph::internals::geometry::time_steps::{TimeStep, TimeSteps};
use anamorph::internals::gpu::Gpu;
use anamorph::internals::image::frame::Channel;
use anamorph::internals::scene::Scene;
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
        camera(CameraKind::new("mesh", spec), SIZE, FORWARD)
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

/// Each pixel sees moving objects at its own time, through another camera too.
#[test]
fn frames_of_moving_objects_look_through_another_camera() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let mut scene = scene(icosphere(2));
    let at = |x: f64| TimeStep {
        positions: scene.mesh.positions.iter().map(|p| *p + DVec3::X * x).collect(),
        normals: scene.mesh.normals.clone(),
    };
    scene.steps = TimeSteps::new(vec![0.0, 1.0], vec![at(-0.3), at(0.3)]).map(Arc::new);
    let lines = Lines { first: 0.0, line_time: 1.0 / f64::from(SIZE.1), order: LineOrder::Down, count: SIZE.1 };
    scene.exposure = Exposure { readout: Readout::Lines(lines), shutter: 0.0, is_even: false };
    for (name, [first, second]) in &pairs() {
        let run = RunOptions::default();
        let expected = engine.render(&scene, second, &wanted(), &run).unwrap();
        let mut frames = engine.prepare(&scene, first, &wanted(), &run).unwrap();
        frames.aim(second).unwrap_or_else(|e| panic!("{name}: {e}"));
        let aimed = frames.finish().unwrap();
        assert!(hits(&aimed.frame) > 100 && words(&aimed.frame) == words(&expected.frame), "{name}");
    }
}

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

/// Keys of poses: of an eye, of a circle's middle, and of a display.
const EYES: [&str; 3] = [
    "eye = [0, 0.2, 2.5]\ntarget = [0, 0, 0]",
    "eye = [0.1, 0.2, 2.4]\ntarget = [0.5, 0, 0]",
    "eye = [-3, 1, 0]\ntarget = [0, 0, 0]\nup = [1, 0, 0]",
];
const CIRCLES: [&str; 3] = ["axis = [0, 1, 0]", "axis = [0.1, 1, 0.2]", "center = [0.1, 0.2, 0]\naxis = [1, 1, 0]"];
const DISPLAYS: [&str; 3] = [
    "center = [0, 0, 1.5]\nnormal = [0, 0, 1]",
    "center = [0.1, 0, 1.4]\nnormal = [0.1, 0, 1]",
    "center = [-2, 0, 0]\nnormal = [-1, 0, 0]",
];

/// Lenses, without the keys of a pose, and poses.
const LENSES: [(&str, &str, [&str; 3]); 8] = [
    ("fisheye", "kind = \"fisheye\"\nfov = 200", EYES),
    ("ods", "kind = \"ods\"\nipd = 0.3", EYES),
    ("cylinder", "kind = \"cylinder\"\nfov = 250", EYES),
    ("sphere", "kind = \"sphere\"", EYES),
    ("panini", "kind = \"panini\"\nfov = 150", EYES),
    ("panorama", "kind = \"panorama\"\nradius = 3\nheight = 3", CIRCLES),
    ("lightfield", "kind = \"lightfield\"\nwidth = 2\nheight = 2\nviews = [6, 4]\nfov = 30", DISPLAYS),
    (
        "lidar",
        "kind = \"lidar\"\nbeams = [20, 12, 4, -4, -12, -20]\ncolumns = 90\nvelocity = [0.2, 0.1, 0]\nperiod = 0.5",
        EYES,
    ),
];

/// Renders the cameras one after another in one sequence. Each frame must equal a fresh frame bit for bit, and be right.
fn assert_poses_alike(name: &str, less: Less, scene: &Scene, wanted: &Wanted, cameras: impl Iterator<Item = Camera>) {
    let (Some(mut engine), Some(mut fresh)) = (engine_on(less), engine_on(less)) else { return };
    let (mut sequence, mut last): (Sequence, Option<Planned>) = Default::default();
    for (k, camera) in cameras.map(Arc::new).enumerate() {
        let run = RunOptions::default();
        let planned = engine.planner().plan(scene, camera.clone(), wanted, &run, last.as_ref()).unwrap();
        last = Some(planned.clone());
        let seen = sequence.render(&mut engine, planned, &run).unwrap().rendered();
        let expected = fresh.render(scene, camera.clone(), wanted, &run).unwrap();
        assert!(words(&seen.frame) == words(&expected.frame) && seen.srgb8 == expected.srgb8, "{name}, pose {k}");
        assert!(hits(&seen.frame) > 30, "{name}, pose {k}");
        assert_right(&format!("{name}, pose {k}"), scene, &camera, &seen.frame);
    }
}

/// A lens stays on the device while its viewer turns and moves.
#[test]
fn a_viewer_that_moves_sees_what_a_new_one_sees() {
    let scene = scene(icosphere(3));
    let less: [Less; 2] = [|_| {}, |gpu| gpu.has.f64 = false];
    for (arithmetic, less) in less.into_iter().enumerate() {
        // f64 in 32-bit words takes long to compile
        for (name, lens, poses) in &LENSES[..if arithmetic == 0 { LENSES.len() } else { 2 }] {
            let size = match *name {
                "lidar" => (90, 6),
                "ods" | "lightfield" => (60, 44),
                _ => SIZE,
            };
            let camera = |pose: &&str| camera_of("", size, &format!("{lens}\n{pose}")).unwrap();
            assert_poses_alike(name, less, &scene, &wanted(), poses.iter().map(camera));
        }
    }
}

/// The pixels that each piece owns are found once for all poses.
#[test]
fn a_camera_of_pieces_that_moves_sees_what_a_new_one_sees() {
    let scene = scene(icosphere(3));
    for (name, keys) in [
        ("one piece", "kind = \"pinhole\"\nvfov = 60"),
        (
            "two slits",
            "kind = \"cross_slit\"\nheight = 3\nslits = [{ distance = 3, angle = 10 }, { distance = 5, angle = 90 }]",
        ),
        ("pieces of one weight", "kind = \"fisheye\"\nfov = 150\npieces = 60"),
        ("strips", "kind = \"cylinder\"\nfov = 250\nstrips = 7"),
    ] {
        for samples in [1, 4] {
            let wanted = Wanted { samples, ..wanted() };
            let camera = |pose: &&str| camera_of("", SIZE, &format!("{keys}\n{pose}")).unwrap();
            assert_poses_alike(&format!("{name}, {samples} samples"), |_| {}, &scene, &wanted, EYES.iter().map(camera));
        }
    }
}

/// A mirror or lens, and the triangles with its facets, stay on the device while the eye in front of it moves.
#[test]
fn an_eye_that_moves_before_a_mirror_sees_what_a_new_one_sees() {
    let scene = scene(icosphere(3));
    let optics = [
        "kind = \"reflection\"\ndepth = 2\nmirror = { shape = \"sphere\", center = [1.5, 0, 0], radius = 0.8 }",
        "kind = \"reflection\"\nfacets = \"flat\"\nmirror = { shape = \"sphere\", center = [1.5, 0, 0], radius = 0.8, count = 200 }",
        "kind = \"refraction\"\nior = 1.5\nfacets = \"normals\"\ndepth = 3\nlens = { shape = \"sphere\", center = [0, 0.3, 2], radius = 0.7, count = 200 }",
    ];
    let eyes = [
        "{ kind = \"pinhole\", eye = [0.5, 0.5, 4], target = [0.5, 0, 0], vfov = 50 }",
        "{ kind = \"pinhole\", eye = [0.4, 0.6, 4], target = [0.6, 0, 0], vfov = 50 }",
        "{ kind = \"pinhole\", eye = [-2, 1.5, 5], target = [0.5, 0, 0], vfov = 50 }",
    ];
    for keys in optics {
        let camera = |eye: &&str| camera_of("", SIZE, &format!("{keys}\neye = {eye}")).unwrap();
        assert_poses_alike(keys, |_| {}, &scene, &wanted(), eyes.iter().map(camera));
    }
}
