//! Brown and Conrady's distortion as OpenCV's `calib3d` has it, with a rational radial part, thin prism terms and a tilted
//! sensor: from a point of the plane that directions are projected to, to its distorted place.
//!
//! `x'' = x' g + 2 p1 x'y' + p2 (r^2 + 2 x'^2) + s1 r^2 + s2 r^4`, `y'' = y' g + p1 (r^2 + 2 y'^2) + 2 p2 x'y' + s3 r^2 + s4 r^4`,
//! `g = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)`, then [`Tilt`]. Other models have up to six terms above the
//! fraction line. [`super::inverse`] inverts one branch of it, and [`super::branches`] puts the branches together.

use super::roots;
use crate::camera::calibration::Coefficients;
use glam::{DMat2, DVec2};

/// The distortion on one branch, without the tilt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Brown {
    /// Numerator and denominator of g as polynomials of r^2. The denominator is over 0 on the branch.
    above: [f64; 7],
    below: [f64; 4],
    /// Numbers of `above` that are in use.
    terms: usize,
    /// p1, p2.
    tangential: [f64; 2],
    /// (s1, s3) and (s2, s4).
    prism: [DVec2; 2],
    /// The radial part r g grows from the first to the second: to a fold or a pole.
    pub(super) grows: [f64; 2],
    /// Rays of this branch lie up to here, if it is less.
    pub(super) r_end: f64,
    /// A ring, or a disc, that the model maps one to one; see [`Brown::injective_around`].
    pub(super) injective: Ring,
}

/// The points at distances from the middle between the first and the second, and a radius of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ring {
    pub ends: [f64; 2],
    pub inside: f64,
}

impl Ring {
    pub fn is_empty(&self) -> bool {
        self.ends[0] >= self.ends[1]
    }

    pub fn holds(&self, p: DVec2) -> bool {
        let r = p.length();
        self.ends[0] <= r && r < self.ends[1]
    }
}

/// A distorted place, before the tilt.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    pub place: DVec2,
    /// Derivatives by x' and y'.
    pub slope: DMat2,
    /// The denominator of g: 0 at a pole.
    pub below: f64,
}

impl Seen {
    /// Not on a fold or a pole, nor beyond an odd number of them.
    pub fn is_upright(&self) -> bool {
        self.below > 0.0 && self.slope.determinant() > 0.0
    }
}

impl Brown {
    /// The branch of the middle.
    ///
    /// # Errors
    /// A coefficient that is not finite or over [`COEFFICIENT_MAX`].
    pub fn new(k: &Coefficients) -> Result<Brown, String> {
        let prism = k.prism.iter().flat_map(|s| [&s.x, &s.y]);
        // NaN is not under the limit
        if !k.radial.iter().chain(&k.below).chain(&k.tangential).chain(prism).all(|k| k.abs() <= COEFFICIENT_MAX) {
            return Err(format!("distortion coefficients: all must be finite, and at most {COEFFICIENT_MAX:e}"));
        }
        let [k1, k2, k3, k4, k5, k6] = k.radial;
        let used = k.radial.iter().rposition(|k| *k != 0.0).map_or(0, |last| last + 1);
        let mut model = Brown {
            // as many as below at least, which is subtracted
            terms: 1 + used.max(k.below.len()),
            above: [1.0, k1, k2, k3, k4, k5, k6],
            below: [1.0, k.below[0], k.below[1], k.below[2]],
            tangential: k.tangential,
            prism: k.prism,
            grows: [0.0; 2],
            r_end: f64::INFINITY,
            injective: Ring { ends: [0.0; 2], inside: 0.0 },
        };
        let pole = roots::first(&model.below);
        let r_max = roots::first(&model.radial_slope()).min(pole).sqrt();
        model.grows = [0.0, r_max];
        model.injective = model.injective_around(0.0, [0.0, pole.sqrt()]);
        Ok(model)
    }

    /// The branch behind the pole at `r_pole`, which ends this one or lies behind its last fold. The branch begins where the radial part
    /// is 0 and grows, at `r_zero`, or if that is `None` at the fold behind the pole.
    pub(super) fn behind_pole(&self, r_pole: f64, r_zero: Option<f64>) -> Option<Brown> {
        let mut model = *self;
        model.above.iter_mut().chain(&mut model.below).for_each(|c| *c = -*c);
        let behind = |c: &[f64]| roots::sign_changes(c).into_iter().map(f64::sqrt).filter(|r| *r > r_pole).collect();
        let (poles, folds): (Vec<f64>, Vec<f64>) = (behind(&model.below), behind(&model.radial_slope()));
        let r_min = r_zero.or(folds.first().copied())?;
        let ends = poles.into_iter().chain(folds).filter(|r| *r > r_min);
        model.grows = [r_min, ends.fold(f64::INFINITY, f64::min)];
        Some(model)
    }

    pub(super) fn above(&self) -> &[f64] {
        &self.above[..self.terms]
    }

    pub(super) fn below(&self) -> &[f64] {
        &self.below
    }

    /// Distortion moves points only towards or away from the middle: no tangential and no prism terms.
    pub(super) fn is_radial(&self) -> bool {
        self.tangential == [0.0; 2] && self.prism == [DVec2::ZERO; 2]
    }

    /// The numerator of d(r g)/dr as a polynomial of q = r^2: `(A + 2 q A') B - 2 q A B'`; the denominator is B^2.
    fn radial_slope(&self) -> Vec<f64> {
        let twice_q = |c: &[f64]| roots::product(&[0.0, 2.0], &roots::derivative(c));
        let first = sum(self.above(), &twice_q(self.above()));
        let minus = roots::product(self.above(), &twice_q(&self.below));
        difference(&roots::product(&first, &self.below), &minus)
    }

    /// The widest ring about the circle of radius `r`, within `limits`, that F maps one to one, onto a region that each straight line from
    /// the middle crosses in one piece. It is empty if there is none.
    ///
    /// Let F = p g + T(p) with T the tangential and prism terms, and J = dF/dp. Then `|dT| <= e = 6 |p12| r + 2 |s13| r + 4 |s24| r^3`
    /// and `|T| <= r e / 2`. The eigenvalues of J's symmetric part are at least `min(g, d(r g)/dr) - e`; where that is positive, so is det J.
    /// `F x dF/dphi` along a circle is at least `r^2 (g^2 - 3 g e / 2 - e^2 / 2)`, which is positive where g > 2 e. Then the image of each
    /// circle turns once around the middle, in one direction, so it crosses each line from the middle once. Along the points of these
    /// crossings |F| grows with r, as det J is positive. So each place of the line has one preimage at most, and those of neighbours
    /// are neighbours. Both conditions hold between roots of `A - 2 B e` and of `(A + 2 q A') B - 2 q A B' - B^2 e`, polynomials of r.
    pub(super) fn injective_around(&self, r: f64, limits: [f64; 2]) -> Ring {
        let of_r = |c: &[f64]| c.iter().flat_map(|c| [*c, 0.0]).collect::<Vec<_>>();
        let [p, s] = [6.0 * self.tangential_size() + 2.0 * self.prism[0].length(), 4.0 * self.prism[1].length()];
        let (below, e) = (of_r(&self.below), [0.0, p, 0.0, s]);
        let less = roots::product(&below, &e);
        let star_shaped = difference(&of_r(self.above()), &less.iter().map(|c| 2.0 * c).collect::<Vec<_>>());
        let one_to_one = difference(&of_r(&self.radial_slope()), &roots::product(&below, &less));
        let holds = roots::value(&star_shaped, r) > 0.0 && roots::value(&one_to_one, r) > 0.0;
        let is_inside = limits[0] <= r && r < limits[1];
        if !(holds && is_inside) {
            return Ring { ends: [r, r], inside: r };
        }
        let ends = roots::sign_changes(&star_shaped).into_iter().chain(roots::sign_changes(&one_to_one));
        let ends = ends.fold(limits, |[lo, hi], end| if end <= r { [end.max(lo), hi] } else { [lo, end.min(hi)] });
        Ring { ends, inside: r }
    }

    fn tangential_size(&self) -> f64 {
        DVec2::from(self.tangential).length()
    }

    /// `g`, its derivative by r^2, and its denominator.
    fn gain(&self, q: f64) -> (f64, f64, f64) {
        let slope = |c: &[f64]| slope(c, q);
        let (a, b) = (roots::value(self.above(), q), roots::value(&self.below, q));
        (a / b, (slope(self.above()) - a / b * slope(&self.below)) / b, b)
    }

    /// The distorted place of `p`, before the tilt.
    pub(super) fn seen(&self, p: DVec2) -> Seen {
        let (q, [p1, p2], [s13, s24]) = (p.length_squared(), self.tangential, self.prism);
        let (g, dg, below) = self.gain(q);
        let bent = DVec2::new(
            2.0 * p1 * p.x * p.y + p2 * (q + 2.0 * p.x * p.x),
            p1 * (q + 2.0 * p.y * p.y) + 2.0 * p2 * p.x * p.y,
        );
        let place = p * g + bent + q * (s13 + q * s24);
        let cross = 2.0 * (p.x * p.y * dg + p1 * p.x + p2 * p.y);
        let prism = 2.0 * s13 + 4.0 * q * s24;
        let dx = DVec2::new(g + 2.0 * p.x * p.x * dg + 2.0 * p1 * p.y + 6.0 * p2 * p.x, cross) + p.x * prism;
        let dy = DVec2::new(cross, g + 2.0 * p.y * p.y * dg + 6.0 * p1 * p.y + 2.0 * p2 * p.x) + p.y * prism;
        Seen { place, slope: DMat2::from_cols(dx, dy), below }
    }

    /// Bound on the rounding error of the place of [`Brown::seen`]: [`ROUNDING`] times the sum of its terms' sizes.
    pub(super) fn rounding(&self, p: DVec2) -> f64 {
        let q = p.length_squared();
        let size = |c: &[f64]| c.iter().rev().fold(0.0, |sum, c| sum * q + c.abs());
        let (a, b, below) = (size(self.above()), size(&self.below), roots::value(&self.below, q).abs());
        let gain = (a + roots::value(self.above(), q).abs() / below * b) / below;
        let bent = 3.0 * self.tangential_size() * q + q * (self.prism[0].length() + q * self.prism[1].length());
        ROUNDING * (p.length() * gain + bent)
    }

    /// Bounds on `|d^2 F|` within `radius` of p, in two parts: of the terms in any direction, and of the term along p / |p|. Infinite
    /// where a pole may lie within.
    ///
    /// The radial part is `d^2 F [h, k] = 2 g' ((p.k) h + (h.k) p + (p.h) k) + 4 g'' (p.h) (p.k) p`. Near a pole its last term, which
    /// is along p, is by far the largest.
    pub(super) fn bend(&self, p: DVec2, radius: f64) -> (f64, f64) {
        let r = p.length();
        let (least, most) = ((r - radius).max(0.0), r + radius);
        let q = (least * least, most * most);
        let derivatives = |c: &[f64]| {
            let numbered = || c.iter().enumerate().map(|(n, c)| (n as f64, c));
            [
                roots::bounds(c.iter().copied(), q),
                roots::bounds(numbered().skip(1).map(|(n, c)| n * c), q),
                roots::bounds(numbered().skip(2).map(|(n, c)| n * (n - 1.0) * c), q),
            ]
        };
        // A and B nearly cancel in calibrations, so bound n = g - 1 = (A - B) / B: n' = ((A - B)' - n B') / B, n'' = ((A - B)'' - 2 n' B' -
        // n B'') / B
        let rest: [f64; 7] = std::array::from_fn(|n| self.above[n] - self.below.get(n).unwrap_or(&0.0));
        let ([a, da, dda], [b, db, ddb]) = (derivatives(&rest[..self.terms]), derivatives(&self.below));
        // NaN proves nothing
        let has_no_pole = b.0 > 0.0;
        if !has_no_pole {
            return (f64::INFINITY, f64::INFINITY);
        }
        let n = over(a, b);
        let dn = over(less(da, times(n, db)), b);
        let ddn = over(less(less(dda, times(dn, (2.0 * db.0, 2.0 * db.1))), times(n, ddb)), b);
        let size = |v: (f64, f64)| v.0.abs().max(v.1.abs());
        let bent = 6.0 * self.tangential_size() + 2.0 * self.prism[0].length() + 12.0 * q.1 * self.prism[1].length();
        (6.0 * most * size(dn) + bent, 4.0 * most * q.1 * size(ddn))
    }

    /// r between the ends of [`Brown::grows`] with r g = `rd`; `None`: the branch does not reach there.
    pub(super) fn radial_inverse(&self, rd: f64) -> Option<f64> {
        // r g >= rd is r A - rd B >= 0, which has no pole
        let f = |r: f64| {
            let q = r * r;
            let a = roots::value(self.above(), q);
            let da = 2.0 * q * slope(self.above(), q);
            (r * a - rd * roots::value(&self.below, q), a + da - rd * 2.0 * r * slope(&self.below, q))
        };
        // the end of the branch, or some r with r g >= rd
        let [lo, mut hi] = self.grows;
        if hi == f64::INFINITY {
            hi = rd.max(1.0).max(2.0 * lo);
            while f(hi).0 < 0.0 {
                hi *= 2.0;
            }
        }
        let is_between = f(lo).0 <= 0.0 && f(hi).0 >= 0.0;
        is_between.then(|| lo + roots::in_bracket(rd - lo, hi - lo, |beyond| f(lo + beyond)))
    }
}

/// Largest coefficient. With this k1 a lens folds at a radius of some 1e-50, whose fourth power f64 still holds. With 1e308 squares of
/// the radius are subnormal, and following a line to the fold takes seconds for each pixel.
const COEFFICIENT_MAX: f64 = 1e100;

/// Relative to the sum of the terms' sizes: Horner's schemes, the quotient and the sum are at most 24 roundings, each half an epsilon.
const ROUNDING: f64 = 12.0 * f64::EPSILON;

/// The value at `x` of the polynomial's derivative.
fn slope(c: &[f64], x: f64) -> f64 {
    c.iter().enumerate().skip(1).rev().fold(0.0, |sum, (n, c)| sum * x + n as f64 * c)
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    let of = |c: &[f64], k: usize| c.get(k).copied().unwrap_or(0.0);
    (0..a.len().max(b.len())).map(|k| of(a, k) + of(b, k)).collect()
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    sum(a, &b.iter().map(|c| -c).collect::<Vec<_>>())
}

/// The product of two intervals.
fn times(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    let all = [a.0 * b.0, a.0 * b.1, a.1 * b.0, a.1 * b.1];
    all.into_iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)))
}

/// The quotient, for b over 0.
fn over(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    times(a, (b.1.recip(), b.0.recip()))
}

/// The difference.
fn less(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 - b.1, a.1 - b.0)
}
