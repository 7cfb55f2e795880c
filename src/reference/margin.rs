//! Conservative bounds on one triangle's hits over a small box about a pixel's centre.

use super::beam::Beam;
use super::bvh::Probe;
use super::intersect::{Corners, OPPOSITE, TERM_ROUNDING, cross_size, offset_size, plane_tolerance};
use crate::arrays::MapEach;
use crate::camera::bundle::Bundle;
use crate::camera::perturb::{EDGE_ON, END_REACH, PERTURB};
use glam::DVec3;

/// Half the side of the box in which a safe pixel's answer must be constant, px (`docs/reference/definitions.md`, Safe).
pub const MARGIN_PX: f64 = 1.0 / 16.0;

/// Two depths closer than this, relative to the larger magnitude, tie (`docs/reference/definitions.md`, Safe).
pub const GAP: f64 = 1e-6;

/// As [`TERM_ROUNDING`], with five more roundings for the sums over the box.
const BOX_ROUNDING: f64 = 2.0 * TERM_ROUNDING;

/// How far the engine's `v h - p` may be off, against a perturbation: 16 roundings of stored numbers (2^-48) of the 64 that it has. Without it
/// two triangles that the eye lies on would not tie, and one whose edge it lies on to within rounding would be missed for sure.
const ENGINE_ROUNDING: f64 = 0.25;

/// `t = back` is behind `t = front` by more than a tie.
pub fn clears(front: f64, back: f64) -> bool {
    back > front && back - front >= GAP * front.abs().max(back.abs())
}

/// No `t` beyond this ties with `front`: `GAP` relative to the farther is less than twice `GAP` of `front`.
pub fn beyond(front: f64) -> f64 {
    front + 2.0 * GAP * front.abs()
}

/// Sum of `|c_k| |monomial|` over the box for an affine function's parts.
fn over_box<T: std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>>([c0, cx, cy]: [T; 3]) -> T {
    c0 + (cx + cy) * MARGIN_PX
}

/// A polynomial of degree 2 in (x, y): coefficients of 1, x, y, x^2, xy, y^2.
struct Quadratic([f64; 6]);

impl Quadratic {
    fn product(a: [f64; 3], b: [f64; 3]) -> Quadratic {
        let pair = |i: usize, j: usize| a[i] * b[j] + a[j] * b[i];
        Quadratic([a[0] * b[0], pair(0, 1), pair(0, 2), a[1] * b[1], pair(1, 2), a[2] * b[2]])
    }

    /// Bounds over the box: x and y in +-r, x^2 and y^2 in [0, r^2], xy in +-r^2.
    fn range(&self) -> [f64; 2] {
        let r = MARGIN_PX;
        let [c, x, y, xx, xy, yy] = self.0;
        let odd = r * (x.abs() + y.abs()) + r * r * xy.abs();
        [c - odd + r * r * (xx.min(0.0) + yy.min(0.0)), c + odd + r * r * (xx.max(0.0) + yy.max(0.0))]
    }
}

/// The sign of `E` of the edge `from -> to` all over the box; 0 where it may change.
fn edge_over_box(b: &Bundle, from: DVec3, to: DVec3, scene_size: f64) -> i8 {
    let edge = to - from;
    let moment: [DVec3; 3] = std::array::from_fn(|a| (from * b.h[a] - b.p[a]).cross(edge));
    let f = |i: usize, j: usize| moment[i].dot(b.d[j]);
    let both = |i: usize, j: usize| f(i, j) + f(j, i);
    let [lo, hi] = Quadratic([f(0, 0), both(0, 1), both(0, 2), f(1, 1), both(1, 2), f(2, 2)]).range();
    let offset = over_box(std::array::from_fn(|a| offset_size(from, b.p[a], b.h[a])));
    let direction = over_box(b.d.map_each(DVec3::abs));
    let of_engine = DVec3::splat(ENGINE_ROUNDING * PERTURB * scene_size * over_box(b.h.map_each(f64::abs)));
    let bound = cross_size(BOX_ROUNDING * offset + of_engine, edge.abs()).dot(direction);
    if lo > bound { 1 } else { -i8::from(hi < -bound) }
}

/// The signs of a triangle's three `E`s over the box, of its own winding, 0 where one may change; by the
/// corner (ascending) that lies opposite the edge.
#[derive(Debug, Clone, Copy)]
pub struct Sides(pub [i8; 3]);

impl Sides {
    pub fn over_box(b: &Bundle, c: &Corners, scene_size: f64) -> Sides {
        Sides(OPPOSITE.map_each(|(i, j, sense)| edge_over_box(b, c.v[i], c.v[j], scene_size) * sense * c.parity))
    }

    /// The triangle may be hit somewhere with its `E`s of this sign.
    pub fn may_be(&self, sign: i8) -> bool {
        !self.0.contains(&-sign)
    }

    /// The triangle may be hit somewhere.
    pub fn may_hit(&self) -> bool {
        self.may_be(1) || self.may_be(-1)
    }

    /// The triangle is hit everywhere.
    pub fn covers(&self) -> bool {
        self.0[0] != 0 && self.0 == [self.0[0]; 3]
    }
}

/// `t = n(x, y) / d(x, y)` of a triangle's plane, both affine, over the box.
#[derive(Debug, Clone, Copy)]
pub struct Depth {
    n: [f64; 3],
    d: [f64; 3],
    /// Bounds of the errors of `n` and `d` over the box.
    n_error: f64,
    d_error: f64,
    /// The sign of `N . D` over the box, of the triangle's own winding; 0 where it may change.
    pub facing: i8,
    /// Holds every `t` of a hit in the box.
    pub span: [f64; 2],
    /// Some ray of the box may hit the triangle at an end of `t_range`.
    pub may_be_at_end: bool,
}

/// Whether hits count as hits at an end of `t_range`. The engine rounds, so with twice the tolerances of the definition they surely do not,
/// with half of them they surely do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum AtEnd {
    Always,
    Sometimes,
    Never,
}

impl Depth {
    /// `beam` is the bundle's over the box.
    pub fn over_box(b: &Bundle, beam: &Beam, c: &Corners, scene_size: f64) -> Depth {
        let (e1, e2) = (c.v[1] - c.v[0], c.v[2] - c.v[0]);
        let normal = e1.cross(e2);
        let size = cross_size(e1.abs(), e2.abs());
        let n: [f64; 3] = std::array::from_fn(|a| normal.dot(c.v[0] * b.h[a] - b.p[a]));
        let d = b.d.map_each(|d| normal.dot(d));
        let offset = over_box(std::array::from_fn(|a| offset_size(c.v[0], b.p[a], b.h[a])));
        let of_engine = ENGINE_ROUNDING * plane_tolerance(normal, scene_size) * over_box(b.h.map_each(f64::abs));
        let n_error = BOX_ROUNDING * size.dot(offset) + of_engine;
        let d_error = BOX_ROUNDING * size.dot(over_box(b.d.map_each(DVec3::abs)));
        let spread = MARGIN_PX * (d[1].abs() + d[2].abs()) + d_error;
        let sign = if d[0] > spread { 1 } else { -i8::from(d[0] < -spread) };
        let mut depth =
            Depth { n, d, n_error, d_error, facing: sign * c.parity, span: [f64::MIN, f64::MAX], may_be_at_end: false };
        let edge_on = EDGE_ON * normal.abs().element_sum() * over_box(b.d.map_each(|d| d.abs().element_sum()));
        if sign != 0 && d[0].abs() - spread >= edge_on {
            depth.span = depth.corner_span();
        } else {
            // Edge-on somewhere in the box: a hit still lies within the triangle's bounds.
            let (lo, hi) = c.bounds();
            let all = [f64::NEG_INFINITY, f64::INFINITY];
            depth.span = beam.span(lo, hi, all).unwrap_or(depth.span);
        }
        depth
    }

    /// Moves hits to the ends of `t_range`, as the definition says; whether all hits of the box are then in the range.
    /// If the camera has several layers, no hit is moved: a hit out of the range and within the tolerance of an end may count or not.
    pub fn take_ends(
        &mut self,
        b: &Bundle,
        c: &Corners,
        t_range: [f64; 2],
        (scene_size, has_layers): (f64, bool),
    ) -> bool {
        let mut in_range = self.span[0] >= t_range[0] && self.span[1] <= t_range[1];
        let tolerance = plane_tolerance((c.v[1] - c.v[0]).cross(c.v[2] - c.v[0]), scene_size);
        let span = self.span;
        for end in t_range.into_iter().filter(|end| end.is_finite()) {
            match self.at_end(b, (span, end), tolerance, scene_size) {
                AtEnd::Never => continue,
                _ if has_layers && in_range => {}
                AtEnd::Always if !has_layers => (self.span, in_range) = ([end; 2], true),
                AtEnd::Always | AtEnd::Sometimes => {
                    self.span = [self.span[0].min(end), self.span[1].max(end)];
                    in_range = false;
                }
            }
            self.may_be_at_end = true;
        }
        in_range
    }

    /// Tells whether hits whose `t` lie in `span` count as hits at an end.
    fn at_end(&self, b: &Bundle, (span, end): ([f64; 2], f64), tolerance: f64, scene_size: f64) -> AtEnd {
        let [centre, x, y]: [f64; 3] = std::array::from_fn(|k| self.n[k] - end * self.d[k]);
        let spread = MARGIN_PX * (x.abs() + y.abs()) + self.n_error + end.abs() * self.d_error;
        let h_spread = MARGIN_PX * (b.h[1].abs() + b.h[2].abs());
        let d_size = over_box(b.d.map_each(|d| d.abs().element_sum()));
        let d_least = 2.0 * b.d[0].abs().element_sum() - d_size;
        let nearest = (span[0] - end).max(end - span[1]).max(0.0);
        let farthest = (span[0] - end).abs().max((span[1] - end).abs());
        let reach = END_REACH * scene_size;
        let (h_least, h_most) = (b.h[0] - h_spread, b.h[0] + h_spread);
        if centre.abs() + spread <= 0.5 * tolerance * h_least && farthest * d_size <= 0.5 * reach * h_least {
            AtEnd::Always
        } else if centre.abs() - spread > 2.0 * tolerance * h_most || nearest * d_least > 2.0 * reach * h_most {
            AtEnd::Never
        } else {
            AtEnd::Sometimes
        }
    }

    /// A ratio of affine functions whose denominator keeps its sign is extreme at the box's corners.
    fn corner_span(&self) -> [f64; 2] {
        let r = MARGIN_PX;
        let mut span = [f64::INFINITY, f64::NEG_INFINITY];
        for (x, y) in [(-r, -r), (r, -r), (-r, r), (r, r)] {
            let below = self.d[0] + x * self.d[1] + y * self.d[2];
            let t = (self.n[0] + x * self.n[1] + y * self.n[2]) / below;
            let below_min = (below.abs() - self.d_error).max(f64::MIN_POSITIVE);
            let error = (self.n_error + t.abs() * self.d_error) / below_min + BOX_ROUNDING * t.abs();
            span = [span[0].min(t - error), span[1].max(t + error)];
        }
        span
    }

    /// Everywhere in the box `other` is behind `self` by at least [`GAP`]: with `t = n/d` of both,
    /// `t_o - (1 +- g) t_s >= 0` and `(1 +- g) t_o - t_s >= 0`, times `d_o d_s` of known sign.
    pub fn hides(&self, other: &Depth, parities: i8) -> bool {
        let sign = f64::from(self.facing * other.facing * parities);
        // a hit that is moved to an end of t_range is nearer or farther than its plane
        if sign == 0.0 || self.may_be_at_end || other.may_be_at_end {
            return false;
        }
        let size = |c: [f64; 3]| over_box(c.map_each(f64::abs));
        let (sn, sd, on, od) = (size(self.n), size(self.d), size(other.n), size(other.d));
        let error = on * self.d_error
            + sd * other.n_error
            + other.n_error * self.d_error
            + sn * other.d_error
            + od * self.n_error
            + self.n_error * other.d_error
            + BOX_ROUNDING * (on * sd + sn * od);
        let back = Quadratic::product(other.n, self.d).0;
        let front = Quadratic::product(self.n, other.d).0;
        [(1.0, 1.0 + GAP), (1.0, 1.0 - GAP), (1.0 + GAP, 1.0), (1.0 - GAP, 1.0)].into_iter().all(|(s, o)| {
            let gap = Quadratic(std::array::from_fn(|k| sign * (s * back[k] - o * front[k])));
            gap.range()[0] > 2.0 * error
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Rng;

    #[test]
    fn a_quadratic_is_within_its_range() {
        let q = Quadratic::product([1.0, -3.0, 2.0], [0.5, 8.0, -1.0]);
        let [lo, hi] = q.range();
        for i in -8..=8 {
            for j in -8..=8 {
                let (x, y) = (MARGIN_PX * f64::from(i) / 8.0, MARGIN_PX * f64::from(j) / 8.0);
                let v = (1.0 - 3.0 * x + 2.0 * y) * (0.5 + 8.0 * x - y);
                assert!(lo <= v && v <= hi);
            }
        }
        assert!(hi - lo < 2.5);
    }

    /// Whole numbers, so that the edge meets the ray at the box's corner without rounding.
    #[test]
    fn an_edge_through_a_corner_of_the_box_is_never_beside_it() {
        let mut rng = Rng(2);
        let mut next = || rng.below(1 << 20) as f64 - f64::from(1 << 19);
        for _ in 0..20_000 {
            let mut vector = || DVec3::new(next(), next(), next());
            let (p, d, along, t) = (vector(), vector(), vector(), vector().x);
            let (px, py) = (vector(), vector());
            let centre = p - px - py;
            let b = Bundle {
                p: [centre, px / MARGIN_PX, py / MARGIN_PX],
                d: [d, DVec3::ZERO, DVec3::ZERO],
                h: [1.0, 0.0, 0.0],
            };
            let at = p + t * d;
            assert_eq!(edge_over_box(&b, at - along, at + 2.0 * along, 0.0), 0);
        }
    }

    #[test]
    fn a_triangle_seen_edge_on_within_the_box_keeps_its_bounds_in_depth() {
        let b = Bundle { p: [DVec3::ZERO; 3], d: [DVec3::Z, DVec3::X, DVec3::Y], h: [1.0, 0.0, 0.0] };
        let beam = Beam::over(&b, MARGIN_PX).unwrap();
        let at = |y: f64, z: f64| DVec3::new(0.1, y, z);
        let c = Corners::new([at(-9.0, 2.0), at(9.0, 2.0), at(0.0, 30.0)]);
        let depth = Depth::over_box(&b, &beam, &c, 0.0);
        // Seen at t = 2 with x = 0.05 and at t = 10 with x = 0.01; not at all with x <= 0.
        assert_eq!(depth.facing, 0);
        assert!(depth.span[0] <= 2.0 && depth.span[0] > 1.0 && depth.span[1] >= 30.0 && depth.span[1] < 31.0);
    }

    #[test]
    fn a_gap_is_relative_to_the_larger_depth() {
        assert!(clears(1.0, 1.0 + 1.1e-6) && !clears(1.0, 1.0 + 0.9e-6));
        assert!(clears(-1.0, -1.0 + 1.1e-6) && !clears(-1.0, -1.0 + 0.9e-6));
        assert!(!clears(2.0, 1.0) && !clears(0.0, 0.0) && clears(0.0, 1e-30));
        for front in [-3.0, 0.0, 5e-9, 7.0] {
            assert!(clears(front, beyond(front).next_up()));
        }
    }
}
