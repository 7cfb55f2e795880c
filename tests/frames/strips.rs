//! Frames of some rows, frames that overlap, and frames that are shown one after the other are those of a fresh engine, bit for bit.
//! Nothing to do without an adapter.

use crate::common;
use anamorph::internals::input::Loading;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::combinations::at_once;
use anamorph::internals::engine::plan::{Rows, Wanted};
use anamorph::internals::engine::planned::Planned;
use anamorph::internals::engine::sequence::Sequence;
use anamorph::internals::engine::{Capacities, Engine, Rendered, RunOptions};
use anamorph::internals::image::frame::Channel;
use anamorph::internals::image::{read_exr, rgb8};
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::Light;
use anamorph::internals::scene::style::{Line, Outline, Style};
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, raymap};
use common::file::camera_of;
use common::gpu::{engine_on, limit_bindings, wanted, words};
use common::rng::Rng;
use common::{FORWARD, camera, moved, scene, soup};
use glam::DVec3;
use std::process::Command;
use std::sync::Arc;

const SIZE: (u32, u32) = (101, 77);

fn crowd() -> Scene {
    scene(soup(&mut Rng(9), 1000, 0.8))
}

fn cameras() -> Vec<(&'static str, Camera)> {
    let (name, kind) = glc_of_each_class().swap_remove(6);
    let panorama = "kind = \"panorama\"\ncenter = [0, 0, 0]\nradius = 3\nheight = 3";
    let twist =
        "kind = \"twist\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nvfov = 40\nnear = 2\nfar = 6\nangle = 60\ndegree = 3";
    let named = |keys: &str| camera_of("", SIZE, keys).unwrap();
    vec![
        (name, camera(kind, SIZE, FORWARD)),
        ("mesh", camera(mesh_camera(1, 16, 16, MeshShape::default()), SIZE, FORWARD)),
        ("ray map", raymap(SIZE.0, SIZE.1, FORWARD)),
        ("panorama", named(panorama)),
        ("twist", named(twist)),
    ]
}

/// Every plane as words, row by row.
fn rows_of(rendered: &Rendered) -> Vec<Vec<u32>> {
    let frame = &rendered.frame;
    let planes = words(frame);
    let pixels = frame.width as usize * frame.height as usize;
    let row = |k: usize| {
        let own = |plane: &[u32]| plane[k * frame.width as usize..(k + 1) * frame.width as usize].to_vec();
        planes.chunks_exact(pixels).flat_map(own).collect()
    };
    (0..frame.height as usize).map(row).collect()
}

#[test]
fn rows_by_themselves_are_those_of_the_whole_image() {
    let Some(mut engine) = engine_on(|_| ()) else { return };
    let scene = crowd();
    for (name, camera) in cameras() {
        for samples in [1, 4] {
            if samples > 1 && !at_once(&scene, &camera, samples) {
                continue;
            }
            let mut whole = Wanted { samples, ..wanted() };
            whole.channels.push(Channel::ObjectId);
            let run = RunOptions::default();
            let expected = engine.render(&scene, &camera, &whole, &run).unwrap();
            let (mut rows, mut srgb8) = (Vec::new(), Vec::new());
            for (first, count) in [(0, 32), (32, 32), (64, 13)] {
                let own = Wanted { rows: Some(Rows { first, count }), ..whole.clone() };
                let part = engine.render(&scene, &camera, &own, &run).unwrap();
                assert_eq!((part.frame.width, part.frame.height), (SIZE.0, count));
                rows.extend(rows_of(&part));
                srgb8.extend(part.srgb8.unwrap());
            }
            assert!(rows == rows_of(&expected), "{name}, {samples} samples");
            assert!(Some(srgb8) == expected.srgb8, "{name}, {samples} samples");
        }
    }
}

/// Lines around triangles and at creases, and between pieces: the widest reach far into the next strip.
fn lined(width: f64) -> Scene {
    let line = |width| Line { width, colour: [0.0; 3], depth: 4.0 };
    let outline = Some(Outline { line: line(width), crease: 20.0 });
    Scene { style: Style { outline, borders: Some(line(1.0)), ..Style::default() }, ..crowd() }
}

#[test]
fn lines_between_pixels_are_the_same_in_strips_and_bands() {
    let Some(mut engine) = engine_on(|_| ()) else { return };
    // bands of 16 to 24 rows of so many planes
    // 17 planes, with those that lines are found in
    let Some(mut narrow) = engine_on(|gpu| limit_bindings(gpu, 4 * 17 * 66 * 102)) else {
        return;
    };
    for (width, samples) in [(1.0, 1), (3.0, 4), (32.0, 1)] {
        let scene = lined(width);
        for (name, camera) in cameras() {
            if samples > 1 && !at_once(&scene, &camera, samples) {
                continue;
            }
            let whole = Wanted { samples, ..wanted() };
            let run = RunOptions::default();
            let expected = engine.render(&scene, &camera, &whole, &run).unwrap();
            let without = engine.render(&crowd(), &camera, &whole, &run).unwrap();
            assert!(expected.srgb8 != without.srgb8, "{name}: lines are drawn");
            let (mut rows, mut srgb8) = (Vec::new(), Vec::new());
            for (first, count) in [(0, 32), (32, 32), (64, 13)] {
                let part = Wanted { rows: Some(Rows { first, count }), ..whole.clone() };
                let part = engine.render(&scene, &camera, &part, &run).unwrap();
                rows.extend(rows_of(&part));
                srgb8.extend(part.srgb8.unwrap());
            }
            assert!(rows == rows_of(&expected), "{name}, {width} px, {samples} samples, in strips");
            assert!(Some(srgb8) == expected.srgb8, "{name}, {width} px, {samples} samples, in strips");
            let banded = narrow.render(&scene, &camera, &whole, &run).unwrap();
            assert_ne!(banded.passes, expected.passes, "{name}: one band");
            assert!(rows_of(&banded) == rows_of(&expected), "{name}, {width} px, {samples} samples, in bands");
            assert!(banded.srgb8 == expected.srgb8, "{name}, {width} px, {samples} samples, in bands");
        }
    }
}

/// Scenes and cameras in turn: what moves, what is lit, what is seen through, and the same again.
fn shows() -> Vec<(Scene, Arc<Camera>)> {
    let first = crowd();
    let light = |by: f64| vec![Light::distant(DVec3::new(by, -1.0, -0.5))];
    let turned = Scene { mesh: moved((**first.mesh).clone(), DVec3::new(0.3, -0.1, 0.2)).into(), ..first.clone() };
    let other = scene(soup(&mut Rng(4), 300, 0.5));
    let lit = |scene: &Scene, by: f64| Scene { lights: light(by), ..scene.clone() };
    let eye = |x: f64| {
        let keys = format!("kind = \"panorama\"\ncenter = [{x}, 0, 0]\nradius = 3\nheight = 3");
        Arc::new(camera_of("", SIZE, &keys).unwrap())
    };
    let (near, far) = (eye(0.0), eye(0.4));
    vec![
        (lit(&first, 0.2), near.clone()),
        (lit(&turned, 0.2), near.clone()),
        (lit(&turned, 0.9), near.clone()),
        (lit(&turned, 0.9), far.clone()),
        (lit(&other, 0.1), far.clone()),
        (lit(&first, 0.2), near.clone()),
        (lit(&first, 0.2), near),
    ]
}

#[test]
fn frames_in_flight_together_are_those_of_fresh_engines() {
    let Some(mut engine) = engine_on(|_| ()) else { return };
    let Some(mut fresh) = engine_on(|_| ()) else { return };
    let (wanted, run) = (wanted(), RunOptions::default());
    let least = Capacities { queue: 1, work: 1, tasks: 1, pairs: 1, recheck_items: 1, edges: 1 };
    // lists that hold next to nothing, so that frames are found to lack capacity when the next is on its way
    for capacities in [None, Some(least)] {
        let run = RunOptions { capacities, ..run.clone() };
        let mut last: Option<Planned> = None;
        let mut plan = |engine: &Engine, (scene, camera): &(Scene, Arc<Camera>)| {
            let planned = engine.planner().plan(scene, camera.clone(), &wanted, &run, last.as_ref()).unwrap();
            last = Some(planned.clone());
            planned
        };
        let shows = shows();
        let first = plan(&engine, &shows[0]);
        let mut sequence = Sequence::default();
        sequence.upload(&mut engine, &first, &run).unwrap();
        let mut in_flight = sequence.start(&mut engine, first).unwrap();
        let mut seen = Vec::new();
        for show in &shows[1..] {
            let planned = plan(&engine, show);
            assert!(sequence.show(&planned).unwrap());
            let next = sequence.start(&mut engine, planned).unwrap();
            let before = std::mem::replace(&mut in_flight, next);
            seen.push(sequence.wait_for(&mut engine, before).unwrap().rendered());
        }
        seen.push(sequence.wait_for(&mut engine, in_flight).unwrap().rendered());
        for (k, ((scene, camera), seen)) in shows.iter().zip(&seen).enumerate() {
            let expected = fresh.render(scene, camera.clone(), &wanted, &RunOptions::default()).unwrap();
            assert!(words(&seen.frame) == words(&expected.frame), "frame {k}");
            assert!(seen.srgb8 == expected.srgb8, "frame {k}");
        }
    }
}

/// Another kind of frame is not shown, and leaves what is there.
#[test]
fn what_is_of_another_kind_is_to_be_placed_anew() {
    let Some(mut engine) = engine_on(|_| ()) else { return };
    let (scene, run) = (crowd(), RunOptions::default());
    let (wanted, all) = (Wanted::of(vec![Channel::Z]), cameras());
    let planner = engine.planner();
    let planned = |camera: &Camera, wanted: &Wanted| planner.plan(&scene, camera, wanted, &run, None).unwrap();
    let mut sequence = Sequence::default();
    sequence.upload(&mut engine, &planned(&all[0].1, &wanted), &run).unwrap();
    assert!(!sequence.show(&planned(&all[2].1, &wanted)).unwrap());
    assert!(!sequence.show(&planned(&all[0].1, &Wanted::of(vec![Channel::T]))).unwrap());
    let in_flight = sequence.start(&mut engine, planned(&all[0].1, &wanted)).unwrap();
    let seen = sequence.wait_for(&mut engine, in_flight).unwrap().rendered();
    let expected = engine.render(&scene, &all[0].1, &wanted, &run).unwrap();
    assert!(words(&seen.frame) == words(&expected.frame));
}

const LARGE: &str = r#"
[[mesh]]
builtin = "icosphere"
level = 2
[camera]
kind = "panorama"
radius = 4
height = 3
"#;

/// An image over a gigabyte goes to its files strip by strip; they hold what the engine renders at once.
#[test]
#[ignore = "slow: make test-all"]
fn a_large_image_is_a_tiled_file_and_a_streamed_one() {
    let Some(mut engine) = engine_on(|_| ()) else { return };
    let (width, height) = (16_384, 720);
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name);
    std::fs::write(path("scene.toml"), LARGE).unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_anamorph"));
    program.current_dir(dir.path()).args(["render", "scene.toml", "--exr", "large.exr", "--channels", "Z"]);
    program.args(["-o", "large.png"]);
    let ran = program.args(["--size", &format!("{width}x{height}")]).output().unwrap();
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let bytes = std::fs::read(path("large.exr")).unwrap();
    // bit 9 of the version: a single part of tiles
    assert_eq!(u32::from_le_bytes([bytes[4], bytes[5], bytes[6], bytes[7]]) & 0x200, 0x200);
    let file = read_exr(&path("large.exr"), &Loading::default()).unwrap();
    let scene = Scene::load(&path("scene.toml"), &[], 0.0, &Loading::default()).unwrap();
    let camera = Camera::in_scene(&scene.camera, Some((width, height)), &scene.mesh, &Loading::default()).unwrap();
    let wanted = Wanted { srgb8: true, ..Wanted::of(vec![Channel::Z]) };
    let at_once = engine.render(&scene, camera, &wanted, &RunOptions::default()).unwrap();
    assert_eq!((file.width, file.height), (width, height));
    assert!(words(&file) == words(&at_once.frame));
    let shown = image::open(path("large.png")).unwrap();
    assert_eq!((shown.width(), shown.height()), (width, height));
    assert!(shown.as_bytes() == rgb8(&at_once.srgb8.unwrap()));
}
