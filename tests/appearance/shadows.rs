//! Light of every colour and place, and what is in its way, compared with the reference through every kind of rays. Nothing to do without
//! an adapter.

use crate::common;
use crate::pictures;
use crate::textures::masked_shapes;

use anamorph::internals::camera::Camera;
use anamorph::internals::camera::exposure::{Exposure, LineOrder, Lines, Readout, Sample};
use anamorph::internals::engine::combinations::at_once;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::geometry::place::merge;
use anamorph::internals::geometry::time_steps::{TimeStep, TimeSteps};
use anamorph::internals::image::frame::Channel;
use anamorph::internals::reference::image::image;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::{AmbientOcclusion, Light, Source};
use common::cameras::{MeshShape, mesh_camera};
use common::file::{camera_of, load};
use common::gpu::{engine_on, limit_bindings};
use common::layered::chain;
use common::{FORWARD, camera};
use glam::{DMat3, DVec3};
use pictures::{COLOUR, Colours, box_filtered, colours, psnr};
use std::sync::Arc;

const SIZE: (u32, u32) = (80, 60);

/// Things over a floor, near enough to hide each other.
const THINGS: &str = r#"
[[mesh]]
builtin = "plane"
size = 30
translate = [0, -1, 0]
[[mesh]]
builtin = "icosphere"
level = 3
scale = 0.6
translate = [-0.7, 0, 0]
[[mesh]]
builtin = "box"
rotate = [10, 30, 0]
translate = [0.8, -0.3, 0.2]
roughness = 0.5
[[mesh]]
builtin = "teapot"
level = 2
scale = 0.3
translate = [0.1, -1, 1.1]
"#;

fn scene(lights: Vec<Light>, ambient_occlusion: Option<AmbientOcclusion>) -> Scene {
    let camera = "[camera]\nkind = \"orthographic\"\neye = [0, 0, 2]\ntarget = [0, 0, 0]\nheight = 2";
    let scene = load(&format!("image = {{ width = 4, height = 4 }}\n{THINGS}\n{camera}")).unwrap();
    Scene { lights, ambient_occlusion, ..scene }
}

fn sun() -> Light {
    Light { casts_shadows: true, colour: [1.0, 0.9, 0.7], ..Light::distant(DVec3::new(-0.6, -1.0, -0.4)) }
}

fn lamp() -> Light {
    let source = Source::Point { position: DVec3::new(0.3, 1.2, 1.5), distance: 1.5 };
    Light { source, colour: [0.3, 0.5, 0.9], casts_shadows: true }
}

fn families() -> Vec<(&'static str, Camera)> {
    let of = |text: &str| camera_of("", SIZE, text).unwrap();
    let look = "eye = [0.3, 0.9, 4]\ntarget = [0, -0.3, 0]";
    vec![
        ("pinhole", of(&format!("kind = \"pinhole\"\n{look}\nvfov = 40"))),
        (
            "cross-slit",
            of(&format!(
                "kind = \"cross_slit\"\n{look}\nheight = 3\nslits = [{{ distance = 3, angle = 0 }}, {{ distance = 4.5, angle = 90 }}]"
            )),
        ),
        ("mesh of 16 x 16", camera(mesh_camera(1, 16, 16, MeshShape::default()), SIZE, FORWARD)),
        ("chain", chain(3, 3, (4, 3), MeshShape::default(), SIZE)),
        ("fisheye", of(&format!("kind = \"fisheye\"\n{look}\nfov = 120\nframe = \"full\""))),
        ("curved projector", of(&format!("kind = \"twist\"\n{look}\nvfov = 40\ndegree = 3\nangle = 30"))),
        (
            "mirror",
            of(
                "kind = \"reflection\"\ndepth = 1\neye = { kind = \"pinhole\", eye = [0.3, 0.9, 4], target = [0, 0, 0], vfov = 40 }\nmirror = { shape = \"sphere\", center = [0, 0.9, 0], radius = 0.6 }",
            ),
        ),
        (
            "facets",
            of(
                "kind = \"reflection\"\neye = { kind = \"pinhole\", eye = [0.3, 0.9, 4], target = [0, 0, 0], vfov = 40 }\nmirror = { builtin = \"icosphere\", level = 2, scale = 0.6, translate = [0, 0.9, 0] }\nfacets = \"normals\"",
            ),
        ),
    ]
}

fn rendered(engine: &mut Engine, scene: &Scene, camera: &Camera) -> Colours {
    colours(&engine.render(scene, camera, &Wanted::of(COLOUR.to_vec()), &RunOptions::default()).unwrap().frame)
}

/// Of pixels that see one triangle in both, how many are lit otherwise by more than rounding; and of all.
fn lit_otherwise(engine: &mut Engine, scene: &Scene, camera: &Camera) -> (usize, usize) {
    lit_otherwise_by(ROUNDING, engine, scene, camera)
}

fn lit_otherwise_by(rounding: f64, engine: &mut Engine, scene: &Scene, camera: &Camera) -> (usize, usize) {
    let channels = [&COLOUR[..], &[Channel::TriangleId]].concat();
    let exact = image(scene, camera, &channels);
    let seen = engine.render(scene, camera, &Wanted::of(channels), &RunOptions::default()).unwrap().frame;
    let ids = [&exact, &seen].map(|f| f.u32(Channel::TriangleId).unwrap());
    let (a, b) = (colours(&exact), colours(&seen));
    let same: Vec<usize> = (0..a.len()).filter(|&k| ids[0][k] == ids[1][k]).collect();
    let off = |k: usize| (0..3).map(|c| (a[k][c] - b[k][c]).abs() / (1.0 + a[k][c])).fold(0.0, f64::max);
    (same.iter().filter(|&&k| off(k) > rounding).count(), same.len())
}

/// See `gloss.rs`: of surfaces of roughness 0.5 at the brightest.
const ROUNDING: f64 = 1e-4;

/// Kernels keep colours times opacity in f16: half of its last bit.
const ROUNDING_OF_IMAGES: f64 = 1.0 / 2048.0;

/// At the borders of shadows f32 may see light where there is none: some 4e-6 of a unit wide, of pixels 0.05 wide. If all 4800 pixels held
/// one of both lights that were 0.8 of them, and 5 or more once in a thousand times.
const OFF_MAX: usize = 4;

#[test]
fn lights_and_their_shadows_are_the_reference_s() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let lights = vec![sun(), lamp()];
    let hidden = scene(lights.clone(), None);
    let shining = scene(lights.iter().map(|l| Light { casts_shadows: false, ..*l }).collect(), None);
    for (name, camera) in families() {
        let (a, b) = (rendered(&mut engine, &hidden, &camera), rendered(&mut engine, &shining, &camera));
        let dark = a.iter().zip(&b).filter(|(a, b)| a[0] < b[0] - 0.01).count();
        assert!(dark > 200, "{name}: {dark} pixels in shadows");
        for (what, scene) in [("shadows", &hidden), ("none", &shining)] {
            let (off, all) = lit_otherwise(&mut engine, scene, &camera);
            println!("{name}, {what}: {off} of {all} pixels otherwise, {dark} dark");
            assert!(off <= OFF_MAX && all > 2000, "{name}, {what}: {off} of {all} are lit otherwise");
        }
    }
}

/// Borders of holes are longer than those of the things above: if all pixels held four of both lights, 3.2 would be lit otherwise, and 11 or
/// more once in a thousand times.
const OFF_MAX_OF_HOLES: usize = 10;

#[test]
fn light_passes_through_holes() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let mut masked = scene(vec![sun(), lamp()], Some(AmbientOcclusion { rays: 2, reach: 0.8 }));
    masked.mesh = merge(vec![(**masked.mesh).clone(), (**masked_shapes().mesh).clone()]).unwrap().into();
    let mut blended = masked.clone();
    let mesh = Arc::make_mut(&mut blended.mesh);
    mesh.materials.iter_mut().filter(|m| m.texture.is_some()).for_each(|m| m.blend = Some(0.7));
    let mut moving = masked.clone();
    let at = |x: f64| TimeStep {
        positions: masked.mesh.positions.iter().map(|p| *p + DVec3::X * x * (1.0 + p.y)).collect(),
        normals: masked.mesh.normals.clone(),
    };
    moving.steps = TimeSteps::new(vec![0.0, 1.0], vec![at(-0.1), at(0.1)]).map(Arc::new);
    let lines = Lines { first: 0.0, line_time: 1.0 / f64::from(SIZE.1), order: LineOrder::Down, count: SIZE.1 };
    moving.exposure = Exposure { readout: Readout::Lines(lines), shutter: 0.0, is_even: false };
    for (k, (name, camera)) in families().into_iter().enumerate() {
        let sample = camera.of_sample([0.1, 0.2].into(), Sample { number: 2, count: 3 }).unwrap();
        let (scene, camera) = [(&masked, &camera), (&blended, &sample), (&moving, &camera)][k % 3];
        let mut solid = scene.clone();
        let materials = &mut Arc::make_mut(&mut solid.mesh).materials;
        materials.iter_mut().for_each(|m| (m.texture, m.blend) = (None, None));
        let [holes, none] = [scene, &solid].map(|scene| rendered(&mut engine, scene, camera));
        let differ = holes.iter().zip(&none).filter(|(a, b)| (a[0] - b[0]).abs() > 0.01).count();
        let (off, all) = lit_otherwise_by(ROUNDING_OF_IMAGES, &mut engine, scene, camera);
        println!("{name}: {off} of {all} pixels otherwise, {differ} by holes");
        assert!(off <= OFF_MAX_OF_HOLES && all > 1500 && differ > 150, "{name}: {off} of {all}, {differ} by holes");
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn what_is_near_hides_light_from_around_as_in_the_reference() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let of = |rays: u32| scene(Vec::new(), Some(AmbientOcclusion { rays, reach: 0.8 }));
    let open = scene(Vec::new(), None);
    for (name, camera) in families() {
        let near = of(16);
        let (a, b) = (rendered(&mut engine, &near, &camera), rendered(&mut engine, &open, &camera));
        let dark = a.iter().zip(&b).filter(|(a, b)| a[0] < 0.95 * b[0]).count();
        let (off, all) = lit_otherwise(&mut engine, &near, &camera);
        println!("{name}: {off} of {all} pixels otherwise, {dark} dark");
        // 16 ways a pixel have 8 times the borders of two lights
        assert!(dark > 100 && off <= 8 * OFF_MAX, "{name}: {off} of {all}, {dark} dark");
    }
    // few directions are near to many
    let (name, camera) = families().swap_remove(1);
    let truth = colours(&image(&of(1024), &camera, &COLOUR));
    let db = [8, 32, 128].map(|rays| psnr(&truth, &rendered(&mut engine, &of(rays), &camera)));
    println!("{name}: {db:.1?} dB with 8, 32 and 128 directions against 1024");
    assert!(db[0] > 25.0 && db[1] > db[0] + 6.0 && db[2] > db[1] + 6.0, "{db:?}");
}

/// About the anchor, which is where the middle ray meets the scene's box, places are small numbers, but not those of the way there.
#[test]
fn nothing_hides_itself_from_light_about_the_anchor() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let text = "kind = \"occlusion\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nvfov = 3\nfar = 7.5\nend = 16\ndistortion = [0, 0.14]";
    let camera = camera_of("", SIZE, text).unwrap();
    let text = "image = { width = 4, height = 4 }\n[[mesh]]\nbuiltin = \"icosphere\"\nlevel = 5\n[camera]\nkind = \"orthographic\"\neye = [0, 0, 2]\ntarget = [0, 0, 0]\nheight = 2";
    let scene = Scene { lights: vec![sun(), lamp()], ..load(text).unwrap() };
    let (off, all) = lit_otherwise(&mut engine, &scene, &camera);
    assert!(off <= OFF_MAX && all > 4000, "{off} of {all} are lit otherwise");
}

/// By powers of two, so that all numbers but those of the hierarchy stay what they are.
#[test]
fn scenes_of_any_size_have_their_shadows() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let mut of = |exponent: i32| {
        let size = 2.0_f64.powi(exponent);
        let place = |p: [f64; 3]| format!("{:?}", p.map(|v| v * size));
        let (eye, target) = (place([0.3, 0.9, 4.0]), place([0.0, -0.3, 0.0]));
        let text = format!("kind = \"pinhole\"\neye = {eye}\ntarget = {target}\nvfov = 40");
        let source = Source::Point { position: size * DVec3::new(0.3, 1.2, 1.5), distance: 1.5 * size };
        let near = AmbientOcclusion { rays: 4, reach: 0.5 * size };
        let mut scene = scene(vec![sun(), Light { source, ..lamp() }], Some(near));
        Arc::make_mut(&mut scene.mesh).positions.iter_mut().for_each(|p| *p *= size);
        rendered(&mut engine, &scene, &camera_of("", SIZE, &text).unwrap())
    };
    let plain = of(0);
    for exponent in [-38, 43, 95] {
        let seen = of(exponent);
        let off = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).any(|c| (a[c] - b[c]).abs() > ROUNDING * (1.0 + a[c]));
        let off = plain.iter().zip(&seen).filter(|(a, b)| off((a, b))).count();
        println!("2^{exponent}: {off} pixels otherwise");
        assert!(off <= OFF_MAX, "2^{exponent}: {off} pixels otherwise");
    }
}

#[test]
fn nothing_hides_the_light_of_no_triangles() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let near = Some(AmbientOcclusion { rays: 4, reach: 0.5 });
    let empty = Scene { mesh: Default::default(), objects: Vec::new(), ..scene(vec![sun()], near) };
    let (_, camera) = families().swap_remove(0);
    assert!(rendered(&mut engine, &empty, &camera).iter().all(|c| *c == [0.0; 3]));
    // but those of a mirror
    let text = "kind = \"reflection\"\neye = { kind = \"pinhole\", eye = [0, 0, 4], target = [0, 0, 0], vfov = 40 }\nmirror = { builtin = \"icosphere\", level = 1 }";
    assert!(rendered(&mut engine, &empty, &camera_of("", SIZE, text).unwrap()).iter().all(|c| *c == [0.0; 3]));
}

/// Shadows are found at the samples' own places.
#[test]
#[ignore = "slow: make test-all"]
fn samples_are_lit_where_they_are() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let scene = scene(vec![sun()], None);
    let mut kinds = 0;
    for (name, camera) in families().into_iter().filter(|(_, camera)| at_once(&scene, camera, 16)) {
        let exact = box_filtered(&scene, &camera, 16);
        let db = [1, 16].map(|samples| {
            let wanted = Wanted { samples, ..Wanted::of(COLOUR.to_vec()) };
            psnr(&exact, &colours(&engine.render(&scene, &camera, &wanted, &RunOptions::default()).unwrap().frame))
        });
        println!("{name}: {db:.1?} dB");
        // a shadow's border is no edge: one look a triangle and pixel
        assert!(db[1] > db[0], "{name}: {db:?}");
        kinds += 1;
    }
    assert!(kinds >= 4);
}

/// Under a ceiling every place of a floor is as dark as every other, also where its two triangles share a pixel.
#[test]
fn no_line_shows_where_triangles_meet() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let meshes =
        "[[mesh]]\nbuiltin = \"plane\"\nsize = 4\n[[mesh]]\nbuiltin = \"plane\"\nsize = 20\ntranslate = [0, 1, 0]";
    let eye = "[camera]\nkind = \"pinhole\"\neye = [0.2, 0.5, 0.1]\ntarget = [0, 0, 0]\nvfov = 60";
    let empty = load(&format!("image = {{ width = 40, height = 30 }}\n{meshes}\n{eye}")).unwrap();
    let camera = camera_of("", (40, 30), eye.split_once('\n').unwrap().1).unwrap();
    let lights = vec![Light::distant(DVec3::NEG_Y)];
    let [open, hidden] = [None, Some(AmbientOcclusion { rays: 5, reach: 3.0 })].map(|ambient_occlusion| Scene {
        lights: lights.clone(),
        ambient_occlusion,
        ..empty.clone()
    });
    let mut seen = |scene: &Scene, samples: u32| {
        let wanted = Wanted { samples, ..Wanted::of(COLOUR.to_vec()) };
        colours(&engine.render(scene, &camera, &wanted, &RunOptions::default()).unwrap().frame)
    };
    let (bright, dark, of_16) = (seen(&open, 1)[0], seen(&hidden, 1)[0], seen(&hidden, 16));
    let off = of_16.iter().flat_map(|c| (0..3).map(|k| (c[k] - dark[k]).abs())).fold(0.0, f64::max);
    assert!(dark[0] < 0.97 * bright[0] && off < ROUNDING, "{bright:?} {dark:?} {off}");
}

/// Chunks of a scene lie in one hierarchy; and what moves takes its shadow along.
#[test]
fn all_chunks_hide_light_and_what_moves_too() {
    let Some(mut whole) = engine_on(|_| {}) else { return };
    let mut parts = engine_on(|gpu| limit_bindings(gpu, 1 << 18)).unwrap();
    let scene = scene(vec![sun(), lamp()], Some(AmbientOcclusion { rays: 4, reach: 0.5 }));
    let (_, camera) = families().swap_remove(0);
    let [a, b] = [&mut whole, &mut parts].map(|engine| rendered(engine, &scene, &camera));
    assert!(a == b);

    let wanted = Wanted::of(COLOUR.to_vec());
    let mut frames = whole.prepare(&scene, &camera, &wanted, &RunOptions::default()).unwrap();
    let darker = Scene { lights: vec![lamp(), Light { colour: [0.2; 3], ..sun() }], ..scene.clone() };
    frames.light(&darker).unwrap();
    let lit = colours(&frames.finish().unwrap().frame);
    assert!(lit == rendered(&mut whole, &darker, &camera));

    // lit anew before and after it moves, which is by 0.01 a frame about the upright through its middle
    let moving = RunOptions { moving: true, ..RunOptions::default() };
    let mut turned = darker.clone();
    let (lo, hi) = turned.bounds().unwrap();
    let (middle, turn) = ((lo + hi) / 2.0, DMat3::from_rotation_y(0.3));
    Arc::make_mut(&mut turned.mesh).positions.iter_mut().for_each(|p| *p = middle + turn * (*p - middle));
    let anew = rendered(&mut whole, &turned, &camera);
    for first in [true, false] {
        let mut frames = whole.prepare(&scene, &camera, &wanted, &moving).unwrap();
        if first {
            frames.light(&darker).unwrap();
        }
        for _ in 0..30 {
            frames.frame().unwrap();
        }
        if !first {
            frames.light(&darker).unwrap();
        }
        let (seen, was) = (colours(&frames.finish().unwrap().frame), &lit);
        let differ = |a: &Colours, b: &Colours| {
            let off = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).any(|c| (a[c] - b[c]).abs() > ROUNDING * (1.0 + a[c]));
            a.iter().zip(b).filter(|(a, b)| off((a, b))).count()
        };
        let (off, moved) = (differ(&seen, &anew), differ(&seen, was));
        println!("{off} pixels otherwise than of a scene turned so far, {moved} than before");
        assert!(off <= OFF_MAX && moved > 1000, "{off} and {moved}");
    }
}

#[test]
fn a_scene_says_how_it_is_lit() {
    let camera = "[camera]\nkind = \"orthographic\"\neye = [0, 0, 2]\ntarget = [0, 0, 0]\nheight = 2";
    let load = |text: &str| load(&format!("image = {{ width = 4, height = 4 }}\n{text}\n{camera}"));
    let scene = load("[ambient_occlusion]\ndistance = 2\n[[light]]\nposition = [1, 2, 3]\ndistance = 4\ncolor = [1, 2, 0]\nshadows = true\n[[light]]\ndirection = [0, -2, 0]").unwrap();
    let source = Source::Point { position: DVec3::new(1.0, 2.0, 3.0), distance: 4.0 };
    assert_eq!(scene.lights[0], Light { source, colour: [1.0, 2.0, 0.0], casts_shadows: true });
    assert!(scene.lights[1].is_plain() && scene.lights[1] == Light::distant(DVec3::NEG_Y));
    assert_eq!(scene.ambient_occlusion, Some(AmbientOcclusion { rays: 32, reach: 2.0 }));
    for (text, expected) in [
        ("[[light]]\ndirection = [0, 0, 0]", "light.0.direction: the direction is zero"),
        ("[[light]]\ndirection = [1, 0, 0]\nposition = [1, 0, 0]", "light.0.position: a light has either"),
        ("[[light]]\ndirection = [1, 0, 0]\ndistance = 2", "light.0.distance: light from far away"),
        ("[[light]]\nposition = [1, 0, 0]\ndistance = 0", "light.0.distance: 0 is out of range"),
        ("[[light]]\nposition = [1, 0, 0]\ncolor = [-1, 0, 0]", "light.0.color: there is no less light than none"),
        ("[[light]]\ncolor = [1, 0, 0]", "light.0: direction is missing"),
        ("[ambient_occlusion]\nrays = 3", "ambient_occlusion: distance is missing"),
        ("[ambient_occlusion]\ndistance = 1\nrays = 0", "ambient_occlusion.rays"),
        ("[ambient_occlusion]\ndistance = 1\nrays = 129", "ambient_occlusion.rays"),
    ] {
        let message = load(text).expect_err(text).to_string();
        assert!(message.contains(expected) && !message.contains('\n'), "{message}");
    }
}
