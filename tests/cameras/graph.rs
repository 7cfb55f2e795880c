//! What the constructors of Popescu et al. promise: views undistorted where they land, no seam anywhere, the plain view
//! where it should be.

use crate::common;

mod bottom_up;
mod top_down;

use anamorph::internals::camera::{Camera, Ray, Rays};
use anamorph::internals::image::frame::{Channel, Frame, NO_ID};
use anamorph::internals::reference::image;
use common::continuity::{POINT_ROUNDING, assert_joined, assert_seamless, assert_smooth, borders};
use common::file::{camera_of, refusal, scene_of};
use glam::{DVec2, DVec3};

const SIZE: (u32, u32) = (80, 60);

/// Three boxes on a floor.
const BOXES: &str = r#"
[[mesh]]
builtin = "plane"
scale = 2
[[mesh]]
builtin = "box"
translate = [-6, 1, -4]
[[mesh]]
builtin = "box"
translate = [0, 1, 0]
[[mesh]]
builtin = "box"
translate = [6, 1, -4]
"#;

/// The two rays are one line, run through the same way, from the same eye.
fn assert_same(of: &Camera, layer: usize, (i, j): (u32, u32), plain: &Ray) {
    let (_, bundle) = of.pixel(layer, i, j).unwrap_or_else(|| panic!("no ray at {i},{j}"));
    let ray = bundle.ray(0.0, 0.0);
    let (d, e) = (ray.direction.normalize(), plain.direction.normalize());
    let size = 1.0 + ray.direction.length() + plain.origin.length();
    assert!((ray.origin - plain.origin).length() <= POINT_ROUNDING * size, "{i},{j}: {} {}", ray.origin, plain.origin);
    assert!((d - e).length() <= POINT_ROUNDING, "{i},{j}: {d} is not {e}");
}

/// Every leg of the pixel lies on the plain ray, one after the other.
fn assert_straight(of: &Camera, (i, j): (u32, u32), plain: &Ray) {
    let e = plain.direction.normalize();
    let mut last = 0.0;
    for layer in 0..of.layers.len() {
        let (_, curve) = of.curve(layer, i, j).unwrap();
        let size = 1.0 + plain.origin.length() + curve.points().iter().map(|p| p.length()).fold(0.0, f64::max);
        for p in curve.points() {
            let along = (*p - plain.origin).dot(e);
            assert!((*p - plain.origin - along * e).length() <= POINT_ROUNDING * size, "{i},{j}: {p} beside the ray");
            assert!(along >= last - POINT_ROUNDING * size, "{i},{j}: {p} before {last}");
            last = along;
        }
    }
}

fn pixels(of: &Camera) -> impl Iterator<Item = (u32, u32)> + use<> {
    let (w, h) = (of.width, of.height);
    (0..h).flat_map(move |j| (0..w).map(move |i| (i, j)))
}

/// At the borders of curved layers, curves on both sides come together as places do: half the distance, half the jump.
fn assert_curves_seamless(of: &Camera) {
    for layer in 0..of.layers.len() {
        let (Rays::Curves(curves), Some(Rays::Pieces(net))) = (&of.layers[layer], of.layers.get(layer + 1)) else {
            continue;
        };
        let size = DVec2::new(of.width as f64, of.height as f64);
        for (_, _, from, to) in borders(net) {
            let (middle, across) = ((from + to) / 2.0, (to - from).perp().normalize());
            if middle.cmplt(DVec2::ONE).any() || middle.cmpgt(size - 1.0).any() {
                continue;
            }
            let jump = |by: f64| {
                let [a, b] =
                    [-by, by].map(|s| (middle + s * across) / size).map(|q| curves.map.curve(q.x, q.y).unwrap().1);
                let distance = a.points().iter().zip(b.points()).map(|(p, q)| (*p - *q).length()).fold(0.0, f64::max);
                let reach = a.points().iter().map(|p| p.length()).fold(1.0, f64::max);
                (distance, POINT_ROUNDING * reach)
            };
            let ((far, rounding), (near, _)) = (jump(2e-3), jump(1e-3));
            assert!((near - far / 2.0).abs() <= 2.0 * rounding, "layer {layer} at {middle}: {near} of {far}");
        }
    }
}
