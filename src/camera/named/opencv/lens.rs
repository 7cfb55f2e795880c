//! Distortion models and their exact inverses: from the distorted place on the plane z = 1 to the ray.
//!
//! OpenCV's own frame: x right, y down, z forward.

use super::roots;
use glam::{DMat2, DVec2, DVec3};

#[derive(Debug, Clone, Copy)]
pub enum Distortion {
    Brown(Brown),
    Fisheye(KannalaBrandt),
}

impl Distortion {
    /// The direction that is seen at the place `q` = ((u - cx) / fx, (v - cy) / fy); `None`: the model shows nothing there, or
    /// only what it shows nearer to the middle too.
    pub fn direction(&self, q: DVec2) -> Option<DVec3> {
        match self {
            Distortion::Brown(model) => Some(model.undistorted(q)?.extend(1.0)),
            Distortion::Fisheye(model) => model.direction(q),
        }
    }
}

/// Newton steps at most: from within the basin each doubles the digits; halved steps take some more.
const STEPS: u32 = 100;

/// A step this small, relative to the place, changes nothing: 2^-51.
const STEP_ROUNDING: f64 = 1.0 / (1u64 << 51) as f64;

/// The only root of `f(x) = (value, derivative)`, increasing over [0, hi], f(0) <= 0 <= f(hi): Newton, kept in the bracket.
fn increasing_root(mut hi: f64, f: impl Fn(f64) -> (f64, f64)) -> f64 {
    let (mut lo, mut x) = (0.0, hi);
    for _ in 0..STEPS {
        let (value, slope) = f(x);
        if value > 0.0 {
            hi = x
        } else {
            lo = x
        }
        let newton = x - value / slope;
        let next = if newton >= lo && newton <= hi { newton } else { lo + (hi - lo) / 2.0 };
        if (next - x).abs() <= STEP_ROUNDING * x {
            return next;
        }
        x = next;
    }
    x
}

/// Brown and Conrady's model with a rational radial part, as in OpenCV's `calib3d`:
/// `x'' = x' g + 2 p1 x'y' + p2 (r^2 + 2 x'^2)`, `y'' = y' g + p1 (r^2 + 2 y'^2) + 2 p2 x'y'`,
/// `g = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)`.
#[derive(Debug, Clone, Copy)]
pub struct Brown {
    /// Numerator and denominator of g as polynomials of r^2.
    above: [f64; 4],
    below: [f64; 4],
    /// p1, p2.
    tangential: [f64; 2],
    /// r g grows from 0 to here.
    r_max: f64,
}

impl Brown {
    /// From `k1, k2, p1, p2, k3, k4, k5, k6`.
    pub fn new(k: [f64; 8]) -> Brown {
        let (above, below) = ([1.0, k[0], k[1], k[4]], [1.0, k[5], k[6], k[7]]);
        // d(r g)/dr = ((A + 2 q A') B - 2 q A B') / B^2 with q = r^2
        let twice_q = |c: &[f64]| roots::product(&[0.0, 2.0], &roots::derivative(c));
        let first: Vec<f64> = above.iter().zip(twice_q(&above)).map(|(a, b)| a + b).collect();
        let (plus, minus) = (roots::product(&first, &below), roots::product(&above, &twice_q(&below)));
        let slope: Vec<f64> = plus.iter().zip(minus).map(|(a, b)| a - b).collect();
        let q_max = roots::first(&slope).min(roots::first(&below));
        Brown { above, below, tangential: [k[2], k[3]], r_max: q_max.sqrt() }
    }

    /// `g` and its derivative by r^2.
    fn gain(&self, q: f64) -> (f64, f64) {
        let slope = |c: &[f64; 4]| c[1] + q * (2.0 * c[2] + 3.0 * q * c[3]);
        let (a, b) = (roots::value(&self.above, q), roots::value(&self.below, q));
        (a / b, (slope(&self.above) - a / b * slope(&self.below)) / b)
    }

    /// The distorted place and its derivatives by x' and y'.
    pub fn distorted(&self, p: DVec2) -> (DVec2, DMat2) {
        let (q, [p1, p2]) = (p.length_squared(), self.tangential);
        let (g, dg) = self.gain(q);
        let place = p * g
            + DVec2::new(
                2.0 * p1 * p.x * p.y + p2 * (q + 2.0 * p.x * p.x),
                p1 * (q + 2.0 * p.y * p.y) + 2.0 * p2 * p.x * p.y,
            );
        let cross = 2.0 * (p.x * p.y * dg + p1 * p.x + p2 * p.y);
        let dx = DVec2::new(g + 2.0 * p.x * p.x * dg + 2.0 * p1 * p.y + 6.0 * p2 * p.x, cross);
        let dy = DVec2::new(cross, g + 2.0 * p.y * p.y * dg + 6.0 * p1 * p.y + 2.0 * p2 * p.x);
        (place, DMat2::from_cols(dx, dy))
    }

    /// The place in the monotone range that is seen at `q`.
    pub fn undistorted(&self, q: DVec2) -> Option<DVec2> {
        if q == DVec2::ZERO && self.tangential == [0.0; 2] {
            return Some(q);
        }
        let radial = self.radial_inverse(q.length());
        let start = match (radial, self.tangential) {
            (None, [0.0, 0.0]) => return None,
            (Some(r), [0.0, 0.0]) => return Some(q * (r / q.length())),
            // beyond the range without the tangential part, which may bring it back
            (None, _) => q.normalize_or_zero() * self.r_max * (1.0 - 1e-3),
            (Some(r), _) => q.normalize_or_zero() * r,
        };
        self.newton(q, start)
    }

    /// r with r g(r^2) = `rd`.
    fn radial_inverse(&self, rd: f64) -> Option<f64> {
        let f = |r: f64| {
            let (g, dg) = self.gain(r * r);
            (r * g - rd, g + 2.0 * r * r * dg)
        };
        // some r in the range with r g >= rd: the end of it, or doubled until there
        let mut hi = self.r_max;
        if hi == f64::INFINITY {
            hi = rd.max(1.0);
            while f(hi).0 < 0.0 {
                hi *= 2.0;
                if !(hi * hi).is_finite() {
                    return None;
                }
            }
        }
        // at a pole of g the range ends at infinity: any value there that is not under 0 will do
        (f(hi).0 >= 0.0 || f(hi).0.is_nan()).then(|| increasing_root(hi, f))
    }

    /// Solves for the full model, steps halved until the residual falls and the place stays where the model does not fold.
    fn newton(&self, q: DVec2, mut p: DVec2) -> Option<DVec2> {
        let unfolded = |p: DVec2, slope: &DMat2| p.length() < self.r_max && slope.determinant() > 0.0;
        let (mut place, mut slope) = self.distorted(p);
        if !unfolded(p, &slope) {
            p = DVec2::ZERO;
            (place, slope) = self.distorted(p);
        }
        for _ in 0..STEPS {
            let mut step = slope.inverse() * (q - place);
            if !step.is_finite() {
                return None;
            }
            // where rounding alone is left a step need not reduce the residual
            if step.length() <= STEP_ROUNDING * p.length().max(STEP_ROUNDING) {
                return Some(p);
            }
            let residual = (q - place).length();
            loop {
                let next = p + step;
                let (at, by) = self.distorted(next);
                if unfolded(next, &by) && (q - at).length() < residual {
                    (p, place, slope) = (next, at, by);
                    break;
                }
                step /= 2.0;
                if step.length() <= STEP_ROUNDING * p.length().max(STEP_ROUNDING) {
                    return (residual <= RESIDUAL_ROUNDING * (1.0 + q.length())).then_some(p);
                }
            }
        }
        None
    }
}

/// Rounding of [`Brown::distorted`], relative to 1 and the place: some twenty operations of 2^-53 each, 2^-48.
const RESIDUAL_ROUNDING: f64 = 1.0 / (1u64 << 48) as f64;

/// Kannala and Brandt's model, as in OpenCV's `fisheye`: seen at
/// `theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)` from the middle. OpenCV itself sees less than 90
/// degrees from ahead; the formula goes on to 180.
#[derive(Debug, Clone, Copy)]
pub struct KannalaBrandt {
    /// theta_d / theta as a polynomial of theta^2.
    gain: [f64; 5],
    /// theta_d grows from 0 to here, at most pi.
    theta_max: f64,
}

impl KannalaBrandt {
    pub fn new(k: [f64; 4]) -> KannalaBrandt {
        let gain = [1.0, k[0], k[1], k[2], k[3]];
        let slope: Vec<f64> = gain.iter().enumerate().map(|(n, c)| (2 * n + 1) as f64 * c).collect();
        KannalaBrandt { gain, theta_max: roots::first(&slope).sqrt().min(std::f64::consts::PI) }
    }

    /// theta_d and its derivative.
    pub fn distorted(&self, theta: f64) -> (f64, f64) {
        let q = theta * theta;
        let slope = self.gain.iter().enumerate().rev().fold(0.0, |sum, (n, c)| sum * q + (2 * n + 1) as f64 * c);
        (theta * roots::value(&self.gain, q), slope)
    }

    /// The unit direction that is seen at `q`.
    pub fn direction(&self, q: DVec2) -> Option<DVec3> {
        let theta_d = q.length();
        let f = |theta: f64| {
            let (value, slope) = self.distorted(theta);
            (value - theta_d, slope)
        };
        if theta_d == 0.0 {
            return Some(DVec3::Z);
        }
        if f(self.theta_max).0 < 0.0 {
            return None;
        }
        let (sin, cos) = increasing_root(self.theta_max, f).sin_cos();
        Some((q * (sin / theta_d)).extend(cos))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distorted places are found again to f64: the residual in units of [`RESIDUAL_ROUNDING`] is checked by every case.
    #[test]
    fn what_is_distorted_is_undistorted() {
        for k in [
            [0.0; 8],
            [-0.41, 0.507, 0.0, 0.0, -0.578, 0.0, 0.0, 0.0],
            [-0.2, 0.05, 2e-3, -1e-3, 0.0, 0.0, 0.0, 0.0],
            [0.3, 0.1, -4e-3, 2e-3, 0.02, 0.1, 0.05, 0.01],
            // a pole at r = 2
            [0.0, 0.0, 1e-3, 1e-3, 0.0, -0.25, 0.0, 0.0],
        ] {
            let model = Brown::new(k);
            let far = model.r_max.min(1.5);
            for (i, j) in (-20..=20).flat_map(|i| (-20..=20).map(move |j| (i, j))) {
                let p = DVec2::new(f64::from(i), f64::from(j)) / 20.0 * far;
                let (q, slope) = model.distorted(p);
                if p.length() >= 0.97 * far || slope.determinant() <= 0.05 {
                    continue;
                }
                let found = model.undistorted(q).unwrap_or_else(|| panic!("{k:?}: nothing at {q}, seen from {p}"));
                // a residual of RESIDUAL_ROUNDING moves the place by that over the least stretch, determinant over trace
                let room =
                    RESIDUAL_ROUNDING * (1.0 + q.length()) * slope.col(0).length().max(slope.col(1).length()) * 2.0
                        / slope.determinant();
                assert!((found - p).length() <= room, "{k:?}: {found}, not {p}, off {}", (found - p).length());
            }
        }
    }

    #[test]
    fn nothing_is_seen_beyond_the_fold() {
        // r - r^3 is largest at r = 1 / sqrt(3), 2 / (3 sqrt(3)) there
        let barrel = Brown::new([-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert!((barrel.r_max - 3f64.sqrt().recip()).abs() < 1e-15);
        let edge = 2.0 / (3.0 * 3f64.sqrt());
        assert!(barrel.undistorted(DVec2::X * (edge + 1e-9)).is_none());
        let inside = barrel.undistorted(DVec2::X * (edge - 1e-9)).unwrap();
        assert!(inside.x < barrel.r_max && inside.x > barrel.r_max - 1e-4);
        // with a tangential part as well
        let bent = Brown::new([-1.0, 0.0, 1e-3, 1e-3, 0.0, 0.0, 0.0, 0.0]);
        assert!(bent.undistorted(DVec2::X * (edge + 0.1)).is_none());
        // theta - theta^3 / 12 is largest at theta = 2, 4 / 3 there
        let fisheye = KannalaBrandt::new([-1.0 / 12.0, 0.0, 0.0, 0.0]);
        assert!((fisheye.theta_max - 2.0).abs() < 1e-14);
        assert!(fisheye.direction(DVec2::Y * 1.334).is_none() && fisheye.direction(DVec2::Y * 1.333).is_some());
    }

    #[test]
    fn a_fisheye_goes_beyond_90_degrees() {
        let model = KannalaBrandt::new([0.02, -0.003, 0.0, 0.0]);
        for theta in [1e-9, 0.3, 1.0, 1.7, 2.0] {
            let (place, slope) = model.distorted(theta);
            assert!(slope > 0.0);
            let d = model.direction(DVec2::new(0.6, 0.8) * place).unwrap();
            let expected = DVec2::new(0.6, 0.8).extend(0.0) * theta.sin() + DVec3::Z * theta.cos();
            // theta's own rounding over the slope, and the sine's
            assert!((d - expected).length() < 1e-14 * (1.0 + 1.0 / slope), "{theta}: {d}");
        }
    }
}
