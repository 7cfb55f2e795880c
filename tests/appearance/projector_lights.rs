//! Pictures thrown onto surfaces: closed forms, and the reference's colours through cameras of every kind. Nothing to do without an
//! adapter, but for what is read from files.

use crate::common;
use crate::decided::Decisions;
use crate::pictures;
use anamorph::internals::input::Loading;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::combinations::at_once;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::geometry::texture::{Texels, Texture, Wrap};
use anamorph::internals::image::frame::{Channel, Frame, NO_ID};
use anamorph::internals::image::png_bytes;
use anamorph::internals::reference::image::{image, judge};
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::Light;
use anamorph::internals::scene::projector_light::{Mode, ProjectorLight, Throw};
use common::cameras::{MeshShape, mesh_camera};
use common::file::{camera_of, load};
use common::gpu::{engine_on, ids, words};
use common::layered::chain;
use common::{FORWARD, camera};
use glam::{DVec2, DVec3};
use half::f16;
use pictures::{COLOUR, Colours, box_filtered, colours, psnr};
use std::sync::Arc;

const SIZE: (u32, u32) = (80, 60);

/// Things over a floor, near enough to hide each other.
const THINGS: &str = r#"
[[mesh]]
builtin = "plane"
size = 30
translate = [0, -1, 0]
color = [0.5, 0.6, 0.7]
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

const FRONT: &str = "kind = \"orthographic\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nheight = 3";

fn scene_of(meshes: &str) -> Scene {
    load(&format!("image = {{ width = 80, height = 60 }}\n{meshes}\n[camera]\n{FRONT}")).unwrap()
}

/// A picture of so many pixels.
fn picture((width, height): (u32, u32), colour: impl Fn(f64, f64) -> [f64; 3]) -> Arc<Texels> {
    let place = |k: u32, count: u32| (f64::from(k) + 0.5) / f64::from(count);
    let texel = |k: u32| {
        let [r, g, b] = colour(place(k % width, width), place(k / width, height)).map(f16::from_f64);
        [r, g, b, f16::ONE]
    };
    Arc::new(Texels { width, height, rgba: (0..width * height).map(texel).collect() })
}

/// Without detail: the mean over what a pixel covers of it is that of the pixel's middle, so it is the same filtered or not.
fn smooth(size: (u32, u32)) -> Arc<Texels> {
    picture(size, |a, b| [0.2 + 0.6 * a, 0.8 - 0.5 * b, 0.3 + 0.3 * a + 0.3 * b])
}

/// A camera's picture.
fn thrown(keys: &str, texels: &Arc<Texels>, throw: Throw) -> Arc<ProjectorLight> {
    let camera = camera_of("", (texels.width, texels.height), keys).unwrap();
    Arc::new(ProjectorLight::new(Arc::new(camera), Texture::new(texels.clone()), throw).unwrap())
}

fn with(scene: &Scene, projector_lights: Vec<Arc<ProjectorLight>>) -> Scene {
    Scene { projector_lights, ..scene.clone() }
}

fn rendered(engine: &mut Engine, scene: &Scene, camera: &Camera) -> Colours {
    colours(&engine.render(scene, camera, &Wanted::of(COLOUR.to_vec()), &RunOptions::default()).unwrap().frame)
}

const WALL: &str = "[[mesh]]\nbuiltin = \"plane\"\nsize = 40\nrotate = [90, 0, 0]\ncolor = [0.2, 0.2, 0.2]\n";

/// Four metres before the wall z = 0, of which it sees 4 x 3.
const BEFORE: &str = "kind = \"pinhole\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nvfov = 41.112090439166934";

fn show() -> Throw {
    Throw { mode: Mode::Show, ..Throw::default() }
}

/// Of a picture of 8 x 6 pixels, 10 x 10 pixels of the frame show each.
#[test]
fn a_wall_shows_the_picture_where_its_camera_saw_it() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let texels = picture((8, 6), |a, b| [a, b, if ((8.0 * a) as u32).is_multiple_of(2) { 1.0 } else { 0.0 }]);
    let scene = with(&scene_of(WALL), vec![thrown(BEFORE, &texels, show())]);
    let camera = scene.camera().unwrap();
    let exact = Texture { wrap: [Wrap::Clamp; 2], ..Texture::new(texels) };
    let of_reference = colours(&image(&scene, &camera, &COLOUR));
    let seen = rendered(&mut engine, &scene, &camera);
    for (k, (a, b)) in of_reference.iter().zip(&seen).enumerate() {
        let place = [((k % 80) as f64 + 0.5) / 80.0, ((k / 80) as f64 + 0.5) / 60.0];
        let [r, g, b_, _] = exact.at(DVec2::new(place[0], 1.0 - place[1]));
        for (c, truth) in [r, g, b_].into_iter().enumerate() {
            assert!((a[c] - truth).abs() < 1e-6, "{k}: {a:?}, not {truth}");
            // a pixel is a tenth of the picture's wide: level 1/2 log2(1 + 0.1^2 / 3) = 0.0024 of the way to means of 2 x 2
            assert!((b[c] - truth).abs() < 0.0024 + 1e-3, "{k}: {b:?}, not {truth}");
        }
    }
}

/// Beyond the picture, behind a box and on faces turned away surfaces keep their colour.
#[test]
fn what_the_picture_does_not_reach_keeps_its_colour() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let white = picture((64, 48), |_, _| [0.0, 1.0, 0.0]);
    // the box hides a square of the wall from a camera at the side, not from the viewer above it
    let meshes =
        format!("{WALL}[[mesh]]\nbuiltin = \"box\"\nscale = 0.5\ntranslate = [0, 0, 1]\ncolor = [0.2, 0.2, 0.2]\n");
    let side = "kind = \"pinhole\"\neye = [4, 0, 4]\ntarget = [0, 0, 0]\nvfov = 20";
    let through = |occlusion| {
        let paint = Throw { occlusion, ..Throw::default() };
        with(&scene_of(&meshes), vec![thrown(side, &white, paint)])
    };
    let camera = scene_of(&meshes).camera().unwrap();
    for (occlusion, hidden) in [(true, true), (false, false)] {
        let scene = through(occlusion);
        let channels = [Channel::AlbedoR, Channel::AlbedoG, Channel::AlbedoB, Channel::PositionX, Channel::PositionZ];
        let shown = [
            engine.render(&scene, &camera, &Wanted::of(channels.to_vec()), &RunOptions::default()).unwrap().frame,
            image(&scene, &camera, &channels),
        ];
        for frame in shown {
            let [g, x, z] = [Channel::AlbedoG, Channel::PositionX, Channel::PositionZ].map(|c| frame.f32(c).unwrap());
            // the row through the middle: y = -0.025
            let row: Vec<usize> = (30 * 80..31 * 80).collect();
            // rays from (4, 4) through the box's corners (-0.25, 1.25) and (0.25, 0.75) meet the wall at -2.18 and -0.62
            let behind = row.iter().filter(|k| z[**k] < 1e-3 && (-1.9..-0.7).contains(&x[**k]));
            let greens: Vec<f32> = behind.map(|k| g[*k]).collect();
            assert!(greens.len() > 20);
            // at 45 degrees to the wall, and 26 degrees wide: from x = -2.45 to 1.52
            let green = |k: &usize| g[*k] > 0.9;
            let inside = row.iter().filter(|k| z[**k] < 1e-3 && (-1.0..-0.7).contains(&x[**k]));
            assert!(inside.clone().count() > 4 && inside.clone().all(|k| green(k) != hidden), "{greens:?}");
            let beyond = row.iter().filter(|k| z[**k] < 1e-3 && x[**k] > 1.6);
            assert!(beyond.clone().count() > 5 && beyond.clone().all(|k| (g[*k] - 0.2).abs() < 1e-4));
            let before = row.iter().filter(|k| z[**k] < 1e-3 && (0.4..0.9).contains(&x[**k]));
            assert!(before.clone().count() > 5 && before.clone().all(green));
        }
    }
}

/// Two pictures of one colour each: the share of each by its weight.
#[test]
fn pictures_are_blended_by_angle_and_distance() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let [red, green] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|c| picture((32, 32), |_, _| c));
    let ahead = "kind = \"pinhole\"\neye = [0, 0, 3]\ntarget = [0, 0, 0]\nvfov = 90";
    let side = "kind = \"pinhole\"\neye = [5, 0, 5]\ntarget = [0, 0, 0]\nvfov = 90";
    let camera = scene_of(WALL).camera().unwrap();
    for (angle_power, distance_power, opacity) in [(1.0, 1.0, 1.0), (3.0, 0.0, 0.5), (0.0, 2.0, 0.25)] {
        let throw = Throw { angle_power, distance_power, strength: opacity, ..show() };
        let scene = with(&scene_of(WALL), vec![thrown(ahead, &red, throw), thrown(side, &green, throw)]);
        let (seen, exact) = (rendered(&mut engine, &scene, &camera), colours(&image(&scene, &camera, &COLOUR)));
        for k in [30 * 80 + 40, 20 * 80 + 25, 50 * 80 + 60] {
            let p = [((k % 80) as f64 + 0.5) * 0.05 - 2.0, 1.5 - ((k / 80) as f64 + 0.5) * 0.05];
            let weight = |eye: [f64; 3]| {
                let far = ((eye[0] - p[0]).powi(2) + (eye[1] - p[1]).powi(2) + eye[2] * eye[2]).sqrt();
                (eye[2] / far).powf(angle_power) / far.powf(distance_power)
            };
            let (a, b) = (weight([0.0, 0.0, 3.0]), weight([5.0, 0.0, 5.0]));
            let bare: f64 = (1.0 - opacity) * (1.0 - opacity);
            // the wall's own colour in the headlight: 0.2 (0.1 + 0.9)
            let expected =
                [(1.0 - bare) * a / (a + b) + bare * 0.2, (1.0 - bare) * b / (a + b) + bare * 0.2, bare * 0.2];
            for c in 0..3 {
                assert!((exact[k][c] - expected[c]).abs() < 1e-6, "{k}: {:?}, not {expected:?}", exact[k]);
                assert!((seen[k][c] - expected[c]).abs() < 1e-4, "{k}: {:?}, not {expected:?}", seen[k]);
            }
        }
    }
}

/// Light of a picture on a matte wall: 0.2 (0.1 + 0.9 cos strength colour (distance / far)^2).
#[test]
fn a_picture_lights_a_matte_wall_as_a_light_does() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let blue = picture((16, 12), |_, _| [0.0, 0.25, 0.5]);
    for (distance, strength) in [(None, 2.0), (Some(2.0), 3.0)] {
        let throw = Throw { mode: Mode::Light, strength, distance, ..Throw::default() };
        let scene = with(&scene_of(WALL), vec![thrown(BEFORE, &blue, throw)]);
        let camera = scene.camera().unwrap();
        let (seen, exact) = (rendered(&mut engine, &scene, &camera), colours(&image(&scene, &camera, &COLOUR)));
        for k in [30 * 80 + 40, 5 * 80 + 7] {
            let p = [((k % 80) as f64 + 0.5) * 0.05 - 2.0, 1.5 - ((k / 80) as f64 + 0.5) * 0.05];
            let far = (p[0] * p[0] + p[1] * p[1] + 16.0).sqrt();
            let light = strength * 4.0 / far * distance.map_or(1.0, |d: f64| d * d / (far * far));
            for (c, colour) in [0.0, 0.25, 0.5].into_iter().enumerate() {
                let expected = 0.2 * (0.1 + 0.9 * light * colour);
                assert!((exact[k][c] - expected).abs() < 1e-6, "{:?}, not {expected}", exact[k]);
                assert!((seen[k][c] - expected).abs() < 1e-4, "{:?}, not {expected}", seen[k]);
            }
        }
    }
}

/// Cameras that look at the things.
fn viewers() -> Vec<(&'static str, Camera)> {
    let of = |text: &str| camera_of("", SIZE, text).unwrap();
    let look = "eye = [0.3, 0.9, 4]\ntarget = [0, -0.3, 0]";
    vec![
        ("pinhole", of(&format!("kind = \"pinhole\"\n{look}\nvfov = 40"))),
        ("orthographic", of(&format!("kind = \"orthographic\"\n{look}\nheight = 3"))),
        (
            "cross-slit",
            of(&format!(
                "kind = \"cross_slit\"\n{look}\nheight = 3\nslits = [{{ distance = 3, angle = 0 }}, {{ distance = 4.5, angle = 90 }}]"
            )),
        ),
        ("pushbroom", of("kind = \"pushbroom\"\nstart = [-2, 3, 1]\nend = [2, 3, 1]\nlook = [0, -1, -0.3]\nvfov = 60")),
        ("panorama", of("kind = \"panorama\"\ncenter = [0, 0, 0]\nradius = 4\nheight = 3\nelevation = 1")),
        ("mesh of 16 x 16", camera(mesh_camera(1, 16, 16, MeshShape::default()), SIZE, FORWARD)),
        ("chain", chain(3, 3, (4, 3), MeshShape::default(), SIZE)),
        ("fisheye", of(&format!("kind = \"fisheye\"\n{look}\nfov = 120\nframe = \"full\""))),
        ("sphere", of(&format!("kind = \"sphere\"\n{look}\nlon = [-60, 60]\nlat = [-45, 45]"))),
        ("cylinder", of(&format!("kind = \"cylinder\"\n{look}\nfov = 120"))),
        ("twist", of(&format!("kind = \"twist\"\n{look}\nvfov = 40\nangle = 30"))),
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

/// Keys of cameras whose pictures are thrown onto the things.
fn throwers() -> Vec<String> {
    let look = "eye = [1.5, 2, 3]\ntarget = [0, -0.4, 0]";
    vec![
        format!("kind = \"pinhole\"\n{look}\nvfov = 50"),
        format!("kind = \"orthographic\"\n{look}\nheight = 3"),
        format!(
            "kind = \"cross_slit\"\n{look}\nheight = 3\nslits = [{{ distance = 3, angle = 0 }}, {{ distance = 4.5, angle = 90 }}]"
        ),
        "kind = \"pushbroom\"\nstart = [-2, 3, 1]\nend = [2, 3, 1]\nlook = [0, -1, -0.3]\nvfov = 60".into(),
        format!("kind = \"fisheye\"\n{look}\nfov = 120\nframe = \"full\""),
        format!("kind = \"fisheye\"\n{look}\nfov = 150"),
        format!("kind = \"sphere\"\n{look}"),
        format!("kind = \"cylinder\"\n{look}\nfov = 200\nvfov = 80"),
        "kind = \"panorama\"\ncenter = [0, 0, 0]\nradius = 4\nheight = 3\nelevation = 1".into(),
        "kind = \"panorama\"\ncenter = [0, 0, 0]\nradius = 4\nheight = 3\nelevation = 1\npieces = 8".into(),
        format!("kind = \"twist\"\n{look}\nvfov = 40\nangle = 30"),
        "kind = \"pinhole\"\neye = [300, 400, 600]\ntarget = [0, -0.4, 0]\nvfov = 0.25".into(),
    ]
}

/// A pixel's colour may differ by what the picture does within the tolerance of its place, 1/64 px: 1e-4, and where it fades out over 6 px a
/// 1/384 of itself and of the surface's colour, which differ by no more than 0.6; by the rounding of half floats, 5e-4; and by what a gloss
/// makes of the rounding of its normal (`gloss.rs`).
const ROUNDING: f64 = 2e-3;

/// Of safe hits, the share of those at which rounding cannot change what a picture does either: in each frame, and in all. Borders, outlines and
/// shadows take the others, and pixels that cover a picture's border. Measured: 0.60 and more, and 0.79.
const SURE: f64 = 0.5;
const SURE_IN_ALL: f64 = 0.75;

/// Of so many safe hits one is looked at, to count those.
const EACH: usize = 16;

/// A frame beside the reference's.
struct Compared {
    /// Of some of the safe hits, how many there are, and at how many rounding cannot change what a picture does.
    hits: usize,
    sure: usize,
    seen: Colours,
}

const GEOMETRY: [Channel; 7] = [
    Channel::TriangleId,
    Channel::PositionX,
    Channel::PositionY,
    Channel::PositionZ,
    Channel::NormalX,
    Channel::NormalY,
    Channel::NormalZ,
];

/// Pixels whose triangle rounding cannot change.
fn safe(scene: &Scene, camera: &Camera) -> Vec<bool> {
    judge(scene, camera, &Frame { width: camera.width, height: camera.height, planes: Vec::new() }).safe
}

/// Asserts that every pixel whose triangle and pictures rounding cannot change is the reference's.
fn compared(name: &str, engine: &mut Engine, (scene, camera): (&Scene, &Camera), safe: &[bool]) -> Compared {
    let channels = [&COLOUR[..], &GEOMETRY].concat();
    let exact = image(scene, camera, &channels);
    let seen = engine.render(scene, camera, &Wanted::of(channels), &RunOptions::default()).unwrap().frame;
    let ids = [&exact, &seen].map(ids);
    let (a, b) = (colours(&exact), colours(&seen));
    let safe: Vec<usize> = (0..a.len()).filter(|&k| safe[k]).collect();
    assert!(safe.iter().all(|&k| ids[0][k] == ids[1][k]), "{name}: another triangle");
    let is_off = |k: usize| (0..3).any(|c| (a[k][c] - b[k][c]).abs() > ROUNDING * (1.0 + a[k][c]));
    let off: Vec<usize> = safe.iter().copied().filter(|&k| is_off(k)).collect();
    let decisions = Decisions::of(scene, camera);
    let wrong: Vec<usize> = off.iter().copied().filter(|&k| decisions.are_sure(&exact, k)).collect();
    let hits: Vec<usize> = safe.into_iter().filter(|&k| ids[0][k] != NO_ID).step_by(EACH).collect();
    let sure = hits.iter().filter(|&&k| decisions.are_sure(&exact, k)).count();
    println!(
        "{name}: {} pixels otherwise, {} of them sure, as are {sure} of {} hits",
        off.len(),
        wrong.len(),
        hits.len()
    );
    let first = wrong.first().map(|&k| (k, a[k], b[k]));
    assert!(wrong.is_empty(), "{name}: {} pixels differ, the first {first:?}", wrong.len());
    assert!(sure as f64 >= SURE * hits.len() as f64 && hits.len() > 100, "{name}: {sure} of {} are sure", hits.len());
    Compared { hits: hits.len(), sure, seen: b }
}

#[test]
#[ignore = "slow: make test-all"]
fn every_camera_shows_pictures_of_every_other_one_as_the_reference_does() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let bare = Scene { lights: vec![Light::distant(DVec3::new(-0.6, -1.0, -0.4))], ..scene_of(THINGS) };
    let texels = smooth((96, 64));
    let modes = [Mode::Paint, Mode::Show, Mode::Light];
    let viewers = viewers();
    let without: Vec<Colours> = viewers.iter().map(|(_, camera)| rendered(&mut engine, &bare, camera)).collect();
    let safe: Vec<Vec<bool>> = viewers.iter().map(|(_, camera)| safe(&bare, camera)).collect();
    let mut all = [0; 2];
    for (n, keys) in throwers().iter().enumerate() {
        let throw = Throw { mode: modes[n % 3], strength: 0.9, feather: 6.0, ..Throw::default() };
        let scene = with(&bare, vec![thrown(keys, &texels, throw)]);
        for (k, (name, camera)) in viewers.iter().enumerate() {
            // every third pair, each of both in all modes, and all pictures through a pinhole
            if k > 0 && (n + k) % 3 != 0 {
                continue;
            }
            let title = format!("{name}, picture of {}", keys.lines().next().unwrap());
            let Compared { hits, sure, seen } = compared(&title, &mut engine, (&scene, camera), &safe[k]);
            let is_other = |(a, b): &(&[f64; 3], &[f64; 3])| (0..3).any(|c| (a[c] - b[c]).abs() > 0.02);
            let changed = seen.iter().zip(&without[k]).filter(is_other).count();
            assert!(changed > 60, "{name}, {keys}: the picture changes {changed} pixels");
            all = [all[0] + hits, all[1] + sure];
        }
    }
    println!("{} of {} hits are sure", all[1], all[0]);
    assert!(all[1] as f64 > SURE_IN_ALL * all[0] as f64, "{} of {} hits are sure", all[1], all[0]);
}

#[test]
fn several_pictures_of_all_modes_and_a_light_are_the_reference_s() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let texels = smooth((96, 64));
    let lights = vec![Light { casts_shadows: true, ..Light::distant(DVec3::new(-0.6, -1.0, -0.4)) }];
    let bare = Scene { lights, ..scene_of(THINGS) };
    let keys = throwers();
    let of = |n: usize, throw: Throw| thrown(&keys[n], &texels, throw);
    let paint = Throw { feather: 8.0, strength: 0.8, angle_power: 2.0, ..Throw::default() };
    let light = Throw { mode: Mode::Light, strength: 1.5, distance: Some(4.0), ..Throw::default() };
    let all = vec![
        of(0, paint),
        of(6, Throw { feather: 4.0, strength: 0.6, ..show() }),
        of(4, light),
        of(1, Throw { occlusion: false, ..paint }),
    ];
    let scene = with(&bare, all);
    for (name, camera) in viewers() {
        compared(name, &mut engine, (&scene, &camera), &safe(&bare, &camera));
    }
}

/// A picture that has more pixels than the frame is filtered: it looks as the mean of many samples.
#[test]
fn minified_pictures_are_filtered() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let checks = picture((512, 384), |a, b| [((64.0 * a) as u32 + (48.0 * b) as u32) as f64 % 2.0; 3]);
    let scene = with(&scene_of(WALL), vec![thrown(BEFORE, &checks, show())]);
    let keys = "kind = \"pinhole\"\neye = [2, 1, 9]\ntarget = [0, 0, 0]\nvfov = 22";
    let camera = camera_of("", SIZE, keys).unwrap();
    let truth = box_filtered(&scene, &camera, 32);
    let (one, point) = (rendered(&mut engine, &scene, &camera), colours(&image(&scene, &camera, &COLOUR)));
    let (filtered, unfiltered) = (psnr(&truth, &one), psnr(&truth, &point));
    println!("filtered {filtered:.1} dB, unfiltered {unfiltered:.1} dB");
    assert!(filtered > unfiltered + 6.0, "filtered {filtered:.1} dB, unfiltered {unfiltered:.1} dB");
}

#[test]
#[ignore = "slow: make test-all"]
fn samples_of_a_pixel_see_pictures_too() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let scene = with(&scene_of(THINGS), vec![thrown(&throwers()[0], &smooth((96, 64)), Throw::default())]);
    for (name, camera) in [&viewers()[0], &viewers()[7]] {
        assert!(at_once(&scene, camera, 8));
        let wanted = Wanted { samples: 8, ..Wanted::of(COLOUR.to_vec()) };
        let eight = colours(&engine.render(&scene, camera, &wanted, &RunOptions::default()).unwrap().frame);
        let one = rendered(&mut engine, &scene, camera);
        let truth = box_filtered(&scene, camera, 32);
        let (smoothed, sharp) = (psnr(&truth, &eight), psnr(&truth, &one));
        println!("{name}: 8 samples {smoothed:.1} dB, one {sharp:.1} dB");
        assert!(smoothed > sharp + 3.0, "{name}: 8 samples {smoothed:.1} dB, one {sharp:.1} dB");
    }
}

/// A new picture in the same frames is the picture of frames made anew.
#[test]
fn pictures_change_from_frame_to_frame() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let (keys, run) = (&throwers()[6], RunOptions::default());
    let bare = scene_of(THINGS);
    let of = |texels: &Arc<Texels>| with(&bare, vec![thrown(keys, texels, show())]);
    let (first, second) = (of(&smooth((96, 64))), of(&picture((96, 64), |a, b| [b, a, 0.5])));
    let (_, camera) = viewers().swap_remove(0);
    let wanted = Wanted::of(COLOUR.to_vec());
    let mut frames = engine.prepare(&first, &camera, &wanted, &run).unwrap();
    frames.refresh().unwrap();
    frames.light(&second).unwrap();
    frames.refresh().unwrap();
    let relit = frames.finish().unwrap().frame;
    let anew = engine.render(&second, &camera, &wanted, &run).unwrap().frame;
    let before = engine.render(&first, &camera, &wanted, &run).unwrap().frame;
    assert!(words(&relit) == words(&anew) && words(&relit) != words(&before));
}

/// Things that move while the frame is taken wear the picture where they are at each pixel's time.
#[test]
fn what_moves_while_the_frame_is_taken_is_the_reference_s() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let moving = "[[mesh]]\nbuiltin = \"box\"\ntranslate = [{ frame = 0, value = [-1, 0, 0] }, { frame = 1, value = [1, 0, 0] }]\n";
    let text = format!(
        "image = {{ width = 80, height = 60, frame_rate = 30 }}\n[[mesh]]\nbuiltin = \"plane\"\nsize = 30\ntranslate = [0, -1, 0]\n{moving}\n\
         [camera]\nkind = \"pinhole\"\neye = [0.3, 0.9, 4]\ntarget = [0, -0.3, 0]\nvfov = 40\nline_time = 5e-4"
    );
    let scene = load(&text).unwrap();
    assert!(scene.steps.is_some());
    let camera = scene.camera().unwrap();
    for n in [0, 4] {
        let scene = with(&scene, vec![thrown(&throwers()[n], &smooth((96, 64)), Throw { feather: 6.0, ..show() })]);
        compared(&format!("picture {n}"), &mut engine, (&scene, &camera), &safe(&scene, &camera));
    }
}

/// A scene file with pictures that have other names from frame to frame.
#[test]
fn scene_files_name_pictures_by_their_frame() {
    let folder = tempfile::tempdir().unwrap();
    for (frame, value) in [(3, 40u8), (4, 250)] {
        let path = folder.path().join(format!("take-{frame:04}.png"));
        let png = png_bytes(2, 2, &[value; 12]).unwrap();
        std::fs::write(path, png).unwrap();
    }
    let text = format!(
        "image = {{ width = 8, height = 6 }}\n{WALL}\n[[projector_light]]\nimage = \"take-{{frame:04}}.png\"\nmode = \"light\"\nstrength = 2\nfeather = 0.25\nocclusion = false\ndistance = 3\n[projector_light.camera]\n{BEFORE}\n[camera]\n{FRONT}"
    );
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    let red = |frame: f64| {
        let scene = Scene::load(&path, &[], frame, &Loading::default()).unwrap();
        let [light] = &scene.projector_lights[..] else { panic!("{} lights", scene.projector_lights.len()) };
        let throw = Throw {
            mode: Mode::Light,
            strength: 2.0,
            feather: 0.25,
            distance: Some(3.0),
            occlusion: false,
            ..Throw::default()
        };
        assert_eq!(light.throw, throw);
        light.picture.at(DVec2::splat(0.5))[0]
    };
    assert!(red(3.0) < 0.03 && red(4.0) > 0.9);
    let missing = Scene::load(&path, &[], 5.0, &Loading::default()).unwrap_err();
    assert_eq!(missing.exit_code(), 2);
    let text = missing.to_string();
    assert!(text.contains("projector_light.0: ") && text.contains("take-0005.png") && !text.contains('\n'), "{text}");
}

#[test]
fn wrong_keys_and_values_are_refused_in_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let png = png_bytes(2, 2, &[9; 12]).unwrap();
    std::fs::write(folder.path().join("a.png"), png).unwrap();
    let path = folder.path().join("scene.toml");
    let refused = |entry: &str| {
        let text = format!("image = {{ width = 8, height = 6 }}\n{WALL}\n{entry}\n[camera]\n{FRONT}");
        std::fs::write(&path, text).unwrap();
        let error = Scene::load(&path, &[], 0.0, &Loading::default()).expect_err(entry);
        assert_eq!(error.exit_code(), 2, "{entry}");
        let text = error.to_string();
        assert!(!text.contains('\n'), "{text}");
        text
    };
    let of = |keys: &str| {
        format!(
            "[[projector_light]]\nimage = \"a.png\"\ncamera = {{ kind = \"pinhole\", eye = [0, 0, 4], target = [0, 0, 0], vfov = 40 }}\n{keys}"
        )
    };
    let by = |camera: &str| format!("[[projector_light]]\nimage = \"a.png\"\n[projector_light.camera]\n{camera}");
    let eye = "{ kind = \"pinhole\", eye = [0, 1, 5], target = [0, 0, 0], vfov = 40 }";
    for (entry, expected) in [
        ("[[projector_light]]\ncamera = { kind = \"pinhole\" }".into(), "projector_light.0: image is missing"),
        ("[[projector_light]]\nimage = \"a.png\"".into(), "projector_light.0: camera is missing"),
        (of("colour = 1"), "unknown key \"colour\" in projector_light.0"),
        (of("mode = \"burn\""), "\"burn\" is no mode; use \"paint\", \"show\", \"light\""),
        (of("opacity = 1.5"), "projector_light.0.opacity: 1.5 is out of range; use 0 to 1"),
        (of("strength = 2"), "projector_light.0.strength: mode \"paint\" does not use it"),
        (of("mode = \"light\"\nopacity = 1"), "projector_light.0.opacity: mode \"light\" does not use it"),
        (of("mode = \"light\"\nstrength = -1"), "projector_light.0.strength: -1 is out of range"),
        (of("mode = \"light\"\ndistance = 0"), "projector_light.0.distance"),
        (of("feather = -2"), "projector_light.0.feather: -2 is out of range"),
        (of("angle_power = 65"), "projector_light.0.angle_power: 65 is out of range"),
        (of("occlusion = 1"), "projector_light.0.occlusion"),
        (of("").replace("a.png", "b.png"), "b.png"),
        (by("kind = \"pin\""), "projector_light.0.camera.kind: unknown camera kind"),
        (
            by("kind = \"twist\"\ndegree = 3\nangle = 30"),
            "projector_light.0: camera: twist has curved rays; a picture is thrown along straight rays that start somewhere",
        ),
        (
            by(&format!("kind = \"reflection\"\neye = {eye}\nmirror = {{ shape = \"sphere\", radius = 0.6 }}")),
            "projector_light.0: camera: reflection reflects or refracts its rays",
        ),
        (
            by("kind = \"pinhole\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nvfov = 40\nt_range = [\"-inf\", 9]"),
            "projector_light.0: camera: pinhole has rays without a start: its t_range begins at -inf",
        ),
    ] {
        let text = refused(&entry);
        assert!(text.contains(expected), "{text:?} does not say {expected:?}");
    }
    let many = of("").repeat(65);
    assert!(refused(&many).contains("projector_light: 65 projector lights; there may be 64"));
}
