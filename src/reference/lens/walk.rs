//! Traces the preimage of the straight line from the middle to a place, through the plane of rays.

use super::brown::seen;
use super::radial;
use crate::arrays::MapEach;
use crate::camera::calibration::Coefficients;
use glam::DVec2;

/// A straight line from the middle through a place, and the branch that its preimage is looked for on.
struct Line<'a> {
    k: &'a Coefficients,
    /// The sign of g's denominator on the branch.
    side: f64,
    place: DVec2,
}

/// A point of the preimage: where it is seen along the line and across it, in units of the line's length, each with its derivative.
#[derive(Clone, Copy)]
struct At {
    p: DVec2,
    along: f64,
    across: f64,
    along_slope: DVec2,
    across_slope: DVec2,
}

impl At {
    /// `None` on a pole or beyond.
    fn new(line: &Line, p: DVec2) -> Option<At> {
        let [u, v] = seen(line.k, line.side, [p.x, p.y])?.map_each(|d| [d.value, d.rate.x, d.rate.y]);
        let line = line.place;
        // (u, v) = along * line + across * line', line' the line rotated by 90 degrees
        let part = |x: f64, y: f64| [0, 1, 2].map_each(|n| (x * u[n] + y * v[n]) / line.length_squared());
        let ([along, ax, ay], [across, cx, cy]) = (part(line.x, line.y), part(-line.y, line.x));
        let at = At { p, along, across, along_slope: DVec2::new(ax, ay), across_slope: DVec2::new(cx, cy) };
        (along + across + ax + ay + cx + cy).is_finite().then_some(at)
    }

    /// det J over the square of the line's length.
    fn determinant(&self) -> f64 {
        self.along_slope.perp_dot(self.across_slope)
    }

    /// The preimage's unit tangent, along which `across` does not change. It points ahead while the determinant is over 0.
    fn ahead(&self) -> DVec2 {
        -self.across_slope.perp().normalize_or_zero()
    }
}

/// Largest rotation of the tangent in a step (its cosine), and largest factor by which the determinant may change from its start to its
/// middle and to its end. Over a pair of close folds the determinant falls and rises like a parabola, which changes it by more than these
/// factors.
const ROTATION_COS: f64 = 0.95;
const CHANGE: f64 = 2.0;

/// The preimage ends at a fold where det J falls to this, as the camera's does.
const FOLD: f64 = 1.0 / (1u64 << 22) as f64;

/// Most steps. Each halves the distance to a fold.
const STEPS: usize = 4096;

/// The point of the branch of the middle whose distorted place is `q`.
pub fn to(k: &Coefficients, q: DVec2) -> Option<DVec2> {
    let line = Line { k, side: 1.0, place: q };
    line.follow(At::new(&line, DVec2::ZERO)?, 0.5 * q.length())
}

/// The point whose distorted place is `q`, on a branch behind a pole that is regular at the radius `r`.
pub fn from_circle(k: &Coefficients, side: f64, r: f64, q: DVec2) -> Option<DVec2> {
    let line = Line { k, side, place: q };
    // the line meets the image of the circle once; the image is almost a circle, so that its angles are almost those of the circle
    let mut angle = q.to_angle();
    let mut rest = f64::INFINITY;
    loop {
        let at = At::new(&line, r * DVec2::from_angle(angle))?;
        let off = at.across.atan2(at.along);
        // rounding keeps it from coming nearer
        if off.abs() >= 0.5 * rest {
            return line.follow(at, (1.0 - at.along) * q.length());
        }
        (angle, rest) = (angle - off, off.abs());
    }
}

impl Line<'_> {
    /// Follows the preimage of the line from one of its points to that of its place. The first step has this length, and is backward if
    /// that is under 0.
    fn follow(&self, mut at: At, mut length: f64) -> Option<DVec2> {
        let way = length.signum();
        for _ in 0..STEPS {
            match self.step(&at, length) {
                Some(next) if (next.along - 1.0) * way >= 0.0 => match self.arrive(&at, &next) {
                    Some(p) => return Some(p),
                    None => length *= 0.5,
                },
                Some(next) => (at, length) = (next, 2.0 * length),
                None => length *= 0.5,
            }
            if at.determinant() * self.place.length_squared() <= FOLD {
                return None;
            }
        }
        None
    }

    /// A step ahead by `length`, or back if it is under 0: the midpoint method, then corrections across the line back onto it.
    fn step(&self, at: &At, length: f64) -> Option<At> {
        let (r, slow) = (at.p.length(), slow(self.k, at.p.length()));
        let size = length.abs();
        let [here, bend] = radial::slope(self.k, self.side, r, [(r - size).max(0.0), r + size])?;
        let is_straight = size * bend <= CHANGE_OF_SLOPE * (here.abs() + slow);
        if !is_straight {
            return None;
        }
        let is_like = |next: &At| {
            let change = next.determinant() / at.determinant();
            next.ahead().dot(at.ahead()) >= ROTATION_COS && (CHANGE.recip()..CHANGE).contains(&change)
        };
        let middle = At::new(self, at.p + 0.5 * length * at.ahead()).filter(is_like)?;
        let mut next = At::new(self, at.p + length * middle.ahead())?;
        for _ in 0..3 {
            let off = next.across / next.across_slope.length_squared() * next.across_slope;
            let is_close = off.length() <= 0.25 * size;
            if !is_close {
                return None;
            }
            next = At::new(self, next.p - off)?;
        }
        is_like(&next).then_some(next)
    }

    /// The preimage of the line's end, which lies between two of its points.
    fn arrive(&self, from: &At, to: &At) -> Option<DVec2> {
        // `along` grows in between: Newton's method, from the nearer end
        let mut at = if (1.0 - from.along).abs() < (to.along - 1.0).abs() { *from } else { *to };
        let stride = from.p.distance(to.p);
        let mut rest = f64::INFINITY;
        loop {
            let off = DVec2::new(1.0 - at.along, -at.across);
            // rounding keeps it from coming nearer
            if off.length() >= 0.5 * rest {
                // the rounding of the point itself, which a pole magnifies
                let rounding =
                    4.0 * f64::EPSILON * at.p.length() * at.along_slope.length().max(at.across_slope.length());
                let is_between = at.p.distance(from.p) <= 1.5 * stride && at.p.distance(to.p) <= 1.5 * stride;
                return (is_between && at.determinant() > 0.0 && off.length() <= ARRIVED + rounding).then_some(at.p);
            }
            rest = off.length();
            // Cramer's rule
            let determinant = at.determinant();
            let x = off.x * at.across_slope.y - off.y * at.along_slope.y;
            let y = off.y * at.along_slope.x - off.x * at.across_slope.x;
            at = At::new(self, at.p + DVec2::new(x, y) / determinant)?;
        }
    }
}

/// Largest change of the radial slope within a step, relative to itself and the other terms' slopes. Interval arithmetic bounds the
/// change, so that no step passes a pole, or a fold close to one, however narrow.
const CHANGE_OF_SLOPE: f64 = 0.5;

/// Bound on the slopes of the tangential and prism terms, which change slowly.
pub fn slow(k: &Coefficients, r: f64) -> f64 {
    let ([p1, p2], [s13, s24]) = (k.tangential, k.prism);
    6.0 * p1.hypot(p2) * r + 2.0 * s13.length() * r + 4.0 * s24.length() * r.powi(3)
}

/// Largest residual, relative to the line's length: far below a pixel, and above the rounding of models whose terms are a thousand
/// times larger than their sum.
const ARRIVED: f64 = 1.0 / (1u64 << 38) as f64;
