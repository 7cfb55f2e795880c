//! A parallel projection of the world to the page: lines stay lines and Bezier curves keep their control points.

use super::svg::Frame;
use crate::arrays::MapEach;
use glam::{DVec2, DVec3};

/// Position on the page `(x, y) = (right . p, -up . p) scale + offset`, px.
#[derive(Debug, Clone)]
pub struct View {
    right: DVec3,
    up: DVec3,
    scale: f64,
    offset: DVec2,
}

/// How far the viewer may turn from behind the camera to its side, the best first: cameras look to the right, a little
/// inwards.
const AZIMUTHS_DEGREES: [f64; 3] = [62.0, 48.0, 76.0];
/// The viewer does not look along a world axis, where boxes would be seen edge on: the least sine.
const OFF_AXIS_SIN: f64 = 0.2;
/// Rays whose unit directions have a shorter mean look everywhere.
const COHERENT_MIN: f64 = 0.1;
/// Elevation of the viewer above the horizon.
const ELEVATION_DEGREES: f64 = 24.0;

impl View {
    /// A viewer upright in the world (up is +y), to the right of a camera whose rays have the mean unit direction `look`; of
    /// a camera that looks straight up, down or everywhere as of one that looks along -z.
    pub fn beside(look: DVec3) -> View {
        let level = DVec3::new(look.x, 0.0, look.z);
        let level = if level.length() > COHERENT_MIN { level.normalize() } else { DVec3::NEG_Z };
        let side = level.cross(DVec3::Y);
        let rotated = AZIMUTHS_DEGREES.map_each(|azimuth| {
            let (sin, cos) = azimuth.to_radians().sin_cos();
            sin * side - cos * level
        });
        let off_axis = |from: &&DVec3| from.x.abs().min(from.z.abs()) > OFF_AXIS_SIN;
        let from = *rotated.iter().find(off_axis).unwrap_or(&rotated[0]);
        let (rise, run) = ELEVATION_DEGREES.to_radians().sin_cos();
        let towards = run * from + rise * DVec3::Y;
        let right = DVec3::Y.cross(from);
        View { right, up: towards.cross(right), scale: 1.0, offset: DVec2::ZERO }
    }

    /// The same view, moved and enlarged so that all `points` fill `frame`.
    pub fn fitted(&self, points: &[DVec3], frame: &Frame) -> View {
        let flat = View { scale: 1.0, offset: DVec2::ZERO, ..self.clone() };
        let places = || points.iter().map(|p| flat.place(*p)).filter(|q| q.is_finite());
        let (lo, hi) = places().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), q| (lo.min(q), hi.max(q)));
        let size = hi - lo;
        if !(size.is_finite() && size.max_element() > 0.0) {
            return View { offset: frame.lo + frame.size / 2.0, ..flat };
        }
        // a side without extent takes no space
        let scale = (frame.size / size).min_element();
        View { scale, offset: frame.lo + frame.size / 2.0 - scale * (lo + hi) / 2.0, ..flat }
    }

    pub fn place(&self, p: DVec3) -> DVec2 {
        DVec2::new(self.right.dot(p), -self.up.dot(p)) * self.scale + self.offset
    }

    /// Projects a world direction onto the page; its length is kept if it is parallel to the page.
    pub fn on_page(&self, d: DVec3) -> DVec2 {
        DVec2::new(self.right.dot(d), -self.up.dot(d))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_look_to_the_right_and_up_is_up() {
        for look in [DVec3::NEG_Z, DVec3::X, DVec3::new(-0.7, -0.5, 0.3), DVec3::new(-0.4, -0.1, -0.7)] {
            let view = View::beside(look);
            assert!(view.on_page(look).x > 0.5 * look.length(), "{look}");
            let up = view.on_page(DVec3::Y);
            assert!(up.x.abs() < 1e-15 && up.y < -0.5, "{up}");
        }
        // straight down and everywhere are as along -z
        for look in [DVec3::NEG_Y, DVec3::ZERO, DVec3::new(1e-17, 0.0, 1e-17)] {
            assert!(View::beside(look).on_page(DVec3::NEG_Z).x > 0.5);
        }
    }

    #[test]
    fn all_points_fill_the_frame() {
        let frame = Frame::new(10.0, 20.0, 300.0, 200.0);
        let points = [DVec3::new(-5.0, 1.0, 2.0), DVec3::new(40.0, 3.0, -7.0), DVec3::new(1.0, 9.0, 9.0)];
        let view = View::beside(DVec3::X).fitted(&points, &frame);
        let places = points.map(|p| view.place(p));
        let lo = places.iter().fold(DVec2::INFINITY, |m, q| m.min(*q));
        let hi = places.iter().fold(DVec2::NEG_INFINITY, |m, q| m.max(*q));
        // places are sums of some products of numbers under 1e3
        let tiny = 1e-11;
        assert!((lo - frame.lo).min_element() > -tiny && (frame.hi() - hi).min_element() > -tiny, "{lo} {hi}");
        assert!((hi - lo - frame.size).abs().min_element() < tiny, "one side is filled");
        // no extent at all: in the middle
        assert_eq!(view.fitted(&[DVec3::ZERO], &frame).place(DVec3::ZERO), DVec2::new(160.0, 120.0));
    }
}
