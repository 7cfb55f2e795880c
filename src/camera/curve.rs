//! Curved projectors: Bezier curves of degree 1 to 3, one per pixel (Brosz et al. 2007, section 3).

use super::bundle::Ray;
use crate::parallel;
use glam::{DVec2, DVec3};
use std::fmt::Debug;
use std::sync::Arc;

/// `X(t) = sum of Bernstein(i, m)(t) * points[i]`, t in [0, 1], world units; m = `degree` is 1, 2 or 3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curve {
    points: [DVec3; 4],
    degree: usize,
}

impl Curve {
    /// A curve through 2, 3 or 4 control points.
    pub fn new(points: &[DVec3]) -> Curve {
        debug_assert!((2..=4).contains(&points.len()));
        let mut stored = [DVec3::ZERO; 4];
        stored[..points.len()].copy_from_slice(points);
        Curve { points: stored, degree: points.len() - 1 }
    }

    /// The straight curve of a ray's t in [0, 1].
    pub fn of_ray(ray: &Ray) -> Curve {
        Curve::new(&[ray.origin, ray.origin + ray.direction])
    }

    /// The ray from its start to its end.
    pub fn chord(&self) -> Ray {
        Ray { origin: self.points[0], direction: self.points[self.degree] - self.points[0] }
    }

    pub fn points(&self) -> &[DVec3] {
        &self.points[..=self.degree]
    }

    pub fn degree(&self) -> usize {
        self.degree
    }

    /// `X(t)`, by de Casteljau's construction.
    pub fn at(&self, t: f64) -> DVec3 {
        self.blossom(|_| t)
    }

    /// de Casteljau's construction with a parameter for each of its steps, numbered from the degree down to 1.
    fn blossom(&self, t: impl Fn(usize) -> f64) -> DVec3 {
        let mut p = self.points;
        for n in (1..=self.degree).rev() {
            for k in 0..n {
                p[k] = p[k].lerp(p[k + 1], t(n));
            }
        }
        p[0]
    }

    /// `X'(t)`, the tangent; it is the view direction of shading (Brosz et al. 2007, section 4.3).
    pub fn tangent(&self, t: f64) -> DVec3 {
        let mut slope = Curve { degree: self.degree - 1, ..*self };
        for k in 0..self.degree {
            slope.points[k] = self.degree as f64 * (self.points[k + 1] - self.points[k]);
        }
        slope.at(t)
    }

    /// The part over t in [`from`, `to`] as a curve of its own, by blossoms.
    pub fn span(&self, [from, to]: [f64; 2]) -> Curve {
        let mut span = *self;
        for (k, point) in span.points.iter_mut().enumerate().take(self.degree + 1) {
            *point = self.blossom(|n| if n <= k { to } else { from });
        }
        span
    }

    /// The parts before and after `t`, each over [0, 1]; together the same curve (de Casteljau).
    pub fn split(&self, t: f64) -> [Curve; 2] {
        let (mut before, mut after) = (*self, *self);
        for n in (1..=self.degree).rev() {
            for k in 0..n {
                after.points[k] = after.points[k].lerp(after.points[k + 1], t);
            }
            before.points[self.degree + 1 - n] = after.points[0];
        }
        [before, after]
    }

    /// The same curve as one of the higher degree `m`.
    pub fn elevated(&self, m: usize) -> Curve {
        let mut curve = *self;
        while curve.degree < m {
            let (n, old) = ((curve.degree + 1) as f64, curve.points);
            for (k, point) in curve.points.iter_mut().enumerate().take(curve.degree + 2) {
                let before = if k == 0 { DVec3::ZERO } else { old[k - 1] };
                *point = (k as f64 / n) * before + (1.0 - k as f64 / n) * old[k];
            }
            curve.degree += 1;
        }
        curve
    }
}

/// A curve for every place of the image.
pub trait CurveMap: Debug + Send + Sync {
    /// Degree of all curves.
    fn degree(&self) -> usize;
    /// The curve at image coordinates (a, b), and the number of the piece that it belongs to; `None`: no curve.
    fn curve(&self, a: f64, b: f64) -> Option<(u32, Curve)>;
    /// The same at a place in pixels of an image of this size.
    fn curve_at(&self, place_px: DVec2, size_px: DVec2) -> Option<(u32, Curve)> {
        self.curve(place_px.x / size_px.x, place_px.y / size_px.y)
    }
    /// Number of pieces; 0 if the image has none.
    fn piece_count(&self) -> usize {
        0
    }
    /// Bounds that hold at every place of a rectangle, its least and greatest corner; `None`: not known. The curves then are all there, and
    /// first and second derivatives of their control points do not jump.
    fn bend(&self, _ab: [DVec2; 2]) -> Option<Bend> {
        None
    }
}

/// Largest magnitudes of third derivatives of any control point by (a, b): how far curves are from quadratic ones. World units.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bend {
    pub aaa: f64,
    pub aab: f64,
    pub abb: f64,
    pub bbb: f64,
}

impl Bend {
    pub fn max(self, other: Bend) -> Bend {
        Bend {
            aaa: self.aaa.max(other.aaa),
            aab: self.aab.max(other.aab),
            abb: self.abb.max(other.abb),
            bbb: self.bbb.max(other.bbb),
        }
    }

    /// Of what is so many times as large.
    pub fn times(self, size: f64) -> Bend {
        Bend { aaa: size * self.aaa, aab: size * self.aab, abb: size * self.abb, bbb: size * self.bbb }
    }

    /// Of the same curves by (a / x, b / y).
    pub fn scaled(self, x: f64, y: f64) -> Bend {
        let (x, y) = (x.abs(), y.abs());
        Bend {
            aaa: x * x * x * self.aaa,
            aab: x * x * y * self.aab,
            abb: x * y * y * self.abb,
            bbb: y * y * y * self.bbb,
        }
    }
}

/// A map of curves over an image of pixels.
#[derive(Debug, Clone)]
pub struct Curves {
    pub width: u32,
    pub height: u32,
    pub map: Arc<dyn CurveMap>,
    /// Sample position, px from the pixel's top left corner.
    sample: DVec2,
}

impl Curves {
    pub fn new(width: u32, height: u32, map: Arc<dyn CurveMap>) -> Curves {
        Curves { width, height, map, sample: DVec2::splat(0.5) }
    }

    /// Curves of this size; `None` if no pixel has a curve.
    pub fn of_map((width, height): (u32, u32), map: Arc<dyn CurveMap>) -> Option<Curves> {
        let curves = Curves::new(width, height, map);
        let has_curve = |j: u32| (0..width).any(|i| curves.near(i, j, (0.0, 0.0)).is_some());
        parallel::any(0..height, has_curve).then_some(curves)
    }

    pub(super) fn with_sample_offset(&self, dx: f64, dy: f64) -> Curves {
        Curves { sample: DVec2::new(0.5 + dx, 0.5 + dy), ..self.clone() }
    }

    /// The curve `(x, y)` pixels right of and below the sample of pixel `(i, j)`, and its piece.
    pub fn near(&self, i: u32, j: u32, (x, y): (f64, f64)) -> Option<(u32, Curve)> {
        self.at_place(DVec2::new(i as f64 + x, j as f64 + y) + self.sample)
    }

    /// The curve at an image place (px), and its piece.
    pub fn at_place(&self, place_px: DVec2) -> Option<(u32, Curve)> {
        let found = self.map.curve_at(place_px, DVec2::new(self.width.into(), self.height.into()))?;
        found.1.points().iter().all(|p| p.is_finite()).then_some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_starts_and_ends_at_its_outer_points_along_its_outer_legs() {
        let p = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 2.0, 0.0), DVec3::new(3.0, 2.0, 1.0)];
        for m in 1..=3 {
            let c = Curve::new(&p[..=m]);
            assert_eq!((c.at(0.0), c.at(1.0)), (p[0], p[m]));
            assert_eq!((c.tangent(0.0), c.tangent(1.0)), (m as f64 * (p[1] - p[0]), m as f64 * (p[m] - p[m - 1])));
            for k in 0..=8 {
                let t = k as f64 / 8.0;
                let part = c.span([0.25, 0.75]);
                assert!((part.at(t) - c.at(0.25 + 0.5 * t)).length() < 1e-15);
                let higher = c.elevated(3);
                assert!(higher.degree() == 3 && (higher.at(t) - c.at(t)).length() < 1e-15);
                assert!((higher.tangent(t) - c.tangent(t)).length() < 1e-14);
            }
        }
        let middle = Curve::new(&p[..3]).at(0.5);
        assert_eq!(middle, 0.25 * p[0] + 0.5 * p[1] + 0.25 * p[2]);
    }
}
