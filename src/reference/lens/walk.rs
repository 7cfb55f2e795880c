//! The walk from the middle to a place, through the plane of rays.

use super::dual::seen;
use super::radial;
use glam::DVec2;

/// A place on the way: what is seen of it along the line and across, each with its slope, and det J.
#[derive(Clone, Copy)]
struct At {
    p: DVec2,
    along: f64,
    across: f64,
    along_slope: DVec2,
    across_slope: DVec2,
}

impl At {
    /// In units of the line; `None` on a pole or beyond it.
    fn new(k: &[f64; 14], line: DVec2, p: DVec2) -> Option<At> {
        let [u, v] = seen(k, [p.x, p.y])?.map(|d| d.0);
        // of (u, v) = along line + across line', line' the line turned by 90 degrees
        let part = |x: f64, y: f64| [0, 1, 2].map(|n| (x * u[n] + y * v[n]) / line.length_squared());
        let ([along, ax, ay], [across, cx, cy]) = (part(line.x, line.y), part(-line.y, line.x));
        let at = At { p, along, across, along_slope: DVec2::new(ax, ay), across_slope: DVec2::new(cx, cy) };
        (along + across + ax + ay + cx + cy).is_finite().then_some(at)
    }

    fn determinant(&self) -> f64 {
        self.along_slope.perp_dot(self.across_slope)
    }

    /// Unit vector along which nothing changes across the line: ahead as long as the determinant is over 0.
    fn ahead(&self) -> DVec2 {
        -self.across_slope.perp().normalize_or_zero()
    }
}

/// A step's turn (cosine), and the factor by which the determinant may change in it, either way, at its middle and its end: as the
/// determinant falls to a fold and rises behind it like a parabola, no step that goes over both keeps to a factor of 4.
const TURN: f64 = 0.95;
const CHANGE: f64 = 2.0;

/// A way on which the determinant falls to this ends at a fold.
const FOLD: f64 = 1.0 / (1u64 << 22) as f64;

/// Steps at most: to a fold each halves the rest.
const STEPS: usize = 4096;

/// The place of the plane z = 1 that is seen at `q`.
pub fn to(k: &[f64; 14], q: DVec2) -> Option<DVec2> {
    let mut at = At::new(k, q, DVec2::ZERO)?;
    let mut length = 0.5 * q.length();
    for _ in 0..STEPS {
        match step(k, q, &at, length) {
            Some(next) if next.along >= 1.0 => match arrive(k, q, &at, &next) {
                Some(p) => return Some(p),
                None => length *= 0.5,
            },
            Some(next) => (at, length) = (next, 2.0 * length),
            None => length *= 0.5,
        }
        if at.determinant() <= FOLD {
            return None;
        }
    }
    None
}

/// How much the radial slope may change within a step, proven by intervals, against itself and the other terms' slopes: no pole and
/// no fold beside one, however narrow, is stepped over.
const CHANGE_OF_SLOPE: f64 = 0.5;

/// The size of the slopes of the tangential and prism terms, which have no narrow places.
fn slow(k: &[f64; 14], r: f64) -> f64 {
    6.0 * k[2].hypot(k[3]) * r + 2.0 * k[8].hypot(k[10]) * r + 4.0 * k[9].hypot(k[11]) * r.powi(3)
}

/// Ahead by `length`: along the middle's direction, then aside onto the line.
fn step(k: &[f64; 14], line: DVec2, at: &At, length: f64) -> Option<At> {
    let (r, slow) = (at.p.length(), slow(k, at.p.length()));
    let [here, bend] = radial::slope(k, r, [(r - length).max(0.0), r + length])?;
    let is_straight = length * bend <= CHANGE_OF_SLOPE * (here.abs() + slow);
    if !is_straight {
        return None;
    }
    let is_like = |next: &At| {
        let change = next.determinant() / at.determinant();
        next.ahead().dot(at.ahead()) >= TURN && (CHANGE.recip()..CHANGE).contains(&change)
    };
    let middle = At::new(k, line, at.p + 0.5 * length * at.ahead()).filter(is_like)?;
    let mut next = At::new(k, line, at.p + length * middle.ahead())?;
    for _ in 0..3 {
        let aside = next.across / next.across_slope.length_squared() * next.across_slope;
        let is_close = aside.length() <= 0.25 * length;
        if !is_close {
            return None;
        }
        next = At::new(k, line, next.p - aside)?;
    }
    is_like(&next).then_some(next)
}

/// The line's end between two places of the way.
fn arrive(k: &[f64; 14], line: DVec2, from: &At, to: &At) -> Option<DVec2> {
    // along changes one way in between: secants, from the end that is nearer
    let mut at = if 1.0 - from.along < to.along - 1.0 { *from } else { *to };
    let stride = from.p.distance(to.p);
    let mut rest = f64::INFINITY;
    loop {
        let off = DVec2::new(1.0 - at.along, -at.across);
        // no nearer for rounding
        if off.length() >= 0.5 * rest {
            // of the place itself, which beside a pole is seen far aside
            let rounding = 4.0 * f64::EPSILON * at.p.length() * at.along_slope.length().max(at.across_slope.length());
            let is_between = at.p.distance(from.p) <= 1.5 * stride && at.p.distance(to.p) <= 1.5 * stride;
            return (is_between && at.determinant() > 0.0 && off.length() <= ARRIVED + rounding).then_some(at.p);
        }
        rest = off.length();
        // Cramer's rule
        let determinant = at.determinant();
        let x = off.x * at.across_slope.y - off.y * at.along_slope.y;
        let y = off.y * at.along_slope.x - off.x * at.across_slope.x;
        at = At::new(k, line, at.p + DVec2::new(x, y) / determinant)?;
    }
}

/// Relative to the line: far under a pixel, over the rounding of models with terms a thousand times the place's size.
const ARRIVED: f64 = 1.0 / (1u64 << 38) as f64;
