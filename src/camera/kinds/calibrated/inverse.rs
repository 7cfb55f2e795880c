//! The inverse of [`Brown`]: the ray of a distorted place, on one branch. First of the branch of the middle:
//!
//! The inverse of a distortion has several branches, which meet at folds (det dF/dp = 0) and poles. The rule: follow the straight line
//! from the middle, where the axis is seen, to the place. Its preimage starts at the axis and ends at the place's ray; if it
//! meets a fold or a pole first, the place has no ray. So a place has at most one ray, and neighbours on one side of a fold have
//! neighbouring rays. A point is seen if the line from its distorted place back to the middle ends at the axis. For a radial lens
//! this is the branch from the middle outward to the first fold or pole.
//!
//! On a branch behind a pole, the line is followed from the ring that the branch maps one to one, inward or outward.

use super::brown::{Brown, Ring, Seen};
use glam::DVec2;

/// Most Newton steps. Within [`KANTOROVICH`] each doubles the digits, starting from two.
const STEPS: usize = 12;

/// Bound on `|1 / dF d^2 F| |step|` within twice the first step. At most 1/2, and Newton's method converges to the only root nearby, with
/// dF/dp regular all the way (Kantorovich 1948). Less starts closer to the root.
const KANTOROVICH: f64 = 0.4;

/// A line ends at a fold where det dF/dp falls to this. The determinant falls with the square root of the distance to the fold, so
/// that is within some 2^-44 of it: far less than a pixel.
const FOLD: f64 = 1.0 / (1u64 << 22) as f64;

/// Most steps along a line, so that it ends. Some 50 lead to a fold, and thousands past a near fold.
const LINE_STEPS: usize = 1 << 15;

impl Brown {
    /// The point of the branch whose distorted place is `q`, which is not the middle.
    pub(super) fn inverse(&self, q: DVec2) -> Option<DVec2> {
        let r = self.radial_inverse(q.length());
        let guess = r.map(|r| q * (r / q.length()));
        let found = match self.is_radial() {
            true => guess,
            false => guess
                .and_then(|p| self.newton(p, q))
                .filter(|p| self.is_on_branch(*p))
                .or_else(|| self.follow(self.start(q), q, |_| false)),
        };
        found.filter(|p| p.length() <= self.r_end)
    }

    /// The branch shows the point, as far as it is concerned.
    pub(super) fn sees(&self, p: DVec2) -> bool {
        let r = p.length();
        match self.is_radial() {
            true => self.grows[0] <= r && r < self.grows[1] && r <= self.r_end,
            false => r <= self.r_end && self.is_on_branch(p),
        }
    }

    /// A point of the ring, or disc, that is seen on the line from the middle to `q`.
    fn start(&self, q: DVec2) -> DVec2 {
        let Ring { ends, inside } = self.injective;
        if ends[0] == 0.0 {
            return DVec2::ZERO;
        }
        // the line meets the image of a circle of the ring once; the image is almost a circle, so its angles are almost those of the circle
        let mut p = inside * q.normalize();
        let mut rest = f64::INFINITY;
        loop {
            let off = self.seen(p).place.angle_to(q);
            // rounding keeps it from coming nearer
            if off.abs() >= 0.5 * rest {
                return p;
            }
            (p, rest) = (DVec2::from_angle(off).rotate(p), off.abs());
        }
    }

    /// The preimage of the line through the middle and the distorted place of `p` leads from `p` to the ring, or disc, that is mapped one to
    /// one and is part of the branch.
    fn is_on_branch(&self, p: DVec2) -> bool {
        let ring = self.injective;
        let end = if p.length() < ring.ends[0] { 2.0 * self.seen(p).place } else { DVec2::ZERO };
        ring.holds(p) || self.follow(p, end, |p| ring.holds(p)).is_some_and(|p| ring.holds(p))
    }

    /// Follows from `p` the preimage of the straight line from its distorted place to `end`, up to the end or until `is_enough`. `None` if
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
            // `|1 / dF d^2 F|` within `radius`; the direction from the middle changes there by an angle of sine radius / r at most
            let bend = |radius: f64| {
                let (all, along) = self.bend(p, radius);
                let sine = f64::min(2.0, std::f64::consts::SQRT_2 * radius / p.length());
                steep * all + (lengthwise + steep * sine) * along
            };
            // NaN proves nothing
            loop {
                let is_proven = bend(2.0 * share * step) * share * step <= KANTOROVICH;
                if is_proven {
                    break;
                }
                share *= 0.5;
                // a fold or pole lies within rounding
                let is_known = share * rest.length() > self.rounding(p);
                if !is_known {
                    return None;
                }
            }
            p = self.newton(p, seen.place + share * rest)?;
        }
        None
    }

    /// Newton's method from `p` for the point that is seen at `q`, down to rounding; `None` if it fails.
    fn newton(&self, mut p: DVec2, q: DVec2) -> Option<DVec2> {
        let off = |seen: &Seen| (q - seen.place).length();
        let mut seen = self.seen(p);
        for _ in 0..STEPS {
            let next = p + seen.slope.inverse() * (q - seen.place);
            let there = self.seen(next);
            // stop where a step brings it no nearer
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
    use crate::camera::calibration::Coefficients;
    use crate::camera::kinds::calibrated::branches::Distortion;

    fn brown(k: &[f64]) -> Distortion {
        Distortion::new(&Coefficients::of_opencv(k)).unwrap()
    }

    fn middle(k: &[f64]) -> Brown {
        Brown::new(&Coefficients::of_opencv(k)).unwrap()
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
            let (model, branch) = (brown(k), middle(k));
            let far = branch.grows[1].min(1.5);
            for (i, j) in (-20..=20).flat_map(|i| (-20..=20).map(move |j| (i, j))) {
                let p = DVec2::new(f64::from(i), f64::from(j)) / 20.0 * far;
                let seen = branch.seen(p);
                if p.length() >= 0.97 * far || seen.slope.determinant() <= 0.05 {
                    continue;
                }
                let q = model.distorted(p).unwrap_or_else(|| panic!("{k:?}: {p} is not seen"));
                let found = model.undistorted(q).unwrap_or_else(|| panic!("{k:?}: nothing at {q}, seen from {p}"));
                // the rounding of the place, and of a tilt, over the smallest stretch: at least the determinant over the columns' lengths
                let stretch = seen.slope.determinant() / (seen.slope.x_axis.length() + seen.slope.y_axis.length());
                let tolerance = 4.0 * (branch.rounding(p) + f64::EPSILON * (1.0 + q.length())) / stretch;
                assert!((found - p).length() <= tolerance, "{k:?}: {found}, not {p}, off {}", (found - p).length());
            }
        }
    }

    #[test]
    fn nothing_is_seen_beyond_the_fold() {
        // r - r^3 is largest at r = 1 / sqrt(3), 2 / (3 sqrt(3)) there
        let (barrel, fold) = (brown(&[-1.0]), middle(&[-1.0]).grows[1]);
        assert!((fold - 3f64.sqrt().recip()).abs() < 1e-15);
        let edge = 2.0 / (3.0 * 3f64.sqrt());
        assert!(barrel.undistorted(DVec2::X * (edge + 1e-9)).is_none());
        let inside = barrel.undistorted(DVec2::X * (edge - 1e-9)).unwrap();
        assert!(inside.x < fold && inside.x > fold - 1e-4);
        assert!(barrel.distorted(DVec2::X * (fold - 1e-9)).is_some());
        assert!(barrel.distorted(DVec2::X * (fold + 1e-9)).is_none());
        // tangential terms move the fold by some 2 p r
        let bent = brown(&[-1.0, 0.0, 1e-3, 1e-3]);
        assert!(bent.undistorted(DVec2::X * (edge + 0.1)).is_none());
        assert!(bent.undistorted(DVec2::X * (edge - 0.01)).is_some());
        assert!(bent.distorted(DVec2::X * 1.2).is_none());
    }

    #[test]
    fn coefficients_of_no_lens_are_refused_or_found_in_few_steps() {
        for k in [-1e308, f64::NAN, f64::INFINITY, 1.1e100] {
            assert!(Brown::new(&Coefficients::of_opencv(&[k, 0.01, 1e-3, -2e-3])).is_err(), "{k}");
        }
        // 400 pixels, each of at most some thousand steps; at 1e308 they took minutes
        let started = std::time::Instant::now();
        for k in [-1e100, 1e100, -1e50] {
            let model = brown(&[k, 0.01, 1e-3, -2e-3]);
            let found = (0..400).filter(|n| model.undistorted(DVec2::from_angle(f64::from(*n))).is_some()).count();
            assert_eq!(found == 400, k > 0.0, "{k}: {found}");
        }
        assert!(started.elapsed() < std::time::Duration::from_secs(20), "{:?}", started.elapsed());
    }

    /// Distorted radii go to infinity towards a pole: each has its ray.
    #[test]
    fn the_branch_ends_at_the_pole() {
        for (k, pole) in [
            (&[0.0, 0.0, 0.0, 0.0, 0.0, -0.25][..], 2.0),
            // far outside the picture, as in OpenCV's own calibrations
            (&[0.0, 0.0, 0.0, 0.0, 0.0, -0.08, -0.04, -0.002], 1.954_059_124_772_246_5),
            // of even order: the denominator is (1 - r^2 / 4)^2
            (&[0.0, 0.0, 0.0, 0.0, 0.0, -0.5, 0.0625], 2.0),
            (&[0.0, 0.0, 1e-4, -1e-4, 0.0, -0.08, -0.04, -0.002], 1.954_059_124_772_246_5),
        ] {
            let (model, branch) = (brown(k), middle(k));
            let end = branch.grows[1];
            assert!((end - pole).abs() < 1e-7, "{k:?}: {end}");
            for q in [1e-9, 0.0125, 0.3, 1.0, 10.0, 1e4, 1e9] {
                let q = DVec2::new(0.6, -0.8) * q;
                let p = model.undistorted(q).unwrap_or_else(|| panic!("{k:?}: {q}"));
                assert!(p.length() < end && p.dot(q) > 0.0, "{k:?}: {q} is {p}");
                // the ray's own rounding moves the place by the slope times that: q^2 near a pole, q^1.5 near a double one
                let tolerance = 8.0 * f64::EPSILON * (q.length() + q.length_squared());
                assert!((branch.seen(p).place - q).length() <= tolerance, "{k:?}: {q} is {p}");
            }
            assert!(model.distorted(DVec2::X * 1.001 * pole).is_none(), "{k:?}");
        }
    }

    /// Every point of the injective disc is on the branch of the middle; for a usual lens the disc is most of it.
    #[test]
    fn the_injective_disc_is_part_of_the_branch() {
        for k in [
            &[-0.28, 0.09, 1.2e-3, -8e-4][..],
            &[-0.4095, 0.0777, -0.0080, 0.0038],
            &[0.1, 0.0, 0.1, 0.1, 0.0, 0.0, 0.0, 0.0, 0.05, 0.05],
        ] {
            let model = middle(k);
            for n in 0..64 {
                for share in [0.1, 0.5, 0.9, 0.999] {
                    let p = DVec2::from_angle(f64::from(n)) * model.injective.ends[1].min(2.0) * share;
                    let led = model.follow(DVec2::ZERO, model.seen(p).place, |_| false).unwrap();
                    assert!((led - p).length() < 1e-9, "{k:?}: {p}, led to {led}");
                }
            }
        }
        assert!(middle(&[-0.28, 0.09, 1.2e-3, -8e-4]).injective.ends[1] > 1.2);
    }
}
