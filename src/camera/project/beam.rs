//! What holds for the rays of some part of an image: their origins and directions lie in boxes.

use glam::DVec3;

/// Rays `P + t D` with P and D in boxes `[lo, hi]`; P about the anchor of the tree that the beam is in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    pub p: [DVec3; 2],
    pub d: [DVec3; 2],
}

/// Bound on rounding, relative to the coordinates. What counts as on a slit or an eye is within 2^-40 of some 15 terms
/// (`RANK_ROUNDING` of three columns), a found place within a few hundred roundings of 2^-53.
pub const ROUNDING: f64 = 1.0 / (1u64 << 34) as f64;

impl Beam {
    /// No ray: joined with another it is that other.
    pub const NONE: Beam =
        Beam { p: [DVec3::INFINITY, DVec3::NEG_INFINITY], d: [DVec3::INFINITY, DVec3::NEG_INFINITY] };

    /// Any ray.
    pub const ALL: Beam = Beam { p: [DVec3::NEG_INFINITY, DVec3::INFINITY], d: [DVec3::NEG_INFINITY, DVec3::INFINITY] };

    /// The rays up to `p_error` and `d_error` in each component from one.
    pub fn about(p: DVec3, d: DVec3, p_error: f64, d_error: f64) -> Beam {
        Beam { p: [p - p_error, p + p_error], d: [d - d_error, d + d_error] }
    }

    pub fn joined(self, other: &Beam) -> Beam {
        let join = |a: [DVec3; 2], b: [DVec3; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        Beam { p: join(self.p, other.p), d: join(self.d, other.d) }
    }

    /// About `anchor`, with a margin for the rounding of world coordinates and of a t about 0.
    pub fn rebased(self, anchor: DVec3) -> Beam {
        if self.p.iter().chain(&self.d).any(|v| !v.is_finite()) {
            return Beam::ALL;
        }
        let size = |b: &[DVec3; 2]| b[0].abs().max(b[1].abs()).max_element();
        let p_error = ROUNDING * (size(&self.p) + anchor.abs().max_element() + size(&self.d));
        let d_error = ROUNDING * size(&self.d);
        Beam {
            p: [self.p[0] - anchor - p_error, self.p[1] - anchor + p_error],
            d: [self.d[0] - d_error, self.d[1] + d_error],
        }
    }

    /// Some ray may pass through `x`, a point about the anchor, at a t of the range. Holds for a beam wherever it holds
    /// for one inside of it, to the last bit: every step rounds monotonously.
    pub fn may_meet(&self, x: DVec3, [t0, t1]: [f64; 2]) -> bool {
        let [d0, d1] = self.d;
        (t1 >= 0.0 && self.half_meets(x, [d0, d1], [t0.max(0.0), t1]))
            || (t0 < 0.0 && self.half_meets(x, [-d1, -d0], [(-t1).max(0.0), -t0]))
    }

    /// As [`Beam::may_meet`], for 0 <= lo <= hi and directions of its own.
    fn half_meets(&self, x: DVec3, d: [DVec3; 2], [mut lo, mut hi]: [f64; 2]) -> bool {
        let error = ROUNDING * x.abs().max_element();
        for k in 0..3 {
            // P + t D = x with P >= p[0] and D >= d[0]: t d[0] <= x - p[0]; and with the other ends
            for (a, b) in [(d[0][k], x[k] - self.p[0][k] + error), (-d[1][k], self.p[1][k] - x[k] + error)] {
                if a > 0.0 {
                    hi = hi.min(b / a);
                } else if a < 0.0 {
                    lo = lo.max(b / a);
                } else if b < 0.0 {
                    return false;
                }
            }
        }
        lo * (1.0 - ROUNDING) <= hi * (1.0 + ROUNDING)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Rng;

    #[test]
    fn a_beam_meets_every_point_of_its_rays_and_few_others() {
        let mut rng = Rng(5);
        let mut others = 0;
        for _ in 0..20_000 {
            let (p, d) = (rng.vector(), rng.vector());
            let (p_error, d_error) = (0.1 * rng.unit(), 0.1 * rng.unit());
            let beam = Beam::about(p, d, p_error, d_error);
            let t = 4.0 * rng.unit() - 2.0;
            let x = p + p_error * rng.vector() + t * (d + d_error * rng.vector());
            let range = [t - rng.unit(), t + rng.unit()];
            assert!(beam.may_meet(x, range) && beam.may_meet(x, [t, t]), "{beam:?} {x} {t}");
            assert!(beam.joined(&Beam::about(rng.vector(), d, 0.1, 0.0)).may_meet(x, range));
            // where it says yes, some ray is there: t for all components alike, so P and D can be chosen
            let y = 2.0 * rng.vector();
            let sure = (0..=4000).any(|s| {
                let t = f64::from(s) / 1000.0 - 2.0;
                ((y - p - t * d).abs() - (p_error + t.abs() * d_error)).max_element() <= 0.0
            });
            assert!(!sure || beam.may_meet(y, [-2.0, 2.0]));
            others += usize::from(!sure && beam.may_meet(y, [-2.0, 2.0]));
        }
        // those that a step of 1/1000 in t misses
        assert!(others < 100, "{others}");
    }

    #[test]
    fn points_beside_thin_beams_are_told_from_those_on_them() {
        let ray = Beam::about(DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 0.0, -2.0), 0.0, 0.0).rebased(DVec3::ZERO);
        let on = DVec3::new(2.5, 2.0, 0.0);
        assert!(ray.may_meet(on, [0.0, f64::INFINITY]) && ray.may_meet(on, [1.5, 1.5]));
        assert!(!ray.may_meet(on, [0.0, 1.4]) && !ray.may_meet(on, [1.6, 9.0]) && !ray.may_meet(on, [-9.0, 0.0]));
        assert!(!ray.may_meet(on + 1e-8 * DVec3::Y, [0.0, f64::INFINITY]));
        let behind = DVec3::new(0.0, 2.0, 5.0);
        assert!(ray.may_meet(behind, [f64::NEG_INFINITY, 0.0]) && !ray.may_meet(behind, [0.0, f64::INFINITY]));
        assert!(Beam::ALL.may_meet(behind, [3.0, 4.0]) && ray.joined(&Beam::NONE) == ray);
        assert!(Beam::about(on, DVec3::splat(f64::NAN), 0.0, 0.0).rebased(on).may_meet(behind, [0.0, 1.0]));
    }
}
