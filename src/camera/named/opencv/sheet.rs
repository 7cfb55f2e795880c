//! The inverse of [`Brown`]: the ray of a place, on the sheet that holds the middle.
//!
//! The rule: a place has the ray that is reached by the straight line to it from the middle (where the axis is seen) as long as
//! the line meets neither a fold (det dF/dp = 0) nor a pole. So a place has one ray at most, neighbours on one side of a fold
//! have neighbouring rays, and a point is seen where its own line, followed back, ends in the middle. Of radial lenses that is
//! the branch from the middle outward to its first fold or pole. A tilt maps lines to lines and is undone beforehand.

use super::brown::{Brown, Seen};
use glam::DVec2;

/// Newton steps at most: within [`KANTOROVICH`] each doubles the digits, from two of them on.
const STEPS: usize = 12;

/// Newton's method finds a root, the only one around, with dF/dp regular there and all the way to it, where `|1 / dF d^2 F| |step|`
/// within twice the step is at most 1/2 (Kantorovich 1948); less is closer to the root from the start.
const KANTOROVICH: f64 = 0.4;

/// A line that comes this near to a fold, as det dF/dp, ends there: on a line that meets one that is within 2^-44 of the fold, far under
/// what rounding moves a pixel.
const FOLD: f64 = 1.0 / (1u64 << 22) as f64;

/// Steps along a line at most. Some 50 lead to a fold, thousands past what is all but one; the number only sees to an end.
const LINE_STEPS: usize = 1 << 15;

impl Brown {
    /// The place of the plane z = 1 that is seen at `q`.
    pub fn undistorted(&self, q: DVec2) -> Option<DVec2> {
        let q = self.tilt.back(q)?;
        if q == DVec2::ZERO {
            return Some(q);
        }
        let r = self.radial_inverse(q.length());
        if self.is_radial() {
            return r.map(|r| q * (r / q.length()));
        }
        let guess = r.map(|r| q * (r / q.length()));
        guess
            .and_then(|p| self.newton(p, q))
            .filter(|p| self.is_on_sheet(*p))
            .or_else(|| self.follow(DVec2::ZERO, q, |_| false))
    }

    /// Where a place of the plane z = 1 is seen; `None` where it is not.
    pub fn distorted(&self, p: DVec2) -> Option<DVec2> {
        let sees = if self.is_radial() { p.length() < self.r_max } else { self.is_on_sheet(p) };
        self.tilt.onto(sees.then(|| self.seen(p).place)?)
    }

    /// The line from where `p` is seen to the middle leads `p` there.
    fn is_on_sheet(&self, p: DVec2) -> bool {
        // of the image of the disc, all lines to the middle lie in it
        let is_tame = |p: DVec2| p.length() < self.tame;
        is_tame(p) || self.follow(p, DVec2::ZERO, is_tame).is_some_and(is_tame)
    }

    /// From `p` along the way that is seen as the straight line from there to `end`: to its end, or to where `is_enough`. `None` where
    /// it meets a fold or a pole.
    fn follow(&self, mut p: DVec2, end: DVec2, is_enough: impl Fn(DVec2) -> bool) -> Option<DVec2> {
        let mut share = 1.0;
        for _ in 0..LINE_STEPS {
            let seen = self.seen(p);
            if !(seen.is_upright() && seen.slope.determinant() > FOLD) {
                return None;
            }
            let rest = end - seen.place;
            if is_enough(p) || rest.length() <= self.rounding(p) {
                return Some(p);
            }
            let inverse = seen.slope.inverse();
            let step = (inverse * rest).length();
            // the norm of the inverse is at most that of its columns
            let steep = inverse.x_axis.length().hypot(inverse.y_axis.length());
            let lengthwise = (inverse * p.normalize_or_zero()).length();
            share = f64::min(1.0, 4.0 * share);
            // `|1 / dF d^2 F|` within `room`, where the direction from the middle turns by an angle of sine room / r at most
            let bend = |room: f64| {
                let (all, along) = self.bend(p, room);
                let turn = f64::min(2.0, std::f64::consts::SQRT_2 * room / p.length());
                steep * all + (lengthwise + steep * turn) * along
            };
            // NaN proves nothing
            loop {
                let is_proven = bend(2.0 * share * step) * share * step <= KANTOROVICH;
                if is_proven {
                    break;
                }
                share *= 0.5;
                // rounding alone is between here and a fold or pole
                let is_known = share * rest.length() > self.rounding(p);
                if !is_known {
                    return None;
                }
            }
            p = self.newton(p, seen.place + share * rest)?;
        }
        None
    }

    /// Newton's method from `p` to where `q` is seen, until only rounding is left; `None` where that fails.
    fn newton(&self, mut p: DVec2, q: DVec2) -> Option<DVec2> {
        let off = |seen: &Seen| (q - seen.place).length();
        let mut seen = self.seen(p);
        for _ in 0..STEPS {
            let next = p + seen.slope.inverse() * (q - seen.place);
            let there = self.seen(next);
            // the last step is the one that takes the place no nearer
            let is_nearer = off(&there) < off(&seen);
            if !is_nearer {
                break;
            }
            (p, seen) = (next, there);
        }
        (seen.is_upright() && off(&seen) <= self.rounding(p)).then_some(p)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn brown(k: &[f64]) -> Brown {
        Brown::new(std::array::from_fn(|i| k.get(i).copied().unwrap_or(0.0))).unwrap()
    }

    #[test]
    fn what_is_distorted_is_undistorted() {
        for k in [
            &[][..],
            &[-0.41, 0.507, 0.0, 0.0, -0.578],
            &[-0.2, 0.05, 2e-3, -1e-3],
            &[0.3, 0.1, -4e-3, 2e-3, 0.02, 0.1, 0.05, 0.01],
            // a pole at r = 2
            &[0.0, 0.0, 1e-3, 1e-3, 0.0, -0.25],
            &[0.0, 0.0, 0.0, 0.0, 0.0, -0.25],
            &[-0.3, 0.1, 1e-3, -2e-3, 0.0, 0.1, 0.0, 0.0, 3e-3, -1e-3, 2e-3, 1e-3, 0.05, -0.02],
        ] {
            let model = brown(k);
            let far = model.r_max.min(1.5);
            for (i, j) in (-20..=20).flat_map(|i| (-20..=20).map(move |j| (i, j))) {
                let p = DVec2::new(f64::from(i), f64::from(j)) / 20.0 * far;
                let seen = model.seen(p);
                if p.length() >= 0.97 * far || seen.slope.determinant() <= 0.05 {
                    continue;
                }
                let q = model.distorted(p).unwrap_or_else(|| panic!("{k:?}: {p} is not seen"));
                let found = model.undistorted(q).unwrap_or_else(|| panic!("{k:?}: nothing at {q}, seen from {p}"));
                // the rounding of the place moves the ray by that over the least stretch, determinant over trace; a tilt rounds too
                let stretch = seen.slope.determinant() / (seen.slope.x_axis.length() + seen.slope.y_axis.length());
                let room = 4.0 * (model.rounding(p) + f64::EPSILON * (1.0 + q.length())) / stretch;
                assert!((found - p).length() <= room, "{k:?}: {found}, not {p}, off {}", (found - p).length());
            }
        }
    }

    #[test]
    fn nothing_is_seen_beyond_the_fold() {
        // r - r^3 is largest at r = 1 / sqrt(3), 2 / (3 sqrt(3)) there
        let barrel = brown(&[-1.0]);
        assert!((barrel.r_max - 3f64.sqrt().recip()).abs() < 1e-15);
        let edge = 2.0 / (3.0 * 3f64.sqrt());
        assert!(barrel.undistorted(DVec2::X * (edge + 1e-9)).is_none());
        let inside = barrel.undistorted(DVec2::X * (edge - 1e-9)).unwrap();
        assert!(inside.x < barrel.r_max && inside.x > barrel.r_max - 1e-4);
        assert!(barrel.distorted(DVec2::X * (barrel.r_max - 1e-9)).is_some());
        assert!(barrel.distorted(DVec2::X * (barrel.r_max + 1e-9)).is_none());
        // with a tangential part as well: the fold is at most where 2 p r moves it
        let bent = brown(&[-1.0, 0.0, 1e-3, 1e-3]);
        assert!(bent.undistorted(DVec2::X * (edge + 0.1)).is_none());
        assert!(bent.undistorted(DVec2::X * (edge - 0.01)).is_some());
        assert!(bent.distorted(DVec2::X * 1.2).is_none());
    }

    /// Distorted radii go to infinity before a pole: each has its ray, near the pole as well.
    #[test]
    fn the_branch_ends_at_the_pole() {
        for (k, pole) in [
            (&[0.0, 0.0, 0.0, 0.0, 0.0, -0.25][..], 2.0),
            // far outside of any picture, where OpenCV's own calibrations have them
            (&[0.0, 0.0, 0.0, 0.0, 0.0, -0.08, -0.04, -0.002], 1.954_059_124_772_246_5),
            // of even order: the denominator is (1 - r^2 / 4)^2
            (&[0.0, 0.0, 0.0, 0.0, 0.0, -0.5, 0.0625], 2.0),
            (&[0.0, 0.0, 1e-4, -1e-4, 0.0, -0.08, -0.04, -0.002], 1.954_059_124_772_246_5),
        ] {
            let model = brown(k);
            assert!((model.r_max - pole).abs() < 1e-7, "{k:?}: {}", model.r_max);
            for q in [1e-9, 0.0125, 0.3, 1.0, 10.0, 1e4, 1e9] {
                let q = DVec2::new(0.6, -0.8) * q;
                let p = model.undistorted(q).unwrap_or_else(|| panic!("{k:?}: {q}"));
                assert!(p.length() < model.r_max && p.dot(q) > 0.0, "{k:?}: {q} is {p}");
                // the ray's own rounding moves the place by the slope times that: q^2 near a pole, q^1.5 near a double one
                let room = 8.0 * f64::EPSILON * (q.length() + q.length_squared());
                assert!((model.seen(p).place - q).length() <= room, "{k:?}: {q} is {p}");
            }
            assert!(model.distorted(DVec2::X * 1.001 * pole).is_none(), "{k:?}");
        }
    }

    /// The disc that is known to be one to one holds only places that the line leads to; it is most of the sheet of a usual lens.
    #[test]
    fn the_disc_is_part_of_the_sheet() {
        for k in [
            &[-0.28, 0.09, 1.2e-3, -8e-4][..],
            &[-0.4095, 0.0777, -0.0080, 0.0038],
            &[0.1, 0.0, 0.1, 0.1, 0.0, 0.0, 0.0, 0.0, 0.05, 0.05],
        ] {
            let model = brown(k);
            for n in 0..64 {
                for share in [0.1, 0.5, 0.9, 0.999] {
                    let p = DVec2::from_angle(f64::from(n)) * model.tame.min(2.0) * share;
                    let led = model.follow(DVec2::ZERO, model.seen(p).place, |_| false).unwrap();
                    assert!((led - p).length() < 1e-9, "{k:?}: {p}, led to {led}");
                }
            }
        }
        assert!(brown(&[-0.28, 0.09, 1.2e-3, -8e-4]).tame > 1.2);
    }
}
