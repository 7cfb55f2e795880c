//! All rays of a bundle within a box about its centre, as an interval of origins and one of directions.

use super::bvh::Probe;
use crate::arrays::MapEach;
use crate::camera::bundle::Bundle;
use glam::DVec3;

/// Relative error of a slab bound `(c - a) * (1 / b)`: three roundings of half an epsilon each, doubled.
const SLAB_ROUNDING: f64 = 3.0 * f64::EPSILON;

/// Relative error of a corner of the hull, `(p0 + x p1 + y p2) / (h0 + x h1 + y h2)`, against the sum of
/// the terms' magnitudes: five roundings above, five below and the division, half an epsilon each, rounded up.
const HULL_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Componentwise bounds of `P` and `D` over a box of the image. `P = p/h` and `D = d/h` are projective, so
/// with `h > 0` on the box each component is extreme at a corner.
#[derive(Debug, Clone, Copy)]
pub struct Beam {
    /// The part with `t >= 0`.
    forward: Half,
    /// The part with `t < 0`, as rays of the opposite directions.
    backward: Half,
}

/// Rays `P + s D`, `s >= 0`.
#[derive(Debug, Clone, Copy)]
struct Half {
    origin: Interval3,
    direction: Interval3,
    /// `1 / direction`, bound by bound.
    inverse: Interval3,
}

#[derive(Debug, Clone, Copy)]
struct Interval3 {
    lo: [f64; 3],
    hi: [f64; 3],
}

impl Beam {
    /// The rays at `|x|, |y| <= half_px`; `None` when `h <= 0` somewhere there or a ray is not finite.
    pub fn over(bundle: &Bundle, half_px: f64) -> Option<Beam> {
        let r = half_px;
        let h_min = bundle.h[0] - r * (bundle.h[1].abs() + bundle.h[2].abs());
        let h_size = bundle.h[0].abs() + r * (bundle.h[1].abs() + bundle.h[2].abs());
        if h_min <= HULL_ROUNDING * h_size || !h_min.is_finite() {
            return None;
        }
        let origin = hull(&bundle.p, &bundle.h, r, h_size / (h_min * h_min))?;
        let direction = hull(&bundle.d, &bundle.h, r, h_size / (h_min * h_min))?;
        let reversed = Interval3 { lo: direction.hi.map_each(|v| -v), hi: direction.lo.map_each(|v| -v) };
        Some(Beam { forward: Half::new(origin, direction), backward: Half::new(origin, reversed) })
    }
}

impl Probe for Beam {
    /// Some ray of the beam is in the box.
    fn span(&self, lo: DVec3, hi: DVec3, range: [f64; 2]) -> Option<[f64; 2]> {
        let front = if range[1] >= 0.0 { self.forward.clip(lo, hi, [range[0].max(0.0), range[1]]) } else { None };
        if range[0] >= 0.0 {
            return front;
        }
        let back = self.backward.clip(lo, hi, [(-range[1]).max(0.0), -range[0]]).map(|[s0, s1]| [-s1, -s0]);
        match (back, front) {
            (Some(b), Some(f)) => Some([b[0], f[1]]),
            (b, f) => b.or(f),
        }
    }
}

/// Bounds of `(v0 + x v1 + y v2) / h` over the box; `spread` is max|h| / min(h)^2.
fn hull(v: &[DVec3; 3], h: &[f64; 3], r: f64, spread: f64) -> Option<Interval3> {
    let mut lo = DVec3::INFINITY;
    let mut hi = DVec3::NEG_INFINITY;
    for (x, y) in [(-r, -r), (r, -r), (-r, r), (r, r)] {
        let corner = (v[0] + x * v[1] + y * v[2]) / (h[0] + x * h[1] + y * h[2]);
        if !corner.is_finite() {
            return None;
        }
        lo = lo.min(corner);
        hi = hi.max(corner);
    }
    let tolerance = (v[0].abs() + r * (v[1].abs() + v[2].abs())) * (HULL_ROUNDING * spread);
    let (lo, hi) = (lo - tolerance, hi + tolerance);
    (lo.is_finite() && hi.is_finite()).then(|| Interval3 { lo: lo.to_array(), hi: hi.to_array() })
}

impl Half {
    /// Directions of magnitude under the smallest normal f64 are widened past 0 to it, so that every
    /// inverse is finite; wider is still conservative.
    fn new(origin: Interval3, direction: Interval3) -> Half {
        let normal = |v: f64, outward: f64| if v.abs() < f64::MIN_POSITIVE { outward } else { v };
        let lo = direction.lo.map_each(|v| normal(v, -f64::MIN_POSITIVE));
        let hi = direction.hi.map_each(|v| normal(v, f64::MIN_POSITIVE));
        let inverse = Interval3 { lo: lo.map_each(f64::recip), hi: hi.map_each(f64::recip) };
        Half { origin, direction: Interval3 { lo, hi }, inverse }
    }

    /// The `s` in `range` (both ends >= 0) with, in each component, `P_lo + s D_lo <= hi` and
    /// `P_hi + s D_hi >= lo`.
    fn clip(&self, lo: DVec3, hi: DVec3, range: [f64; 2]) -> Option<[f64; 2]> {
        let (lo, hi) = (lo.to_array(), hi.to_array());
        let (mut enter, mut leave) = (0.0_f64, f64::MAX);
        for c in 0..3 {
            let below = (hi[c] - self.origin.lo[c]) * self.inverse.lo[c];
            if self.direction.lo[c] > 0.0 {
                leave = leave.min(below);
            } else {
                enter = enter.max(below);
            }
            let above = (lo[c] - self.origin.hi[c]) * self.inverse.hi[c];
            if self.direction.hi[c] > 0.0 {
                enter = enter.max(above);
            } else {
                leave = leave.min(above);
            }
        }
        let enter = (enter * (1.0 - SLAB_ROUNDING)).max(range[0]);
        let leave = (leave * (1.0 + SLAB_ROUNDING)).min(range[1]);
        (enter <= leave && enter < f64::INFINITY).then_some([enter, leave])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Rng;

    fn ray(p: DVec3, d: DVec3) -> Bundle {
        Bundle { p: [p, DVec3::ZERO, DVec3::ZERO], d: [d, DVec3::ZERO, DVec3::ZERO], h: [1.0, 0.0, 0.0] }
    }

    const ALL: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

    #[test]
    fn one_ray_through_beside_inside_and_behind_a_box() {
        let (lo, hi) = (DVec3::splat(-1.0), DVec3::ONE);
        let near = |s: Option<[f64; 2]>, a: f64, b: f64| s.is_some_and(|s| (s[0] - a).abs() + (s[1] - b).abs() < 1e-12);
        let through = Beam::over(&ray(DVec3::new(0.0, 0.0, -5.0), DVec3::Z), 0.0).unwrap();
        assert!(near(through.span(lo, hi, ALL), 4.0, 6.0));
        assert!(through.span(lo, hi, [0.0, 3.9]).is_none());
        assert!(near(through.span(lo, hi, [5.0, 5.5]), 5.0, 5.5));
        let beside = Beam::over(&ray(DVec3::new(1.5, 0.0, -5.0), DVec3::Z), 0.0).unwrap();
        assert!(beside.span(lo, hi, ALL).is_none());
        let inside = Beam::over(&ray(DVec3::ZERO, DVec3::new(0.0, 2.0, 0.0)), 0.0).unwrap();
        assert!(near(inside.span(lo, hi, ALL), -0.5, 0.5));
        let behind = Beam::over(&ray(DVec3::new(0.0, 0.0, 5.0), DVec3::Z), 0.0).unwrap();
        assert!(behind.span(lo, hi, [0.0, f64::INFINITY]).is_none());
        assert!(near(behind.span(lo, hi, [f64::NEG_INFINITY, -1.0]), -6.0, -4.0));
        let flat = Beam::over(&ray(DVec3::new(1.0, 1.0, -5.0), DVec3::Z), 0.0).unwrap();
        assert!(near(flat.span(DVec3::new(1.0, 1.0, 2.0), DVec3::new(1.0, 1.0, 2.0), ALL), 7.0, 7.0));
    }

    /// Fails without the tolerance for rounding in the hull and in the slabs.
    #[test]
    fn a_point_exactly_on_a_ray_is_never_lost_to_rounding() {
        let mut rng = Rng(9);
        let mut next = || rng.below(1 << 24) as f64 - f64::from(1 << 23);
        for _ in 0..20_000 {
            let mut vector = || DVec3::new(next(), next(), next());
            let (p, d, t) = (vector(), vector(), vector().x);
            // Whole numbers under 2^47, so that the point is on the ray without rounding.
            let at = p + t * d;
            let mut b = ray(p, d);
            b.h[0] = 3.0;
            b.p[0] *= 3.0;
            b.d[0] *= 3.0;
            let span = Beam::over(&b, 0.0).unwrap().span(at, at, ALL).unwrap();
            assert!(span[0] <= t && t <= span[1]);
        }
    }

    #[test]
    fn no_beam_where_the_weight_vanishes_or_a_ray_is_not_finite() {
        let mut b = ray(DVec3::ZERO, DVec3::Z);
        b.h = [0.05, 1.0, 0.0];
        assert!(Beam::over(&b, 1.0 / 16.0).is_none());
        assert!(Beam::over(&b, 1.0 / 32.0).is_some());
        b.d[0].x = f64::NAN;
        assert!(Beam::over(&b, 0.0).is_none());
    }
}
