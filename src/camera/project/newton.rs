//! From a guess to the exact place and t at which a camera's rays or curves pass through a point.

use super::Degenerate;
use crate::arrays::MapEach;
use glam::{DMat3, DVec2, DVec3};

/// The points that an image sees along its rays or curves.
pub trait Volume {
    /// `X(t)` and `X'(t)` at an image place in pixels; `None` where there is no ray.
    fn at(&self, place_px: DVec2, t: f64) -> Option<(DVec3, DVec3)>;
    /// Largest magnitude of the terms of which `X(t)` is the sum: what its rounding is relative to.
    fn size(&self, place_px: DVec2, t: f64) -> f64;
}

/// Where the search ended: a single image, or one of many.
#[derive(Debug, Clone, Copy)]
pub struct Root {
    pub place: DVec2,
    pub t: f64,
    pub degenerate: Option<Degenerate>,
}

/// Steps at most: a simple root takes some five, a double one, to which the way halves, about 35.
const STEPS: usize = 60;

/// Half the step over which slopes are taken, px: small against a pixel, large against the rounding of places.
const SLOPE_PX: f64 = 1.0 / 1024.0;

/// Slopes to both sides whose sizes differ by more than this factor are of two sides of a jump.
const JUMP: f64 = 16.0;

/// The last step of a search that has arrived, px and relative to t; double roots get no closer than the root of f64's
/// precision.
const ARRIVED: f64 = 1e-8;

/// Residual of a search that has arrived, against the rounding of the volume's places (`size` times half an epsilon, a
/// few hundred times) and against a pixel's footprint.
const RESIDUAL_ROUNDING: f64 = 256.0 * f64::EPSILON;
const RESIDUAL_PX: f64 = 1e-7;

/// Damping of a step against the square of the slopes: keeps directions without any slope still.
const DAMPING: f64 = 1e-12;

/// How far a place is moved to see whether it is one of a whole curve, px. Half a pixel alone is not enough: where a pixel shows a full turn,
/// the ray half a pixel away looks exactly backwards, along the same line.
const MOVED_PX: [f64; 4] = [0.5, -0.5, 0.25, -0.25];

/// Such a move changes what is seen by less than this of its size: the place is one of a whole curve. Far above
/// rounding, far under any pixel's footprint.
const STILL: f64 = 1e-12;

/// A guess that leads farther away than this, px, is given up: guesses are taken from cells of a quarter pixel, and
/// what is beyond is found from another one.
const ASTRAY_PX: f64 = 2.0;

/// Solves `X(place, t) = x` from a guess. `None` where that leads nowhere, or away.
pub fn solve(volume: &impl Volume, x: DVec3, guess: DVec2, mut t: f64) -> Option<Root> {
    let mut place = guess;
    for _ in 0..STEPS {
        let (at, along) = volume.at(place, t)?;
        let rest = x - at;
        let slopes = [slope(volume, place, t, DVec2::X)?, slope(volume, place, t, DVec2::Y)?];
        let step = step(slopes, along, rest)?;
        // a pixel at a time: slopes say nothing about what is far away
        let mut scale = 1.0 / step.truncate().length().max(1.0);
        let moved = (0..8).find_map(|_| {
            let to = place + scale * step.truncate();
            let inside = volume.at(to, t + scale * step.z).is_some();
            let found = inside.then_some((to, t + scale * step.z));
            scale *= 0.5;
            found
        })?;
        let last = (moved.0 - place).length().max((moved.1 - t).abs() / t.abs().max(1.0));
        (place, t) = moved;
        if place.distance(guess) > ASTRAY_PX {
            return None;
        }
        if last <= ARRIVED * ARRIVED || (last <= ARRIVED && has_arrived(volume, x, place, t, slopes)) {
            break;
        }
    }
    let slopes = [slope(volume, place, t, DVec2::X)?, slope(volume, place, t, DVec2::Y)?];
    has_arrived(volume, x, place, t, slopes).then(|| Root {
        place,
        t,
        degenerate: degenerate(volume, place, t, slopes),
    })
}

fn has_arrived(volume: &impl Volume, x: DVec3, place: DVec2, t: f64, slopes: [DVec3; 2]) -> bool {
    let Some((at, _)) = volume.at(place, t) else { return false };
    let footprint = slopes[0].length() + slopes[1].length();
    (x - at).length() <= RESIDUAL_ROUNDING * (volume.size(place, t) + x.length()) + RESIDUAL_PX * footprint
}

/// How X changes a pixel along `axis`: to both sides; to one where the other has no ray or is behind a jump.
fn slope(volume: &impl Volume, place: DVec2, t: f64, axis: DVec2) -> Option<DVec3> {
    let at = |s: f64| volume.at(place + s * axis, t).map(|(x, _)| x);
    let here = at(0.0)?;
    let before = at(-SLOPE_PX).map(|x| (here - x) / SLOPE_PX);
    let after = at(SLOPE_PX).map(|x| (x - here) / SLOPE_PX);
    let (Some(a), Some(b)) = (before, after) else { return before.or(after) };
    let jumps = a.length().max(b.length()) > JUMP * a.length().min(b.length());
    let lesser = if a.length() <= b.length() { a } else { b };
    Some(if jumps { lesser } else { 0.5 * (a + b) })
}

/// The damped least squares step in (x, y, t) towards a rest of 0.
fn step(slopes: [DVec3; 2], along: DVec3, rest: DVec3) -> Option<DVec3> {
    let px = slopes[0].length().max(slopes[1].length());
    let speed = along.length();
    // columns of like size, so that one damping fits all
    let scale = DVec3::new(1.0, 1.0, if speed > 0.0 && px > 0.0 { px / speed } else { 1.0 });
    let j = DMat3::from_cols(slopes[0], slopes[1], along * scale.z);
    let square = j.transpose() * j;
    let damping = DAMPING * (square.x_axis.x + square.y_axis.y + square.z_axis.z);
    if damping == 0.0 {
        return Some(DVec3::ZERO);
    }
    let step = (square + DMat3::from_diagonal(DVec3::splat(damping))).inverse() * (j.transpose() * rest);
    let step = step * scale;
    step.is_finite().then_some(step)
}

/// Whether places beside this one see the same point: all of them, or those along one direction.
fn degenerate(volume: &impl Volume, place: DVec2, t: f64, slopes: [DVec3; 2]) -> Option<Degenerate> {
    let (here, along) = volume.at(place, t)?;
    let beside = |v: DVec3| v - along * (v.dot(along) / along.length_squared().max(f64::MIN_POSITIVE));
    let [gx, gy] = slopes.map_each(beside);
    // the direction in which the place may move at the least cost: the lesser eigenvector of the slopes' square
    let (xx, xy, yy) = (gx.dot(gx), gx.dot(gy), gy.dot(gy));
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    let (across, least) = (DVec2::from_angle(angle), DVec2::from_angle(angle).perp());
    let still = |direction: DVec2| {
        let moves = MOVED_PX.map_each(|s| volume.at(place + s * direction, t).map(|(x, _)| beside(x - here).length()));
        let moved = moves.iter().flatten().fold(0.0_f64, |m, v| m.max(*v));
        moved <= STILL * volume.size(place, t) && moves.iter().any(Option::is_some)
    };
    match (still(least), still(across)) {
        (true, true) => Some(Degenerate::Eye),
        (true, false) => Some(Degenerate::Slit),
        _ => None,
    }
}
