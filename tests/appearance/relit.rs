//! Frames that are lit anew: the picture is that of frames made so from the start, by the stages alone that light concerns.

use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::gpu::Gpu;
use anamorph::internals::scene::Scene;
use common::file::load;
use common::gpu::{engine_on, hits, wanted, words};
use std::sync::Arc;

const THINGS: &str = r#"
[[mesh]]
builtin = "icosphere"
level = 2
translate = [-0.9, 0, 0]
color = [0.7, 0.3, 0.2]
[[mesh]]
builtin = "box"
scale = 0.8
rotate = [10, 30, 0]
translate = [1, 0, 0.4]
"#;

const SLITS: &str = "kind = \"cross_slit\"\nslits = [{ distance = 9, angle = 90 }, { distance = 5, angle = 0 }]\neye = [0, 0.8, 5]\ntarget = [0, 0, 0]\nheight = 2.6";
/// A camera whose rays are not those of a viewer at a pose: no stage aims them.
const PENCIL: &str = "kind = \"pencil\"\neye = [0, 0.8, 5]\ntarget = [0, 0, 0]\nvfov = 40\nslit = 1";
const CURVED: &str = "kind = \"twist\"\neye = [0, 1, 4]\ntarget = [0, 0, 0]\nvfov = 40\ndegree = 3\nangle = 70";
const BALL: &str = "kind = \"reflection\"\neye = { kind = \"pinhole\", eye = [0, 1, 5], target = [0, 0, 0], vfov = 40 }\nmirror = { shape = \"sphere\", radius = 0.6 }";
const FACETS: &str = "kind = \"reflection\"\neye = { kind = \"pinhole\", eye = [0, 1, 5], target = [0, 0, 0], vfov = 40 }\nmirror = { builtin = \"icosphere\", level = 1, scale = 0.6 }\nfacets = \"flat\"\natlas = 32";

fn scene(appearance: &str, camera: &str) -> (Scene, Camera) {
    let scene = load(&format!("image = {{ width = 72, height = 64{appearance}\n{THINGS}\n[camera]\n{camera}")).unwrap();
    let camera = scene.camera().unwrap();
    (scene, camera)
}

/// The passes of a refresh when nothing changed and when the light did, and those of a whole frame.
fn relit(engine: &mut Engine, camera: &str) -> [u32; 3] {
    let run = RunOptions::default();
    let (day, through) = scene(", background = [0.5, 0.7, 0.9] }\n[[light]]\ndirection = [-1, -2, -1]", camera);
    let (night, _) = scene(", background = [0, 0, 0.1] }\n[[light]]\ndirection = [1, 0, -1]", camera);
    let by_day = engine.render(&day, &through, &wanted(), &run).unwrap();
    let by_night = engine.render(&night, &through, &wanted(), &run).unwrap();
    assert!(hits(&by_day.frame) > 300 && words(&by_day.frame) != words(&by_night.frame), "{camera}");

    let mut frames = engine.prepare(&day, &through, &wanted(), &run).unwrap();
    let idle = frames.refresh().unwrap();
    frames.light(&night).unwrap();
    let passes = frames.refresh().unwrap();
    let lit = frames.finish().unwrap();
    assert!(words(&lit.frame) == words(&by_night.frame) && lit.srgb8 == by_night.srgb8, "{camera}");
    assert_eq!(lit.counts.fragments_kept, by_night.counts.fragments_kept);

    // the next frame shows it too, whether the picture was brought up to date before or not
    let mut frames = engine.prepare(&day, &through, &wanted(), &run).unwrap();
    frames.light(&night).unwrap();
    frames.frame().unwrap();
    assert!(words(&frames.finish().unwrap().frame) == words(&by_night.frame), "{camera}");
    [idle, passes, by_day.passes.total()]
}

#[test]
fn what_is_lit_anew_is_shaded_alone() {
    let Some(mut engine) = engine_on(|_| ()) else { return };
    for camera in [SLITS, CURVED] {
        let [idle, passes, whole] = relit(&mut engine, camera);
        // shade, which writes the picture too; the whole has trace, or more, before it
        assert!((idle, passes) == (0, 1) && whole > 1, "{camera}: {idle}, {passes} of {whole} passes");
    }
}

/// Of passes and bands only the last ones are still there: all is done again.
#[test]
fn what_shares_its_lists_is_done_again() {
    let Some(mut engine) = engine_on(|_| ()) else { return };
    for camera in [BALL, FACETS] {
        let [idle, passes, whole] = relit(&mut engine, camera);
        assert!(idle == 0 && passes > 0 && passes <= whole, "{camera}: {idle}, {passes} of {whole} passes");
    }
    // space for the planes of some twenty rows
    let less = |gpu: &mut Gpu| gpu.limits.max_storage_buffer_binding_size = 4 * 72 * 12 * 20;
    let Some(mut engine) = engine_on(less) else { return };
    let [idle, passes, whole] = relit(&mut engine, PENCIL);
    assert!((idle, passes) == (0, whole) && whole > 14, "{idle}, {passes} of {whole} passes");
}

#[test]
fn other_triangles_are_not_lit() {
    let Some(mut engine) = engine_on(|_| ()) else { return };
    let (day, through) = scene("}", SLITS);
    let mut frames = engine.prepare(&day, &through, &wanted(), &RunOptions::default()).unwrap();
    let more = day.with_optics(&scene("}", FACETS).1).into_owned();
    let error = frames.light(&more).unwrap_err();
    assert!(error.exit_code() == 2 && error.to_string().contains("call Engine::prepare again"), "{error}");
}

#[test]
fn other_kinds_of_materials_are_refused() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let (matte, camera) = scene(" }", SLITS);
    let mut shiny = matte.clone();
    Arc::make_mut(&mut shiny.mesh).materials[0].metallic = 1.0;
    let mut brighter = shiny.clone();
    Arc::make_mut(&mut brighter.mesh).materials[0].emissive = [0.5; 3];
    let run = RunOptions::default();
    let mut frames = engine.prepare(&matte, &camera, &wanted(), &run).unwrap();
    let message = frames.light(&shiny).unwrap_err().to_string();
    assert!(message.starts_with("other kinds of materials"), "{message}");
    let mut frames = engine.prepare(&shiny, &camera, &wanted(), &run).unwrap();
    frames.light(&brighter).unwrap();
    let lit = frames.finish().unwrap();
    let anew = engine.render(&brighter, &camera, &wanted(), &run).unwrap();
    assert!(words(&lit.frame) == words(&anew.frame));
}
