//! A bound on the image error of a piece.
//!
//! At weights `(p, d)` of the ray's point `X = p P + d D` (p = 1 and d = t; or p = 0 and d = 1 at infinity) the piece's point and the
//! exact camera's at the same image place differ, across the ray, by at most `e = (|X_aa| w^2 + 2 |X_ab| w h + |X_bb| h^2) / 8` with
//! w x h the box of the triangle: by Taylor's formula at the place, `sum L_i |v_i - q|^2 / 2` in each axis, and the variance of a
//! distribution on an interval of length w is at most w^2 / 4. A shift of e moves the image by at most e / s, s the smallest
//! singular value of the exact camera's `dX / d(px)` across the ray: its footprint. It is taken as the smallest over the 4 x 4 cells of a
//! lattice over the box, by differences, less the largest step between two cells that adjoin.
//!
//! Between two weights X is affine: e is convex, so at most the larger of the two; and s is at least the least area that dX / d(px)
//! spans, a quadratic function, over the largest of its larger singular values, a convex one.
//!
//! Proven so far as the bounds of [`across`] are, which are sampled. Besides, three things are assumed: that s is
//! about the same where the shifted image lies, under a pixel away; that inside a cell of the lattice s is no further below
//! the smallest than adjoining cells differ; and that the scene's ball bounds t on the piece as it does on the rays at its corners and
//! middle.

use super::bend::{across, usable};
use crate::arrays::MapEach;
use crate::camera::boxes::around;
use crate::camera::bundle::Ray;
use crate::camera::field::RayMap;
use crate::camera::recipe::Setting;
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// The exact camera, and what it looks at.
pub struct Judge {
    pub map: Arc<dyn RayMap>,
    /// Of the image, px.
    pub size: DVec2,
    t_range: [f64; 2],
    /// A ball around the scene.
    scene: Option<(DVec3, f64)>,
    /// Beyond it there is an environment.
    is_endless: bool,
}

/// The verdict on a piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verdict {
    /// The bound on the image error, px; infinite if there is none.
    pub error_px: f64,
    /// A focus or fold is in range: near it there is no bound.
    pub fold: bool,
    /// Some places of the piece's box have no ray, so there is no bound.
    pub rim: bool,
}

impl Verdict {
    /// A piece whose rays miss the scene.
    pub const NONE: Verdict = Verdict { error_px: 0.0, fold: false, rim: false };
    /// A piece at the rim of the rays.
    pub const RIM: Verdict = Verdict { error_px: f64::INFINITY, fold: false, rim: true };
}

/// Intervals of t.
const INTERVALS: usize = 16;

/// A footprint smaller than this share of the largest on its ray is near a focus or fold.
const FOLD_SHARE: f64 = 1.0 / 16.0;

/// Errors under this, px, count as 0: the rounding of differences of numbers some 1e6 times a pixel's size is below it.
const NO_ERROR_PX: f64 = 1e-9;

/// Intervals a side of the lattice on which slopes are taken.
const STEPS: usize = 4;
const CELLS: usize = STEPS * STEPS;

/// How P and D change per px to the right and down, in the plane across the ray.
struct Slope {
    p: [DVec2; 2],
    d: [DVec2; 2],
}

/// Footprint and error at a weight.
struct At {
    /// dX / d(px) across the ray, its larger and its smaller singular value, in each cell of the lattice.
    columns: [[DVec2; 2]; CELLS],
    largest: [f64; CELLS],
    footprints: [f64; CELLS],
    /// The bound e, world units.
    error: f64,
    /// How far a footprint inside a cell may be under the cell's.
    uncertainty: f64,
}

impl Slope {
    fn columns(&self, p: f64, d: f64) -> [DVec2; 2] {
        [0, 1].map_each(|k| p * self.p[k] + d * self.d[k])
    }
}

impl Judge {
    pub fn new(map: Arc<dyn RayMap>, setting: &Setting, (w, h): (u32, u32)) -> Judge {
        let scene = setting.bounds().map(|(lo, hi)| ((lo + hi) / 2.0, (hi - lo).length() / 2.0));
        let size = DVec2::new(w.into(), h.into());
        Judge { map, size, t_range: setting.t_range, scene, is_endless: setting.is_endless() }
    }

    /// The exact ray of an image place in px.
    pub fn ray(&self, at_px: DVec2) -> Option<Ray> {
        let q = at_px / self.size;
        usable(self.map.ray(q.x, q.y))
    }

    /// The verdict on a piece, its box divided into `parts` across and down.
    pub fn judge(&self, corners: &[DVec2; 3], rays: &[Ray; 3], parts: (u32, u32)) -> Verdict {
        let (lo, hi) = around(corners);
        self.judge_about((corners[0] + corners[1] + corners[2]) / 3.0, [lo, hi], rays.to_vec(), hi - lo, parts)
    }

    /// A verdict that holds for each piece of size `piece` in the box from `lo` to `hi`, whose corners have the given rays.
    pub fn judge_box(&self, [lo, hi]: [DVec2; 2], rays: Vec<Ray>, piece: DVec2, parts: (u32, u32)) -> Verdict {
        self.judge_about((lo + hi) / 2.0, [lo, hi], rays, piece, parts)
    }

    /// A verdict as of [`Self::judge_box`], with the middle of the rays' places.
    fn judge_about(
        &self,
        middle: DVec2,
        [lo, hi]: [DVec2; 2],
        mut rays: Vec<Ray>,
        piece: DVec2,
        parts: (u32, u32),
    ) -> Verdict {
        let Some(middle) = self.ray(middle) else { return Verdict::RIM };
        rays.push(middle);
        let Some(weights) = self.weights(&rays) else { return Verdict::NONE };
        let part = (hi - lo) / DVec2::new(parts.0.into(), parts.1.into());
        let mut verdict = Verdict::NONE;
        for (i, j) in (0..parts.1).flat_map(|j| (0..parts.0).map(move |i| (f64::from(i), f64::from(j)))) {
            let from = lo + part * DVec2::new(i, j);
            let Some((error_px, fold)) = self.part(from, part, piece, &weights) else { return Verdict::RIM };
            verdict = Verdict { error_px: verdict.error_px.max(error_px), fold: verdict.fold || fold, ..verdict };
        }
        verdict
    }

    /// The bound, px, over a part of a piece's box of size `whole`, and whether there is a focus or fold; `None` where a ray is
    /// missing.
    fn part(&self, from: DVec2, part: DVec2, whole: DVec2, weights: &[(f64, f64)]) -> Option<(f64, bool)> {
        let across = across(&*self.map, from / self.size, (from + part) / self.size, weights)?;
        let slopes = self.slopes(from, part)?;
        let more = whole / part;
        let mut at: Vec<At> = Vec::with_capacity(weights.len());
        for (&(p, d), &[aa, ab, bb]) in weights.iter().zip(&across) {
            let error = (aa * more.x * more.x + 2.0 * ab * more.x * more.y + bb * more.y * more.y) / 8.0;
            let columns = slopes.each_ref().map(|s| s.columns(p, d));
            let largest = columns.each_ref().map(largest);
            // their product is the area that the columns span, which is no difference of near numbers
            let footprints = std::array::from_fn(|k| smallest_between(&columns[k], &columns[k], largest[k]));
            at.push(At { uncertainty: largest_step(&footprints), footprints, largest, columns, error });
        }
        Some(worst(&at))
    }

    /// The rays' slopes in each cell of a lattice over a box.
    fn slopes(&self, from: DVec2, size: DVec2) -> Option<[Slope; CELLS]> {
        let step = size / STEPS as f64;
        let place = |k: usize| from + step * DVec2::new((k % (STEPS + 1)) as f64, (k / (STEPS + 1)) as f64);
        let rays: Vec<Ray> = (0..(STEPS + 1) * (STEPS + 1)).map(|k| self.ray(place(k))).collect::<Option<_>>()?;
        let slope = |k: usize| {
            let (here, right, below) = (&rays[k], &rays[k + 1], &rays[k + STEPS + 1]);
            let (e1, e2) = here.direction.normalize().any_orthonormal_pair();
            let across = |v: DVec3| DVec2::new(v.dot(e1), v.dot(e2));
            Slope {
                p: [across(right.origin - here.origin) / step.x, across(below.origin - here.origin) / step.y],
                d: [
                    across(right.direction - here.direction) / step.x,
                    across(below.direction - here.direction) / step.y,
                ],
            }
        };
        Some(std::array::from_fn(|k| slope(k / STEPS * (STEPS + 1) + k % STEPS)))
    }

    /// Weights of P and D at the ends of intervals of t in the range and the scene, and of the environment, which is seen by direction
    /// alone; `None` where rays see nothing. Rays from one point have the same image error at every t.
    fn weights(&self, rays: &[Ray]) -> Option<Vec<(f64, f64)>> {
        let [mut first, mut last] = self.t_range;
        if let Some((centre, radius)) = self.scene {
            let span = |r: &Ray| {
                let (length, t) =
                    (r.direction.length(), r.direction.dot(centre - r.origin) / r.direction.length_squared());
                (t - radius / length, t + radius / length)
            };
            let ends =
                rays.iter().map(span).fold((f64::INFINITY, f64::NEG_INFINITY), |m, s| (m.0.min(s.0), m.1.max(s.1)));
            (first, last) = (first.max(ends.0), last.min(ends.1));
        }
        let far = (0.0, 1.0);
        if first > last {
            return self.is_endless.then(|| vec![far]);
        }
        if rays.iter().all(|r| r.origin == rays[0].origin) {
            return Some(vec![far]);
        }
        // an end at infinity is the direction alone
        let end = |t: f64| if t.is_finite() { (1.0, t) } else { (0.0, t.signum()) };
        let (from, to) = (end(first), end(last));
        let joined = if from.0 == 0.0 && to.0 == 0.0 { vec![from, (1.0, 0.0), to] } else { vec![from, to] };
        let between = |a: (f64, f64), b: (f64, f64)| {
            (0..INTERVALS).map(move |k| {
                let s = k as f64 / INTERVALS as f64;
                ((1.0 - s) * a.0 + s * b.0, (1.0 - s) * a.1 + s * b.1)
            })
        };
        let mut weights: Vec<_> = joined.windows(2).flat_map(|w| between(w[0], w[1])).collect();
        weights.push(to);
        if self.is_endless && to != far {
            weights.push(far);
        }
        Some(weights)
    }
}

/// The largest error in px over the weights, those near a focus or fold left out; and whether there are such with an error.
fn worst(at: &[At]) -> (f64, bool) {
    let widest = at.iter().flat_map(|a| &a.footprints).fold(0f64, |m, s| m.max(*s));
    let (mut error_px, mut fold, mut bounded) = (0f64, false, false);
    let intervals = at.windows(2).map(|w| (&w[0], &w[1]));
    for (a, b) in intervals.chain((at.len() == 1).then(|| (&at[0], &at[0]))) {
        let error = a.error.max(b.error);
        if error <= NO_ERROR_PX * widest {
            bounded = true;
            continue;
        }
        let least = |k: usize| smallest_between(&a.columns[k], &b.columns[k], a.largest[k].max(b.largest[k]));
        let footprint = (0..CELLS).map(least).fold(f64::INFINITY, f64::min);
        if footprint < FOLD_SHARE * widest || footprint <= 0.0 {
            fold = true;
            continue;
        }
        bounded = true;
        let sure = footprint - a.uncertainty.max(b.uncertainty);
        error_px = error_px.max(if sure > 0.0 { error / sure } else { f64::INFINITY });
    }
    // a bound that holds nowhere is none
    (if bounded { error_px } else { f64::INFINITY }, fold)
}

/// The largest difference between cells of the lattice that adjoin.
fn largest_step(footprints: &[f64]) -> f64 {
    let right = (0..footprints.len()).filter(|k| k % STEPS + 1 < STEPS).map(|k| (k, k + 1));
    let below = (0..footprints.len() - STEPS).map(|k| (k, k + STEPS));
    right.chain(below).fold(0f64, |m, (k, l)| m.max((footprints[k] - footprints[l]).abs()))
}

/// The larger singular value of two columns.
fn largest(columns: &[DVec2; 2]) -> f64 {
    let (xx, xy, yy) = (columns[0].length_squared(), columns[0].dot(columns[1]), columns[1].length_squared());
    ((xx + yy) / 2.0 + ((xx - yy) / 2.0).hypot(xy)).sqrt()
}

/// A lower bound on the smaller singular value of all columns on the way from `a` to `b`: the area is quadratic, so it lies
/// between its Bernstein coefficients; the larger value is convex, so it is at most `most`, the larger of both ends'.
fn smallest_between(a: &[DVec2; 2], b: &[DVec2; 2], most: f64) -> f64 {
    let middle = (a[0].perp_dot(b[1]) + b[0].perp_dot(a[1])) / 2.0;
    let areas = [a[0].perp_dot(a[1]), middle, b[0].perp_dot(b[1])];
    let least = areas.iter().fold(f64::INFINITY, |m, v| m.min(v * areas[0].signum()));
    if most > 0.0 { least.max(0.0) / most } else { 0.0 }
}
