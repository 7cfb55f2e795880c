//! The first root of a function along a ray, and how far a kernel's may be from it: the kernel's own function is another one,
//! never farther from this than its error. Its first root lies where this one is no larger than that.

use super::bounded::Bounded;
use super::smooth::Root;

/// A function of s along a ray.
pub struct Along<F> {
    /// Its value and its slope.
    pub function: F,
    /// The least and the largest of its second derivative over the span.
    pub bends: [f64; 2],
    /// Error bound of a kernel's value: a constant, and a factor of s.
    pub error: [f64; 2],
    /// The span that is searched.
    pub span: [Bounded; 2],
    /// Most steps of a kernel.
    pub most: u32,
}

/// A kernel's step as a share of the proven one.
pub const STEP: f64 = 0.99609375;

/// By how many times what a value loses a kernel's root may be off: where a step passes it, slope and bend may have lost as
/// much again, which is as far as the rest of the step does not outweigh it.
const LOSSES: f64 = 2.0;

/// How a march ends.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Reached {
    at: Option<f64>,
    steps: u32,
}

impl<F: Fn(f64) -> [f64; 2]> Along<F> {
    fn error(&self, s: f64) -> f64 {
        LOSSES * (self.error[0] + self.error[1] * s)
    }

    /// The first s from `from` to `to` at which the function, seen from `side`, is no more than `losses` times its error.
    fn first_below(&self, side: f64, losses: f64, from: f64, to: f64) -> Reached {
        let bend = if side > 0.0 { -self.bends[0] } else { self.bends[1] }.max(0.0);
        let (mut s, mut steps) = (from, 0);
        loop {
            let [value, slope] = (self.function)(s);
            let v = side * value - losses * self.error(s);
            let g = losses * LOSSES * self.error[1] - side * slope;
            let root = (g * g + 2.0 * bend * v).sqrt();
            let h = if g < 0.0 { (root - g) / bend } else { 2.0 * v / (root + g) };
            let next = s + STEP * h;
            if v <= 0.0 || next <= s {
                return Reached { at: Some(s), steps };
            }
            // also where it curves away for good, and the step is NaN
            if next.is_nan() || next > to || steps > self.most {
                return Reached { at: None, steps };
            }
            (s, steps) = (next, steps + 1);
        }
    }

    /// The first root as a place on the ray, and whether another evaluation must find it there.
    pub fn first_root(&self) -> Root {
        let [from, to] = self.span;
        let steepest = self.bends[0].abs().max(self.bends[1].abs());
        let [value, slope] = (self.function)(from.v);
        // the side on which it begins, and how far its beginning may be off
        let off = (slope.abs() + steepest * from.e) * from.e;
        let unsure = value.abs() <= self.error(from.v) + off;
        if to.v <= from.v {
            return Root { t: None, uncertain: unsure && to.v + to.e + from.e >= from.v };
        }
        let side = value.signum();
        let end = to.v + to.e;
        let first = self.first_below(side, 1.0, from.v, end);
        let slow = 2 * first.steps > self.most;
        let Some(first) = first.at else { return Root { t: None, uncertain: unsure || slow } };
        let root = self.first_below(side, 0.0, first, to.v).at;
        let last = self.first_below(side, -1.0, first, end).at;
        let (Some(s), Some(last)) = (root, last) else {
            return Root { t: root.map(|s| to.like(s).lost()), uncertain: true };
        };
        // it falls all the way from the one to the other
        let falls = -side * (self.function)(first)[1] > steepest * (last - first);
        // the steps end where no number is between two
        let e = (last - s).max(s - first) + 2.0 * to.unit() * s.abs();
        let uncertain = unsure || slow || !falls || last > to.v - to.e;
        Root { t: Some(to.like(s).off_by(e)), uncertain }
    }
}
