//! What moves while a frame is taken: closed forms, random scenes, and what does not go together.

use crate::common;

use anamorph::internals::camera::exposure::Sample;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::plan::samples::sample_offsets;
use anamorph::internals::image::frame::{Channel, Frame, NO_ID};
use anamorph::internals::input::Result;
use anamorph::internals::reference::image::image;
use anamorph::internals::scene::Scene;
use common::any::any_moving;
use common::file::load;
use common::gpu::{check, ids, render, render_with};
use common::rng::Rng;
use glam::DVec2;

/// Four units high; a pixel is 1/15 wide.
pub(crate) const SIZE: (u32, u32) = (80, 60);

fn pixel_width() -> f64 {
    4.0 / f64::from(SIZE.1)
}

/// The place of a pixel's centre, or of a place beside it, in px, on the plane of the picture.
pub(crate) fn place(i: u32, j: u32, beside: DVec2) -> DVec2 {
    let x = f64::from(i) + 0.5 + beside.x - f64::from(SIZE.0) / 2.0;
    let y = f64::from(SIZE.1) / 2.0 - (f64::from(j) + 0.5 + beside.y);
    DVec2::new(x, y) * pixel_width()
}

/// A scene with a flat box, seen from in front by parallel rays.
pub(crate) fn scene_of(image: &str, mesh: &str, camera: &str) -> Scene {
    scene_with(image, &format!("builtin = \"box\"\n{mesh}"), camera).unwrap()
}

/// The same with any mesh.
pub(crate) fn scene_with(image: &str, mesh: &str, camera: &str) -> Result<Scene> {
    load(&format!(
        "image = {{ width = {}, height = {}, {image} }}\n[[mesh]]\n{mesh}\n\
         [camera]\nkind = \"orthographic\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nheight = 4\n{camera}\n",
        SIZE.0, SIZE.1
    ))
}

/// From the left to the right in a frame, three units.
const SLIDING: &str = "scale = [0.8, 9, 0.1]\n\
    translate = [{ frame = 0, value = [-1.5, 0, 0] }, { frame = 1, value = [1.5, 0, 0] }]";

/// The frames of the reference and, with an adapter, of the engine.
fn frames(scene: &Scene) -> Vec<Frame> {
    let camera = scene.camera().unwrap();
    let rendered = render(scene, &camera);
    [image(scene, &camera, &[Channel::TriangleId])].into_iter().chain(rendered).collect()
}

/// Asserts that a pixel shows something where the distance inside is above 0, except within a tolerance of it.
pub(crate) fn assert_shown(scene: &Scene, tolerance: f64, inside: impl Fn(u32, u32) -> f64) {
    for frame in frames(scene) {
        let mut tested = [0, 0];
        for (i, j) in (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j))) {
            let distance = inside(i, j);
            if distance.abs() > tolerance {
                let is_seen = ids(&frame)[(j * SIZE.0 + i) as usize] != NO_ID;
                assert_eq!(is_seen, distance > 0.0, "pixel {i},{j} lies {distance} inside");
                tested[usize::from(is_seen)] += 1;
            }
        }
        assert!(tested.iter().all(|n| *n > 200), "{tested:?}");
    }
}

/// A time is rounded to 2^-24 of a step: as far as the bar moves in one frame in such a part of it.
pub(crate) const ROUNDED: f64 = 3.0 / 16_777_216.0;

/// Read downwards, a bar that slides to the right leans to the right below: by 3/60 units a row, 3/4 px.
#[test]
fn a_bar_is_sheared_by_a_rolling_shutter() {
    let line_time = 1.0 / f64::from(SIZE.1);
    for (order, row_time) in [("down", &(|j: u32| f64::from(j)) as &dyn Fn(u32) -> f64), ("up", &|j| f64::from(59 - j))]
    {
        let scene = scene_of("", SLIDING, &format!("line_time = {line_time}\nline_order = '{order}'"));
        let middle = |j| -1.5 + 3.0 * row_time(j) * line_time;
        assert_shown(&scene, 2.0 * ROUNDED, |i, j| 0.4 - (place(i, j, DVec2::ZERO).x - middle(j)).abs());
    }
    // and read to the right, a bar is wider: its edges are met where x = -1.5 + 3 t +- 0.4 and x = -8/3 + 16/3 t
    let scene = scene_of("", SLIDING, &format!("line_time = {}\nline_order = 'right'", 1.0 / f64::from(SIZE.0)));
    let middle = |i: u32| -1.5 + 3.0 * f64::from(i) / f64::from(SIZE.0);
    assert_shown(&scene, 2.0 * ROUNDED, |i, j| 0.4 - (place(i, j, DVec2::ZERO).x - middle(i)).abs());
}

/// Half a turn while the picture is read. Corners move straight in steps of at most a degree, and so up to r (1 - cos(1/2 degree)) inside
/// of their circle; and as far along it the blade turns by less than a tenth of that.
#[test]
fn a_propeller_is_bent_by_a_rolling_shutter() {
    let blade =
        "scale = [3.2, 0.5, 0.1]\nrotate = [{ frame = 0, value = [0, 0, 0] }, { frame = 1, value = [0, 0, 180] }]";
    let scene = scene_of("motion_steps = 180", blade, &format!("line_time = {}", 1.0 / f64::from(SIZE.1)));
    // two before the key at 0, half a row, and 179 after it
    assert_eq!(scene.steps.as_ref().unwrap().count(), 182);
    let sagitta = DVec2::new(1.6, 0.25).length() * (1.0 - 0.5f64.to_radians().cos());
    assert_shown(&scene, 1.1 * sagitta, |i, j| {
        let angle = -std::f64::consts::PI * f64::from(j) / f64::from(SIZE.1);
        let p = DVec2::from_angle(angle).rotate(place(i, j, DVec2::ZERO));
        (1.6 - p.x.abs()).min(0.25 - p.y.abs())
    });
}

/// A mesh that turns is put into steps of at most 5 degrees without being asked.
#[test]
fn what_turns_is_divided_into_steps() {
    let count = |image: &str, keys: &str| {
        let scene = scene_of(&format!("shutter = 1, {image}"), &format!("rotate = {keys}"), "");
        scene.steps.map_or(1, |steps| steps.count())
    };
    let turn = "[{ frame = -1, value = [0, 0, 0] }, { frame = 1, value = [0, 90, 0] }]";
    assert_eq!(count("", turn), 10);
    assert_eq!(count("motion_steps = 3", turn), 4);
    // two ways, as the shutter is open from -1/2 to 1/2
    let there_and_back = "[{ frame = -1, value = 0 }, { frame = 0, value = 20 }, { frame = 1, value = 0 }]";
    let scene =
        scene_of("shutter = 1", &format!("scale = {}", there_and_back.replace("20", "2").replace("0 }", "1 }")), "");
    assert_eq!(scene.steps.unwrap().count(), 3);
    assert_eq!(count("", "[0, 30, 0]"), 1);
}

/// The share of the exposure in which a pixel sees the bar, from samples in equal parts of it: each of its two ends is off by less than a part.
#[test]
fn samples_blur_what_moves() {
    let (samples, shutter) = (16, 0.8);
    let scene = scene_of(&format!("shutter = {shutter}"), SLIDING, "");
    let camera = scene.camera().unwrap();
    let mut sum = vec![0.0; (SIZE.0 * SIZE.1) as usize];
    for (number, offset) in (0..samples).zip(sample_offsets(samples)) {
        let camera = camera.of_sample(offset.into(), Sample { number, count: samples }).unwrap();
        let frame = render(&scene, &camera).unwrap_or_else(|| image(&scene, &camera, &[Channel::TriangleId]));
        sum.iter_mut().zip(ids(&frame)).for_each(|(sum, id)| *sum += f64::from(u8::from(*id != NO_ID)));
    }
    // from frame -0.4, when it still stands at -1.5, to 0.4, when it is at -0.3
    let share = |x: f64| {
        let position = |time: f64| -1.5 + 3.0 * time.max(0.0);
        let times = (0..100_000).map(|k| shutter * ((f64::from(k) + 0.5) / 100_000.0 - 0.5));
        times.filter(|t| (x - position(*t)).abs() < 0.4).count() as f64 / 100_000.0
    };
    for i in 0..SIZE.0 {
        let x = |beside: f64| place(i, 0, DVec2::new(beside, 0.0)).x;
        let all = [-0.5, -0.25, 0.0, 0.25, 0.5].map(|beside| share(x(beside)));
        let (least, most) = (all.iter().copied().fold(1.0, f64::min), all.iter().copied().fold(0.0, f64::max));
        for j in 0..SIZE.1 {
            let seen = sum[(j * SIZE.0 + i) as usize] / f64::from(samples);
            let part = 2.0 / f64::from(samples);
            assert!((least - part..=most + part).contains(&seen), "pixel {i},{j}: {seen} of {least} to {most}");
        }
    }
}

/// Each vertex of random scenes goes somewhere, and comes from somewhere.
#[test]
#[ignore = "slow: make test-all"]
fn random_scenes_that_move_have_the_reference_s_triangles() {
    for number in 0..80 {
        let (scene, camera) = any_moving(&mut Rng(9_000 + number), (32, 32));
        if check(&format!("scene {number}, {}", camera.kind), &scene, &camera).is_none() {
            return;
        }
    }
}

/// Colours and normals too, with shadows and smooth normals, by all arithmetic.
#[test]
#[ignore = "slow: make test-all"]
fn what_moves_is_lit_where_it_is() {
    let text = "image = { width = 64, height = 48, shutter = 0.5 }\n[[light]]\ndirection = [-1, -2, -1]\nshadows = true\n\
        [[mesh]]\nbuiltin = \"plane\"\nsize = 8\n\
        [[mesh]]\nbuiltin = \"teapot\"\nrotate = [{ frame = -1, value = [0, 0, 0] }, { frame = 1, value = [40, 90, 0] }]\n\
        translate = [{ frame = -1, value = [-1, 0.5, 0] }, { frame = 1, value = [1, 1, 0.5] }]\n\
        [camera]\nkind = \"pinhole\"\neye = [3, 5, 8]\ntarget = [0, 1, 0]\nvfov = 45\nline_time = 0.01\n";
    let scene = load(text).unwrap();
    let camera = scene.camera().unwrap();
    let Some((frame, judged, _)) = check("teapot", &scene, &camera) else { return };
    for channel in [Channel::R, Channel::G, Channel::B] {
        let (seen, truth) = (frame.f32(channel).unwrap(), judged.truth.f32(channel).unwrap());
        let is_safe = |k: &usize| judged.safe[*k];
        let wrong = (0..seen.len()).filter(is_safe).filter(|k| (seen[*k] - truth[*k]).abs() > 2e-3).count();
        // a shadow's edge is no edge of a triangle
        assert!(wrong <= seen.len() / 200, "{wrong} of {} pixels", seen.len());
    }
    let without = [common::gpu::Without::F64, common::gpu::Without::Int64Atomics];
    for less in without {
        let Some(rendered) = render_with(&scene, &camera, less, &Default::default()) else { return };
        common::gpu::assert_right("teapot without", &scene, &camera, &rendered.frame);
    }
}

#[test]
fn nothing_of_it_is_in_a_frame_that_stands_still() {
    // keyframes alone, without a time to move in
    let scene = scene_of("", SLIDING, "");
    assert!(scene.steps.is_none() && scene.exposure.is_instant());
    // and time without anything that moves
    let scene = scene_of("shutter = 1", "scale = 2", "line_time = 0.01");
    assert!(scene.steps.is_none());
    let wanted = Wanted::of(vec![Channel::R]);
    assert!(wanted.samples == 1 && scene.moments(&scene.camera().unwrap()).is_none());
}

#[test]
fn wrong_times_are_refused_in_one_line() {
    let refused = |image: &str, mesh: &str, camera: &str| {
        let text = format!(
            "image = {{ width = 8, height = 6, {image} }}\n[[mesh]]\nbuiltin = \"box\"\n{mesh}\n\
             [camera]\nkind = \"pinhole\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nvfov = 40\n{camera}\n"
        );
        let error = load(&text).expect_err(&text);
        assert_eq!(error.exit_code(), 2);
        let text = error.to_string();
        assert!(!text.contains('\n'), "{text}");
        text
    };
    let whirl = "rotate = [{ frame = -1, value = [0, 0, 0] }, { frame = 1, value = [0, 99999, 0] }]";
    for (image, mesh, camera, says) in [
        ("shutter = -1", "", "", "image.shutter: -1 is out of range; use 0 to 1000"),
        ("frame_rate = 0", "", "", "image.frame_rate: 0 is out of range"),
        ("motion_steps = 256", "", "", "image.motion_steps: expected a whole number from 1 to 255"),
        ("", "", "line_order = 'up'", "camera.line_order: lines have an order only with a line_time"),
        ("", "", "line_time = 1\nline_order = 'in'", "\"in\" is no order of lines; known: \"down\", \"up\""),
        ("", "", "line_time = 1\ntimes = 'a.npy'", "camera.times: line_time says it already"),
        ("", "", "times = 'a.npy'", "a.npy"),
        ("motion_steps = 255", whirl, "line_time = 1e12", "over the limit of 255; shorten shutter"),
        ("shutter = 1", whirl, "", "steps from keyframe to keyframe, over the limit of 255; shorten shutter"),
    ] {
        let text = refused(image, mesh, camera);
        assert!(text.contains(says), "{text}");
    }
    let camera = "[camera]\nkind = \"raymap\"\norigins = \"o.npy\"\ndirections = \"d.npy\"\nline_time = 1\n";
    assert!(load(camera).is_err());
}
