//! Frames of a scene whose objects move, on a device that keeps the rest, are those of a device that has seen nothing before.

use crate::common;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::planned::Planned;
use anamorph::internals::engine::sequence::Sequence;
use anamorph::internals::engine::{Engine, Method, RunOptions};
use anamorph::internals::image::frame::Channel;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::Light;
use common::cameras::pinhole;
use common::file::camera_of;
use common::gpu::{engine_on, limit_bindings};
use common::rng::Rng;
use common::{FORWARD, camera, scene, soup};
use glam::{DMat3, DVec3};
use std::sync::Arc;

const SIZE: (u32, u32) = (64, 48);

/// The objects of the soup, each of so many triangles.
const OBJECTS: usize = 12;
const TRIANGLES: usize = 300;

/// Moves one object of the soup by a rotation and a translation.
fn move_object(scene: &mut Scene, rng: &mut Rng, far: f64) {
    let first = rng.below(OBJECTS) * 3 * TRIANGLES;
    let turn = DMat3::from_rotation_y(rng.signed());
    let by = far * rng.vector();
    let positions = &mut Arc::make_mut(&mut scene.mesh).positions;
    positions[first..first + 3 * TRIANGLES].iter_mut().for_each(|p| *p = turn * *p + by);
}

/// Renders the scene on a device that shows `sequence`, and on one that shows nothing, and compares all words.
fn compare(
    name: &str,
    (kept, fresh): (&mut Engine, &mut Engine),
    (sequence, last): (&mut Sequence, &mut Option<Planned>),
    scene: &Scene,
    wanted: &Wanted,
    run: &RunOptions,
) {
    let camera = Arc::new(camera(pinhole(DVec3::new(0.3, 0.5, 4.0), DVec3::ZERO, 40.0), SIZE, FORWARD));
    let planned = kept.planner().plan(scene, camera.clone(), wanted, run, last.as_ref()).unwrap();
    *last = Some(planned.clone());
    let followed = sequence.render(kept, planned, run).unwrap().rendered();
    let anew = fresh.render(scene, camera, wanted, run).unwrap();
    assert!(followed.frame == anew.frame && followed.srgb8 == anew.srgb8, "{name}");
}

#[test]
fn moved_objects_are_seen_as_by_a_device_that_saw_nothing_before() {
    let Some(mut fresh) = engine_on(|_| {}) else { return };
    let sun = Light { casts_shadows: true, ..Light::distant(DVec3::new(0.3, -1.0, -0.2)) };
    // all triangles in one table, and in several
    for limit in [None, Some(1 << 16)] {
        let Some(mut kept) = engine_on(|gpu| limit.into_iter().for_each(|bytes| limit_bindings(gpu, bytes))) else {
            return;
        };
        for (method, lights) in [(Method::Raster, Vec::new()), (Method::Trace, Vec::new()), (Method::Trace, vec![sun])]
        {
            let mut rng = Rng(11);
            let mut scene = Scene { lights, ..scene(soup(&mut rng, OBJECTS * TRIANGLES, 0.3)) };
            let wanted = Wanted { srgb8: true, ..Wanted::of(vec![Channel::T, Channel::Z, Channel::TriangleId]) };
            let run = RunOptions { method, ..RunOptions::default() };
            let (mut sequence, mut last) = (Sequence::default(), None);
            for step in 0..9 {
                let name = format!("{method:?}, {} lights, {limit:?}, step {step}", scene.lights.len());
                // nothing moves, objects move a little, and so far that triangles are put into order again
                match step {
                    0 | 4 => {}
                    7 => (0..OBJECTS).for_each(|_| move_object(&mut scene, &mut rng, 3.0)),
                    _ => move_object(&mut scene, &mut rng, 0.2),
                }
                let devices = (&mut kept, &mut fresh);
                compare(&name, devices, (&mut sequence, &mut last), &scene, &wanted, &run);
            }
        }
    }
}

/// Hierarchies are built while nothing moves, and cost more than tracing saves while all objects move far. Rays after a bounce need them in any
/// case.
#[test]
fn hierarchies_that_come_and_go_change_no_triangle() {
    let (Some(mut kept), Some(mut fresh)) = (engine_on(|_| {}), engine_on(|_| {})) else { return };
    let eye = "kind = \"pinhole\", eye = [0.3, 0.5, 4], target = [0, 0, 0], vfov = 40";
    let ball = "{ shape = \"sphere\", center = [0.2, 0.1, -0.3], radius = 0.7 }";
    for keys in [
        "kind = \"fisheye\"\neye = [0.3, 0.5, 1]\ntarget = [0, 0, 0]\nfov = 220".to_owned(),
        format!("kind = \"reflection\"\nmirror = {ball}\neye = {{ {eye} }}"),
    ] {
        let camera = Arc::new(camera_of("", SIZE, &keys).unwrap());
        let mut rng = Rng(5);
        let mut scene = scene(soup(&mut rng, OBJECTS * TRIANGLES, 0.3));
        let wanted = Wanted::of(vec![Channel::TriangleId]);
        let run = RunOptions::default();
        let (mut sequence, mut last) = (Sequence::default(), None);
        for step in 0..30 {
            if step % 15 >= 10 {
                (0..OBJECTS).for_each(|_| move_object(&mut scene, &mut rng, 1.0));
            }
            let planned = kept.planner().plan(&scene, camera.clone(), &wanted, &run, last.as_ref()).unwrap();
            last = Some(planned.clone());
            let followed = sequence.render(&mut kept, planned, &run).unwrap().rendered();
            let anew = fresh.render(&scene, camera.clone(), &wanted, &run).unwrap();
            assert!(followed.frame == anew.frame, "step {step} of {keys}");
        }
    }
}
