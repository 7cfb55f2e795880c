//! Calibrated lenses and their exact inverses: from the place on the plane to the ray, and back.
//!
//! OpenCV's own frame: x right, y down, z forward.

use super::branches::Distortion;
use crate::camera::calibration::{Model, Projection};
use glam::{DVec2, DVec3};

/// A model prepared for inversion.
#[derive(Debug, Clone, PartialEq)]
pub struct Lens {
    projection: Projection,
    /// Of the projection's polynomial; see [`Projection::end`].
    end: f64,
    distortions: Vec<Distortion>,
}

impl Lens {
    /// # Errors
    /// See [`Projection::check`] and [`Distortion::new`].
    pub fn new(model: &Model) -> Result<Lens, String> {
        model.projection.check()?;
        let distortions = model.distortions.iter().map(Distortion::new).collect::<Result<_, _>>()?;
        Ok(Lens { projection: model.projection.clone(), end: model.projection.end(), distortions })
    }

    /// The direction that is seen at `q`, a place of the plane after all distortions; `None`: the branch of the middle does not reach
    /// there.
    pub fn direction(&self, q: DVec2) -> Option<DVec3> {
        let p = self.distortions.iter().rev().try_fold(q, |q, distortion| distortion.undistorted(q))?;
        self.projection.direction(p, self.end)
    }

    /// Where the direction `v`, of any length over 0, is seen.
    fn place(&self, v: DVec3) -> Option<DVec2> {
        let p = self.projection.place(v, self.end)?;
        self.distortions.iter().try_fold(p, |p, distortion| distortion.distorted(p))
    }

    /// All places at which the point `v` is seen, each with its t; `None` if there are infinitely many.
    pub fn places(&self, v: DVec3) -> Option<Vec<(DVec2, f64)>> {
        if v == DVec3::ZERO || self.projection.is_on_curve(v) {
            return None;
        }
        // ahead of the eye, and behind it at negative t
        let t = if self.projection.is_plane() { v.z.abs() } else { v.length() };
        Some([(v, t), (-v, -t)].into_iter().filter_map(|(v, t)| Some((self.place(v)?, t))).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_fisheye_sees_beyond_the_fold() {
        // theta - theta^3 / 12 is largest at theta = 2, 4 / 3 there
        let fisheye = Lens::new(&Model::fisheye(&[-1.0 / 12.0])).unwrap();
        assert!(fisheye.direction(DVec2::Y * 1.334).is_none() && fisheye.direction(DVec2::Y * 1.333).is_some());
        let at = |theta: f64| fisheye.place(DVec3::new(0.0, theta.sin(), theta.cos()));
        assert!(at(1.999).is_some() && at(2.001).is_none());
    }

    #[test]
    fn a_fisheye_goes_beyond_90_degrees() {
        let k = [0.02, -0.003];
        let lens = Lens::new(&Model::fisheye(&k)).unwrap();
        for theta in [1e-9, 0.3, 1.0, 1.7, 2.0] {
            let q = theta * theta;
            let (place, slope) = (theta * (1.0 + q * (k[0] + q * k[1])), 1.0 + q * (3.0 * k[0] + q * 5.0 * k[1]));
            assert!(slope > 0.0);
            let across = DVec2::new(0.6, 0.8);
            let d = lens.direction(across * place).unwrap();
            let expected = (across * theta.sin()).extend(theta.cos());
            // theta's own rounding over the slope, and the sine's
            assert!((d - expected).length() < 1e-14 * (1.0 + 1.0 / slope), "{theta}: {d}");
            let found = lens.place(3.0 * expected).unwrap();
            assert!((found - across * place).length() < 1e-14 * slope.max(1.0), "{theta}");
        }
    }
}
