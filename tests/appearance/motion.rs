//! Image-space motion between two frames through every kind of rays: where it says that a place is, the next frame's ray passes by it.
//! And closed forms of what moves while a frame is taken.

use crate::common;
use anamorph::internals::input::Loading;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::RunOptions;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::image::frame::{Channel, NO_ID};
use anamorph::internals::reference::image::image;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::motion::{NEEDED, motion};
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera};
use common::file::camera_of;
use common::gpu::{Without, engine};
use common::layered::chain;
use common::rng::Rng;
use common::{FORWARD, camera, scene, soup};
use glam::{DMat3, DVec2, DVec3};
use std::sync::Arc;

const SIZE: (u32, u32) = (48, 36);

/// A camera now, and the next frame's, which has moved.
fn cameras() -> Vec<(&'static str, [Camera; 2])> {
    let of = |text: &str| camera_of("", SIZE, text).unwrap();
    let view = |x: f64| format!("eye = [{x}, 0.3, 4]\ntarget = [0, 0, 0]");
    let both = |make: &dyn Fn(f64) -> Camera| [0.2, 0.25].map(make);
    let kinds = glc_of_each_class();
    let still =
        |kind: &anamorph::internals::camera::spec::CameraKind| [0, 1].map(|_| camera(kind.clone(), SIZE, FORWARD));
    vec![
        ("cross-slit", still(&kinds[3].1)),
        ("bilinear", still(&kinds[6].1)),
        ("pinhole", both(&|x| of(&format!("kind = \"pinhole\"\n{}\nvfov = 40", view(x))))),
        ("mesh of 16 x 16", still(&mesh_camera(1, 16, 16, MeshShape::default()))),
        ("fisheye", both(&|x| of(&format!("kind = \"fisheye\"\n{}\nfov = 120\nframe = \"full\"", view(x))))),
        (
            "curved projector",
            both(&|x| of(&format!("kind = \"twist\"\n{}\nvfov = 40\ndegree = 3\nangle = 30", view(x)))),
        ),
        ("chain", [0, 1].map(|_| chain(3, 3, (4, 3), MeshShape::default(), SIZE))),
    ]
}

/// Where a camera's ray or curve of a place passes a point by, relative to how far it is there.
fn miss(camera: &Camera, place: [f64; 2], point: DVec3) -> f64 {
    let pixel = place.map(|v| v.floor().max(0.0) as u32);
    let (i, j) = (pixel[0].min(SIZE.0 - 1), pixel[1].min(SIZE.1 - 1));
    let moved = camera.with_sample_offset(place[0] - f64::from(i) - 0.5, place[1] - f64::from(j) - 0.5);
    let line = |p: DVec3, d: DVec3| (point - p).cross(d).length() / (d.length() * (point - p).length().max(1.0));
    (0..moved.layers.len())
        .filter_map(|layer| match moved.is_curved() {
            true => moved.curve(layer, i, j).map(|(_, c)| {
                let near = (0..=4096).map(|k| f64::from(k) / 4096.0);
                let t = near.min_by(|a, b| (c.at(*a) - point).length().total_cmp(&(c.at(*b) - point).length()));
                let t = t.unwrap();
                line(c.at(t), c.tangent(t))
            }),
            false => moved.pixel(layer, i, j).map(|(_, b)| b.ray(0.0, 0.0)).map(|r| line(r.origin, r.direction)),
        })
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn rays_of_the_next_frame_pass_where_motion_says() {
    let mut mesh = soup(&mut Rng(3), 60, 0.6);
    mesh.positions.iter_mut().for_each(|p| *p *= 0.8);
    let now = scene(mesh);
    let mut next = now.clone();
    let turn = DMat3::from_rotation_y(0.03);
    Arc::make_mut(&mut next.mesh).positions.iter_mut().for_each(|p| *p = turn * *p + DVec3::new(0.01, -0.02, 0.03));
    for (name, [first, second]) in cameras() {
        let frame = image(&now, &first, &NEEDED);
        let [dx, dy] = motion((&now, &first), (&next, &second), &frame).unwrap();
        let ids = frame.u32(Channel::TriangleId).unwrap();
        let weights = [Channel::BaryU, Channel::BaryV].map(|c| frame.f32(c).unwrap());
        let (mut seen, mut lost, mut most, mut longest) = (0, 0, 0.0f64, 0.0f64);
        for k in 0..ids.len() {
            if ids[k] == NO_ID {
                assert_eq!((dx[k], dy[k]), (0.0, 0.0));
                continue;
            }
            if dx[k].is_nan() {
                lost += 1;
                continue;
            }
            seen += 1;
            // a few of all: tables are made anew for each
            if seen % 37 != 0 {
                continue;
            }
            let corners = next.mesh.triangles[ids[k] as usize].map(|c| next.mesh.positions[c as usize]);
            let [u, v] = weights.map(|w| f64::from(w[k]));
            let point = corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]);
            let (x, y) = ((k % SIZE.0 as usize) as f64 + 0.5, (k / SIZE.0 as usize) as f64 + 0.5);
            most = most.max(miss(&second, [x + f64::from(dx[k]), y + f64::from(dy[k])], point));
            longest = longest.max(f64::from(dx[k].hypot(dy[k])));
        }
        println!(
            "{name}: {seen} places, {lost} leave the image, {longest:.1} px at most, passed by {most:.1e} of the way"
        );
        // motion and weights are f32: 2^-24 of some 50 px, of rays that spread by some 0.1 a pixel; of curves their chords' bend, which
        // 4096 steps leave of it
        assert!(most < 1e-6 && seen > 100 && lost < seen, "{name}: {most}");
        assert!(longest > 0.1 && longest < 20.0, "{name}: {longest} px");
    }
}

#[test]
fn what_stands_still_has_no_motion() {
    let now = scene(soup(&mut Rng(3), 60, 0.6));
    for (name, [first, _]) in cameras() {
        let frame = image(&now, &first, &NEEDED);
        let [dx, dy] = motion((&now, &first), (&now, &first), &frame).unwrap();
        let most = dx.iter().chain(&dy).map(|v| v.abs()).fold(0.0, f32::max);
        // of curves the weights are f32's
        assert!(most < 1e-4, "{name}: {most} px");
    }
}

#[test]
fn motion_needs_the_same_triangles_and_no_mirror() {
    let now = scene(soup(&mut Rng(3), 6, 0.6));
    let (_, [plain, _]) = cameras().swap_remove(0);
    let mirror = camera_of(
        "",
        SIZE,
        "kind = \"reflection\"\neye = { kind = \"pinhole\", eye = [0.2, 0.4, 4], target = [0, 0, 0], vfov = 40 }\nmirror = { shape = \"sphere\", radius = 0.6 }",
    )
    .unwrap();
    let frame = image(&now, &plain, &NEEDED);
    let more = scene(soup(&mut Rng(3), 7, 0.6));
    let of = |a: (&Scene, &Camera), b: (&Scene, &Camera)| motion(a, b, &frame).unwrap_err().to_string();
    assert!(of((&now, &plain), (&more, &plain)).starts_with("motion is of triangles that are the same"));
    assert!(of((&now, &plain), (&now, &mirror)).starts_with("motion is not computed through mirrors"));
    let bare = image(&now, &plain, &[Channel::T]);
    assert!(motion((&now, &plain), (&now, &plain), &bare).is_err());
}

/// What has these values at the frames -1 to 2, and changes at constant speed between two of them.
#[derive(Debug, Clone, Copy)]
struct Keys([DVec3; 4]);

impl Keys {
    const STILL: Keys = Keys([DVec3::ZERO; 4]);

    fn at(&self, time: f64) -> DVec3 {
        let k = time.floor().clamp(-1.0, 1.0);
        let before = (k + 1.0) as usize;
        self.0[before].lerp(self.0[before + 1], time - k)
    }

    fn text(&self, key: &str, more: DVec3) -> String {
        let one = |k: usize| format!("{{ frame = {}, value = {:?} }}", k as i32 - 1, (self.0[k] + more).to_array());
        format!("{key} = [{}]", [0, 1, 2, 3].map(one).join(", "))
    }
}

/// A square across the view of a camera that looks along -z, all of what is seen, which grows and moves; the camera, which moves too; and
/// when rows are exposed.
struct Known {
    image: &'static str,
    /// Where the middle of the square is.
    translate: Keys,
    /// The square's size, in each component.
    scale: Keys,
    /// The camera is 5 units in front of this, and looks there.
    eye: Keys,
    /// The camera's other keys.
    camera: String,
    /// When a row is exposed, or the middle of that.
    time: fn(u32) -> f64,
    is_pinhole: bool,
}

/// A picture 3.6 units high of the plane at z = 0.
const PIXEL: f64 = 0.1;

impl Known {
    /// The scene and its camera at a frame.
    fn at_frame(&self, frame: f64) -> (Scene, Camera) {
        let size = |k: usize| format!("{{ frame = {}, value = {} }}", k as i32 - 1, self.scale.0[k].x);
        let text = format!(
            "image = {{ width = {}, height = {}, {} }}\n[[mesh]]\nbuiltin = 'plane'\nsize = 9\nrotate = [90, 0, 0]\n{}\n\
             scale = [{}]\n[camera]\n{}\n{}\n{}\n",
            SIZE.0,
            SIZE.1,
            self.image,
            self.translate.text("translate", DVec3::ZERO),
            [0, 1, 2, 3].map(size).join(", "),
            self.eye.text("eye", 5.0 * DVec3::Z),
            self.eye.text("target", DVec3::ZERO),
            self.camera
        );
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, text).unwrap();
        let scene = Scene::load(&path, &[], frame, &Loading::default()).unwrap();
        let camera = scene.camera().unwrap();
        (scene, camera)
    }

    /// World units a pixel at a height.
    fn pixel(&self, z: f64) -> f64 {
        if self.is_pinhole { PIXEL * (5.0 - z) / 5.0 } else { PIXEL }
    }

    /// Where the place of the square that pixel (i, j) shows is one frame later; by the definitions.
    fn later(&self, i: u32, j: u32) -> DVec3 {
        let time = (self.time)(j);
        let [now, then] = [time, time + 1.0].map(|t| self.translate.at(t));
        let [small, large] = [time, time + 1.0].map(|t| self.scale.at(t).x);
        let middle = DVec2::new(f64::from(SIZE.0), f64::from(SIZE.1)) / 2.0;
        let off = (DVec2::new(f64::from(i), f64::from(j)) + 0.5 - middle) * DVec2::new(1.0, -1.0);
        let place = (self.pixel(now.z) * off).extend(now.z) + self.eye.at(time);
        then + large / small * (place - now)
    }

    /// The images of a place of the next frame: each row sees it along the rays of its own time. And whether it lies in the image, but
    /// between two rows that both miss it. `None` where it is so near a border that rounding decides.
    fn images(&self, place: DVec3) -> Option<(Vec<DVec2>, bool)> {
        let [width, height] = [SIZE.0, SIZE.1].map(f64::from);
        let of_row = |j: u32| {
            let own = (place - self.eye.at((self.time)(j) + 1.0)).truncate() / self.pixel(place.z);
            DVec2::new(width / 2.0 + own.x, height / 2.0 - own.y)
        };
        let all: Vec<DVec2> = (0..SIZE.1).map(of_row).collect();
        let is_near = |x: f64, border: f64| (x - border).abs() < 1e-6;
        let decided = |(image, j): (&DVec2, u32)| {
            let is_at_side = is_near(image.x, 0.0) || is_near(image.x, width);
            !is_at_side && !is_near(image.y, j.into()) && !is_near(image.y, f64::from(j) + 1.0)
        };
        if !all.iter().zip(0..).all(decided) {
            return None;
        }
        let is_inside = |x: f64| (0.0..width).contains(&x);
        let below = |j: usize| all[j].y - j as f64;
        let missed = |j: &usize| is_inside(all[*j].x) && below(*j) > 1.0 && below(*j + 1) < 0.0;
        let is_missed = (0..all.len() - 1).any(|j| missed(&j));
        let seen = |j: &usize| is_inside(all[*j].x) && (0.0..1.0).contains(&below(*j));
        Some(((0..all.len()).filter(seen).map(|j| all[j]).collect(), is_missed))
    }

    /// Asserts that motion goes to the nearest image, and is NaN where there is none, in the frame of the reference and, with an adapter,
    /// of the engine. How many places have two images, and how many are missed between rows.
    fn assert_motion(&self, name: &str) -> [usize; 2] {
        let [now, next] = [0.0, 1.0].map(|frame| self.at_frame(frame));
        let wanted = Wanted::of(NEEDED.to_vec());
        let rendered = engine(&now.1, Without::Nothing)
            .map(|mut engine| engine.render(&now.0, &now.1, &wanted, &RunOptions::default()).unwrap().frame);
        let mut counts = [0; 2];
        for frame in [image(&now.0, &now.1, &NEEDED)].into_iter().chain(rendered) {
            let [dx, dy] = motion((&now.0, &now.1), (&next.0, &next.1), &frame).unwrap();
            let (mut compared, mut found, mut most) = (0, 0, 0.0f64);
            counts = [0; 2];
            for (i, j) in (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j))) {
                let k = (j * SIZE.0 + i) as usize;
                let Some((images, is_missed)) = self.images(self.later(i, j)) else { continue };
                compared += 1;
                counts[0] += usize::from(images.len() > 1);
                counts[1] += usize::from(is_missed);
                let own = DVec2::new(f64::from(i), f64::from(j)) + 0.5;
                let steps = images.into_iter().map(|image| image - own);
                let nearest = steps.min_by(|a, b| a.length().total_cmp(&b.length()));
                let seen = DVec2::new(dx[k].into(), dy[k].into());
                let Some(expected) = nearest else {
                    assert!(dx[k].is_nan() && dy[k].is_nan(), "{name} {i},{j}: {seen}");
                    continue;
                };
                found += 1;
                most = most.max((seen - expected).length());
                assert!((seen - expected).abs().max_element() <= OFF, "{name} {i},{j}: {seen}, {expected}");
            }
            println!(
                "{name}: {found} of {compared} places are seen again, {counts:?} twice and between rows, off by {most:.1e} px"
            );
            assert!(compared + 60 > dx.len() && found > 900, "{name}: {found} of {compared}");
        }
        counts
    }
}

/// Of motion of less than 30 px a frame: its places at two times, each rounded to 2^-24 of a step, which is a frame at most; and as much
/// for f32.
const OFF: f64 = 3.0 * 30.0 / 16_777_216.0;

const LINE_TIME: f64 = 1.0 / 36.0;

/// Slower before the frame than in it, and faster in the next one, also towards the viewer.
const SWERVING: Keys =
    Keys([DVec3::new(-0.1, 0.2, 0.1), DVec3::ZERO, DVec3::new(0.613, -0.287, 0.2), DVec3::new(1.7, -0.41, 0.5)]);

const GROWING: Keys = Keys([DVec3::splat(0.9), DVec3::splat(1.0), DVec3::splat(1.21), DVec3::splat(1.25)]);

/// A square that swerves before a camera which stands still.
fn swerving(kind: &str, image: &'static str, more: &str, time: fn(u32) -> f64) -> Known {
    // 3.6 units at a distance of 5
    let vfov = 2.0 * (0.36f64).atan().to_degrees();
    let is_pinhole = kind == "pinhole";
    let view = if is_pinhole { format!("vfov = {vfov}") } else { "height = 3.6".to_owned() };
    let camera = format!("kind = '{kind}'\n{view}\n{more}");
    Known { image, translate: SWERVING, scale: GROWING, eye: Keys::STILL, camera, time, is_pinhole }
}

/// Row j is exposed j lines after the first one: what it shows has moved when it comes to its own time of the next frame.
#[test]
fn a_rolling_shutter_has_motion_from_each_row_s_own_time() {
    for kind in ["orthographic", "pinhole"] {
        let down = swerving(kind, "", &format!("line_time = {LINE_TIME}"), |j| LINE_TIME * f64::from(j));
        down.assert_motion(&format!("{kind}, down"));
        let more = format!("line_time = {LINE_TIME}\nline_order = 'up'");
        let up = swerving(kind, "", &more, |j| LINE_TIME * f64::from(SIZE.1 - 1 - j));
        up.assert_motion(&format!("{kind}, up"));
    }
}

/// With the shutter open before and after a time at which the speed changes, motion is from the middle of one exposure to that of the next.
#[test]
fn an_open_shutter_has_motion_from_its_middle() {
    for kind in ["orthographic", "pinhole"] {
        swerving(kind, "shutter = 0.7", "", |_| 0.0).assert_motion(&format!("{kind}, open"));
        let more = format!("line_time = {LINE_TIME}");
        let rolling = swerving(kind, "shutter = 0.7", &more, |j| LINE_TIME * f64::from(j));
        rolling.assert_motion(&format!("{kind}, open, row by row"));
    }
}

/// A camera that moves while rows are read sees each row from elsewhere. Where it moves against the order of rows they overlap, so that
/// places have two images; where it moves along with it, places between two rows have none.
#[test]
fn motion_through_a_camera_that_moves_while_rows_are_read() {
    let flight = |y: f64| Keys([DVec3::ZERO, DVec3::ZERO, DVec3::new(0.3, 0.5 * y, 0.0), DVec3::new(0.9, y, 0.0)]);
    for kind in ["orthographic", "pinhole"] {
        let still = || swerving(kind, "", &format!("line_time = {LINE_TIME}"), |j| LINE_TIME * f64::from(j));
        let [twice, missed] = Known { eye: flight(0.8), ..still() }.assert_motion(&format!("{kind} that moves up"));
        assert!(twice > 100 && missed == 0, "{kind}: {twice}, {missed}");
        let [twice, missed] = Known { eye: flight(-0.8), ..still() }.assert_motion(&format!("{kind} that moves down"));
        assert!(twice == 0 && missed > 50, "{kind}: {twice}, {missed}");
    }
    // and that is elsewhere in the next frame
    Known { eye: flight(0.8), ..swerving("pinhole", "", "", |_| 0.0) }.assert_motion("pinhole between two frames");
}
