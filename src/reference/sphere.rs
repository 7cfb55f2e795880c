//! One ray or curve against one sphere: `docs/reference/definitions.md`, Spheres.
//!
//! Of the ray `X(t) = (p + t d) / h` and the sphere about `c` let `m = c h - p` and `R = r h`. It is met where `|t d - m| = R`, that is,
//! at `t = (d . m -+ s) / d . d`, `s` being the root of `d . d R^2 - |d x m|^2`. Where f64 does not prove what is below the root, or
//! `m . m - R^2`, to half of [`T_ROUNDING`], these are summed exactly.
//!
//! A curve is on the sphere where `|X(t) - c|^2 - r^2` is 0, a polynomial of twice its degree: all roots are found
//! ([`crate::geometry::bernstein`]).

use super::curve::{POINT_ROUNDING, blur};
use super::intersect::{T_ROUNDING, TERM_ROUNDING, cross_size, offset_size};
use super::margin::GAP;
use crate::arrays::MapEach;
use crate::camera::bundle::Bundle;
use crate::camera::curve::Curve;
use crate::geometry::bernstein::{Bernstein, Root, VALUE_ROUNDING};
use crate::geometry::exact::{Exact, Exact3};
use glam::DVec3;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    pub centre: DVec3,
    pub radius: f64,
}

impl Sphere {
    /// The box around it, and around what rounding makes of its ends.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let ends = |v: f64| [(v - self.radius).next_down(), (v + self.radius).next_up()];
        let [x, y, z] = self.centre.to_array().map_each(ends);
        (DVec3::new(x[0], y[0], z[0]), DVec3::new(x[1], y[1], z[1]))
    }

    /// Where the bundle's central ray enters and leaves it, at any t; twice the same where it touches it. `h > 0`.
    pub fn meetings(&self, b: &Bundle) -> Option<[f64; 2]> {
        let (p, d, h) = (b.p[0], b.d[0], b.h[0]);
        let (m, large) = (self.centre * h - p, self.radius * h);
        let offset = offset_size(self.centre, p, h);
        let (w, w_size) = (d.cross(m), cross_size(d.abs(), offset));
        let (a, along) = (d.length_squared(), d.dot(m));

        let mut below = a * large * large - w.length_squared();
        let w_error = TERM_ROUNDING * w_size.element_sum();
        let w_size = w_size.element_sum();
        let below_error = TERM_ROUNDING * (a * large * large + w_size * w_size) + 2.0 * w_size * w_error;
        if 4.0 * below_error > T_ROUNDING * below.abs() {
            below = self.exactly_below(p, d, h);
        }
        if below < 0.0 {
            return None;
        }
        let mut beyond = m.length_squared() - large * large;
        let beyond_error = 4.0 * TERM_ROUNDING * (offset.length_squared() + large * large);
        if 4.0 * beyond_error > T_ROUNDING * beyond.abs() {
            beyond = self.exactly_beyond(p, h);
        }
        // the two t have the product beyond / a; the sum of numbers of one sign cancels nothing
        let far = along + below.sqrt().copysign(along);
        if far == 0.0 {
            return Some([0.0; 2]);
        }
        let (one, other) = (far / a, beyond / far);
        Some([one.min(other), one.max(other)])
    }

    /// Where a curve passes or touches the sphere, ascending: where it enters, the sign is -1.
    pub fn roots(&self, curve: &Curve) -> Vec<Root> {
        let (height, zero) = self.height(curve);
        height.roots(zero)
    }

    /// The curve meets the sphere so flat at `t` that the place is not sure to [`GAP`].
    pub fn is_flat(&self, curve: &Curve, t: f64) -> bool {
        let (height, zero) = self.height(curve);
        2.0 * blur(&height, zero, t) > GAP * t.max(GAP)
    }

    /// The polynomial, and up to which values it may be 0.
    fn height(&self, curve: &Curve) -> (Bernstein, f64) {
        let points = curve.points();
        let offsets: Vec<DVec3> = points.iter().map(|p| *p - self.centre).collect();
        let degree = points.len() - 1;
        let coefficient = |j: usize| {
            let terms = (0..=degree).filter(|i| *i <= j && j - i <= degree);
            let sum: f64 =
                terms.map(|i| choose(degree, i) * choose(degree, j - i) * offsets[i].dot(offsets[j - i])).sum();
            sum / choose(2 * degree, j) - self.radius * self.radius
        };
        let height = Bernstein::new(&(0..=2 * degree).map(coefficient).collect::<Vec<_>>());
        let far = offsets.iter().map(|o| o.length()).fold(self.radius, f64::max);
        let coordinate = points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        // a square of sums of three terms, a weight, a sum of up to four products: twice as many roundings as an edge value has; and
        // the control points' own, on each axis
        let zero = 2.0 * TERM_ROUNDING * far * far
            + 2.0 * VALUE_ROUNDING * height.size()
            + 2.0 * 3.0f64.sqrt() * far * POINT_ROUNDING * coordinate;
        (height, zero)
    }

    /// `m`.
    fn exact_offset(&self, p: DVec3, h: f64) -> Exact3 {
        let one = |k: usize| Exact::product(self.centre[k], h).minus(&Exact::product(p[k], 1.0));
        [one(0), one(1), one(2)]
    }

    /// `R^2`.
    fn exact_square(&self, h: f64) -> Exact {
        let large = Exact::product(self.radius, h);
        large.by(&large)
    }

    /// `d . d R^2 - |d x m|^2`.
    fn exactly_below(&self, p: DVec3, d: DVec3, h: f64) -> f64 {
        let m = self.exact_offset(p, h);
        let squares = |v: &Exact3| v.iter().fold(Exact::default(), |sum, x| sum.plus(&x.by(x)));
        let minor = |i: usize, j: usize| m[j].times(d[i]).minus(&m[i].times(d[j]));
        let a = squares(&d.to_array().map_each(|x| Exact::product(x, 1.0)));
        a.by(&self.exact_square(h)).minus(&squares(&[minor(1, 2), minor(2, 0), minor(0, 1)])).value()
    }

    /// `m . m - R^2`.
    fn exactly_beyond(&self, p: DVec3, h: f64) -> f64 {
        let m = self.exact_offset(p, h);
        let square = m.iter().fold(Exact::default(), |sum, x| sum.plus(&x.by(x)));
        square.minus(&self.exact_square(h)).value()
    }
}

fn choose(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |c, j| c * (n - j) as f64 / (j + 1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Rng;

    /// A parabola and a circle around the same place: closed forms, and a touch.
    #[test]
    fn curves_enter_leave_and_touch() {
        // X = (2 t - 1, (2 t - 1)^2, 0)
        let curve = Curve::new(&[DVec3::new(-1.0, 1.0, 0.0), DVec3::new(0.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0)]);
        let roots = |centre: DVec3, radius: f64| Sphere { centre, radius }.roots(&curve);
        // x^2 + x^4 = r^2
        for radius in [0.3_f64, 0.7, 1.2] {
            let x = (0.5 * ((1.0 + 4.0 * radius * radius).sqrt() - 1.0)).sqrt();
            let found = roots(DVec3::ZERO, radius);
            assert_eq!(found.iter().map(|r| r.sign).collect::<Vec<_>>(), [-1, 1]);
            for (root, x) in found.iter().zip([-x, x]) {
                assert!((root.t - 0.5 * (x + 1.0)).abs() < 1e-14, "{} {x}", root.t);
            }
        }
        let touch = roots(DVec3::new(0.0, -2.0, 0.0), 2.0);
        assert_eq!((touch.len(), touch[0].sign), (1, 0));
        assert!((touch[0].t - 0.5).abs() < 1e-7);
        assert!(roots(DVec3::new(0.0, -2.0, 0.0), 1.999).is_empty());
        // four times through one ball
        assert_eq!(roots(DVec3::new(0.0, 0.6, 0.0), 0.595).iter().map(|r| r.sign).collect::<Vec<_>>(), [-1, 1, -1, 1]);
    }

    fn ray(p: DVec3, d: DVec3, h: f64) -> Bundle {
        Bundle { p: [p * h, DVec3::ZERO, DVec3::ZERO], d: [d * h, DVec3::ZERO, DVec3::ZERO], h: [h, 0.0, 0.0] }
    }

    #[test]
    fn rays_enter_leave_touch_and_pass() {
        let sphere = Sphere { centre: DVec3::new(1.0, 2.0, 3.0), radius: 5.0 };
        // 3, 4, 5 and powers of two: no rounding
        for h in [1.0, 0.5, 4.0] {
            let through = ray(DVec3::new(4.0, 2.0, -13.0), 2.0 * DVec3::Z, h);
            assert_eq!(sphere.meetings(&through), Some([6.0, 10.0]));
            let touching = ray(DVec3::new(6.0, 2.0, -13.0), 2.0 * DVec3::Z, h);
            assert_eq!(sphere.meetings(&touching), Some([8.0; 2]));
            let passing = ray(DVec3::new(6.0_f64.next_up(), 2.0, -13.0), 2.0 * DVec3::Z, h);
            assert_eq!(sphere.meetings(&passing), None);
            let inside = ray(DVec3::new(4.0, 2.0, 3.0), -DVec3::Z, h);
            assert_eq!(sphere.meetings(&inside), Some([-4.0, 4.0]));
            let at_the_middle = ray(DVec3::new(6.0, 2.0, 3.0), DVec3::Z, h);
            assert_eq!(sphere.meetings(&at_the_middle), Some([0.0; 2]));
        }
    }

    /// The point at t is on the sphere to within the error of t, which is relative; f64 alone is off by a million times as much.
    #[test]
    fn small_spheres_far_away_are_met_as_exactly() {
        let mut rng = Rng(3);
        let mut met = 0;
        for _ in 0..2000 {
            let mut vector = || rng.vector();
            let (d, centre, beside) = (vector(), 4.0 * vector(), vector());
            let radius = 1e-7;
            let p = centre - 3.0 * d + radius * beside;
            let sphere = Sphere { centre, radius };
            let Some(t) = sphere.meetings(&ray(p, d, 1.0)) else { continue };
            met += 1;
            // m and t d - m without rounding
            let m = sphere.exact_offset(p, 1.0);
            for t in t {
                let rest: Exact = (0..3).fold(Exact::default(), |sum, k| {
                    let x = Exact::product(d[k], t).minus(&m[k]);
                    sum.plus(&x.by(&x))
                });
                let off = rest.minus(&sphere.exact_square(1.0)).value().abs();
                assert!(off <= 4.0 * T_ROUNDING * t.abs() * d.length() * radius, "{off}");
            }
        }
        assert!(met > 500 && met < 1900, "{met}");
    }

    #[test]
    fn its_box_holds_it() {
        let sphere = Sphere { centre: DVec3::splat(1e9 / 3.0), radius: 1.0 / 3.0 };
        let (lo, hi) = sphere.bounds();
        let end = |sign: f64| Exact::product(sphere.centre.x, 1.0).plus(&Exact::product(sign * sphere.radius, 1.0));
        assert_eq!(end(-1.0).minus(&Exact::product(lo.x, 1.0)).sign(), 1);
        assert_eq!(end(1.0).minus(&Exact::product(hi.x, 1.0)).sign(), -1);
    }
}
