//! The frame of a viewer: forward, right and up.

use crate::camera::Ray;
use crate::input::{Error, Result};
use glam::DVec3;

/// A view frame: forward, right and image-up unit vectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    pub forward: DVec3,
    pub right: DVec3,
    pub up: DVec3,
}

impl View {
    /// The frame in which vectors are their components to the right, up and forward. It mirrors the world's handedness, which rays and bounds on
    /// them do not notice.
    pub const UNTURNED: View = View { forward: DVec3::Z, right: DVec3::X, up: DVec3::Y };

    /// The vector with these components to the right, up and forward.
    #[inline]
    pub fn vector(&self, right: f64, up: f64, forward: f64) -> DVec3 {
        right * self.right + up * self.up + forward * self.forward
    }

    /// Transforms a ray from the frame of a viewer at `eye` to the world.
    #[inline]
    pub fn ray(&self, eye: DVec3, Ray { origin: p, direction: d }: Ray) -> Ray {
        Ray { origin: eye + self.vector(p.x, p.y, p.z), direction: self.vector(d.x, d.y, d.z) }
    }
}

/// Sine of the smallest angle between `up` and the view direction that still fixes the picture's
/// upright: below it the f64 rounding of `f x up` (2^-52) turns the picture by more than 2^-20 rad.
pub(crate) const UP_SINE_MIN: f64 = 1.0 / (1u64 << 32) as f64;

/// The frame of a viewer at `eye` who looks at `target`.
pub(crate) fn view(eye: DVec3, target: DVec3, up: DVec3) -> Result<View> {
    let forward = (target - eye).try_normalize().ok_or_else(|| {
        let what = match eye == target {
            true => "are the same point",
            // the square of their distance overflows, or underflows to 0
            false if (target - eye).length() > 1.0 => "are too far apart",
            false => "are too close together",
        };
        Error::input(format!("camera: eye and target {what}; move one of them"))
    })?;
    let up = up.try_normalize().ok_or_else(|| Error::input("camera: up is zero; give a direction"))?;
    let right = forward.cross(up);
    if right.length() < UP_SINE_MIN {
        return Err(Error::input("camera: up is parallel to the view direction; give another up"));
    }
    let right = right.normalize();
    Ok(View { forward, right, up: right.cross(forward) })
}
