//! Image-space motion between two frames through every kind of rays: where it says that a place is, the next frame's ray passes by it.

use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::image::frame::{Channel, NO_ID};
use anamorph::internals::reference::image::image;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::motion::{NEEDED, motion};
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera};
use common::file::camera_of;
use common::layered::chain;
use common::rng::Rng;
use common::{FORWARD, camera, scene, soup};
use glam::{DMat3, DVec3};
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
