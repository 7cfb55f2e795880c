//! Distortion models and their exact inverses: from the distorted place on the plane z = 1 to the ray, and back.
//!
//! OpenCV's own frame: x right, y down, z forward.

use super::brown::Brown;
use super::kannala_brandt::KannalaBrandt;
use glam::{DVec2, DVec3};

/// A model and its coefficients, in the file's order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Model {
    /// `k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, tau_x, tau_y`; angles in radians.
    Brown([f64; 14]),
    /// `k1, k2, k3, k4`.
    Fisheye([f64; 4]),
}

/// A model prepared for inversion.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "a camera has one")]
pub enum Distortion {
    Brown(Brown),
    Fisheye(KannalaBrandt),
}

impl Distortion {
    /// # Errors
    /// See [`Brown::new`].
    pub fn new(model: &Model) -> Result<Distortion, String> {
        Ok(match model {
            Model::Brown(k) => Distortion::Brown(Brown::new(*k)?),
            Model::Fisheye(k) => Distortion::Fisheye(KannalaBrandt::new(*k)),
        })
    }

    /// The direction that is seen at the place `q` = ((u - cx) / fx, (v - cy) / fy); `None`: the branch of the middle does not
    /// reach there.
    pub fn direction(&self, q: DVec2) -> Option<DVec3> {
        match self {
            Distortion::Brown(model) => Some(model.undistorted(q)?.extend(1.0)),
            Distortion::Fisheye(model) => model.direction(q),
        }
    }

    /// All places at which the point `v` is seen, each with its t; `None` if there are infinitely many.
    pub fn places(&self, v: DVec3) -> Option<Vec<(DVec2, f64)>> {
        match self {
            _ if v == DVec3::ZERO => None,
            Distortion::Brown(model) => {
                let on_plane = Some(v.truncate() / v.z).filter(|p| p.is_finite());
                Some(on_plane.and_then(|p| model.distorted(p)).map(|q| (q, v.z)).into_iter().collect())
            }
            Distortion::Fisheye(model) if model.is_on_circle(v) => None,
            Distortion::Fisheye(model) => {
                // ahead of the eye, and behind it at negative t
                let both = [(v, v.length()), (-v, -v.length())];
                Some(both.into_iter().filter_map(|(v, t)| Some((model.place(v)?, t))).collect())
            }
        }
    }
}
