//! The fisheye model.

use super::roots;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Kannala and Brandt's model, as in OpenCV's `fisheye` module. A direction at angle theta from the axis is seen at radius
/// `theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)`. OpenCV itself
/// stops before 90 degrees; here theta goes up to 180.
#[derive(Debug, Clone, Copy, PartialEq)]
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
        KannalaBrandt { gain, theta_max: roots::first(&slope).sqrt().min(PI) }
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
        let (sin, cos) = roots::in_bracket(theta_d, self.theta_max, f).sin_cos();
        Some((q * (sin / theta_d)).extend(cos))
    }

    /// Where the direction `v`, of any length over 0, is seen.
    pub fn place(&self, v: DVec3) -> Option<DVec2> {
        let (across, theta) = (v.truncate(), v.truncate().length().atan2(v.z));
        (theta < self.theta_max).then(|| across.normalize_or_zero() * self.distorted(theta).0)
    }

    /// `v` is on the axis, and the point straight behind the eye is seen on a whole circle.
    pub fn is_on_circle(&self, v: DVec3) -> bool {
        self.theta_max == PI && v.truncate().length() <= STRAIGHT * v.length()
    }
}

/// Sine of the largest angle at which a direction counts as on the axis: 2^-40, as for other degenerate images in projection.
const STRAIGHT: f64 = 1.0 / (1u64 << 40) as f64;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_seen_beyond_the_fold() {
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
            assert!(
                (model.place(3.0 * expected).unwrap() - DVec2::new(0.6, 0.8) * place).length() < 1e-14 * slope.max(1.0),
                "{theta}"
            );
        }
    }
}
