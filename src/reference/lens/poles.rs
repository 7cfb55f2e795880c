//! Poles of the radial part that a zero cancels (`docs/reference/definitions.md`, Poles that cancel): behind each a branch goes on.

use super::radial::{self, Range, bisect, series};
use super::walk;
use crate::arrays::MapEach;
use crate::camera::calibration::Coefficients;
use glam::DVec2;

/// A part of the plane that shows places.
#[derive(Debug, Clone, Copy)]
pub struct Branch {
    /// The sign of g's denominator.
    side: f64,
    /// The radial part grows from the first to the second, which may be infinite.
    grows: [f64; 2],
    /// A radius at which nothing folds.
    regular: f64,
    /// Its rays lie up to here, if it is less.
    end: f64,
}

impl Branch {
    /// The point of the branch whose distorted place is `q`, which is not the middle.
    pub fn undistorted(&self, k: &Coefficients, q: DVec2) -> Option<DVec2> {
        let p = if k.is_radial() && k.tilt == [0.0; 2] {
            let radius = q.length();
            let r = radial::between(k, self.grows, radius)?;
            DVec2::new(q.x * r / radius, q.y * r / radius)
        } else if self.regular == 0.0 {
            walk::to(k, q)?
        } else {
            walk::from_circle(k, self.side, self.regular, q)?
        };
        (p.length() <= self.end).then_some(p)
    }
}

/// Directions are passed over from no less than the first to no more than the second, relative to the pole's radius.
const PASSED_OVER: [f64; 2] = [0.75, 1.25];

/// The branches from the middle outward, if there is one behind a pole.
pub fn branches(k: &Coefficients) -> Vec<Branch> {
    let [poles, zeros] = [&k.below[..], &k.radial].map_each(roots);
    let mut all = Vec::new();
    let mut last = None;
    for pole in poles {
        let before = last.unwrap_or_else(|| Branch::from(k, 1.0, 0.0, 0.0));
        let off = |zero: &f64| (zero - pole).abs();
        let behind_start = zeros.iter().copied().filter(|zero| *zero > before.grows[0]);
        let nearest = behind_start.min_by(|a, b| off(a).total_cmp(&off(b))).filter(|_| pole > before.grows[0]);
        let Some([before, next]) = nearest.and_then(|zero| passed(k, &before, pole, zero)) else { break };
        all.push(before);
        last = Some(next);
    }
    all.extend(last);
    all
}

impl Branch {
    /// The branch that grows from `start` and also at `regular`, behind it.
    fn from(k: &Coefficients, side: f64, start: f64, regular: f64) -> Branch {
        let grows = |r: Range| radial::grows(k, side, r).0 > 0.0;
        let (mut from, mut to) = (regular, f64::max(1.0, 2.0 * regular));
        while to < f64::MAX.powf(0.125) {
            let end = first_without(&grows, [from, to]);
            if end < to {
                return Branch { side, grows: [start, end], regular, end: f64::INFINITY };
            }
            (from, to) = (to, 2.0 * to);
        }
        Branch { side, grows: [start, f64::INFINITY], regular, end: f64::INFINITY }
    }
}

/// The branch before a pole with its end, and the branch behind it; `None` if the zero does not cancel the pole.
fn passed(k: &Coefficients, before: &Branch, pole: f64, zero: f64) -> Option<[Branch; 2]> {
    let side = -before.side;
    let (before, [last, first], next) = if zero < pole {
        let falls = |r: Range| radial::grows(k, side, r).1 < 0.0;
        let falls_until = first_without(&falls, [pole, 2.0 * pole]);
        let fold = bisect(|r| radial::grows(k, side, Range::at(r)).0 > 0.0, [falls_until, 2.0 * falls_until - pole]);
        let next = Branch::from(k, side, fold, pole + 2.0 * (fold - pole));
        (*before, [before.grows[1], fold], next)
    } else {
        let slope = |c: &[f64], r: f64| series(c, Range::at(r * r)).1.0;
        let place = pole * (slope(&k.radial, zero) / slope(&k.below, pole));
        let grows_to_pole = before.grows[1] >= pole * (1.0 - UNPROVEN);
        let end = radial::between(k, before.grows, place).filter(|_| grows_to_pole)?;
        let next = Branch::from(k, side, zero, zero);
        let regular = radial::between(k, next.grows, place)?;
        (Branch { end, ..*before }, [end, regular], Branch { regular, ..next })
    };
    let is_narrow = last >= PASSED_OVER[0] * pole && first <= PASSED_OVER[1] * pole;
    // the other terms fold nothing at this radius
    let (r, slow) = (next.regular, walk::slow(k, next.regular));
    let [growth, _] = radial::slope(k, side, r, [r, r])?;
    let is_regular = radial::place(k, r) > 2.0 * slow * r && growth > slow;
    (is_narrow && is_regular).then_some([before, next])
}

/// Interval arithmetic proves growth up to some 2^-27 of a pole, relative to its radius; a fold is no closer to a pole than its zero.
const UNPROVEN: f64 = 1.0 / (1 << 20) as f64;

/// An interval this short, relative to its end, is not divided further: 2^-50.
const NARROW: f64 = 1.0 / (1u64 << 50) as f64;

/// The first place in [lo, hi] from which on `holds` is not proven; `hi` if it is proven for all.
fn first_without(holds: &impl Fn(Range) -> bool, [lo, hi]: [f64; 2]) -> f64 {
    if holds(Range(lo, hi)) {
        return hi;
    }
    if hi - lo <= NARROW * hi {
        return lo;
    }
    let middle = lo + (hi - lo) / 2.0;
    let first = first_without(holds, [lo, middle]);
    if first < middle { first } else { first_without(holds, [middle, hi]) }
}

/// The radii at which 1 + c1 r^2 + c2 r^4 + ... changes its sign.
fn roots(c: &[f64]) -> Vec<f64> {
    let mut found = Vec::new();
    let mut from = 0.0;
    while from < f64::MAX.powf(0.125) {
        let to = f64::max(1.0, 2.0 * from);
        roots_between(c, [from, to], &mut found);
        from = to;
    }
    found.into_iter().map(f64::sqrt).collect()
}

/// The same between two squares of radii, each squared.
fn roots_between(c: &[f64], [lo, hi]: [f64; 2], found: &mut Vec<f64>) {
    let (value, slope) = series(c, Range(lo, hi));
    let is_nonzero = |range: Range| range.0 > 0.0 || range.1 < 0.0;
    if is_nonzero(value) {
        return;
    }
    let is_over = |q: f64| series(c, Range::at(q)).0.0 > 0.0;
    if is_nonzero(slope) {
        let last = is_over(hi);
        if is_over(lo) != last {
            found.push(bisect(|q| is_over(q) == last, [lo, hi]));
        }
        return;
    }
    // a double root closer than this changes no sign that rounding leaves
    if hi - lo > f64::EPSILON * hi {
        let middle = lo + (hi - lo) / 2.0;
        roots_between(c, [lo, middle], found);
        roots_between(c, [middle, hi], found);
    }
}
