//! Cameras with one eye: rays from directions in the viewer's frame.

pub use crate::camera::pose::{KEYS as POSE, Pose};
use crate::camera::view::View;
use crate::camera::{Ray, RayMap};
use glam::DVec3;

/// A direction for every image place, in a viewer's frame.
pub trait Lens: std::fmt::Debug + Send + Sync {
    /// To the right, up and forward at image coordinates (a, b); `None`: no ray.
    fn direction(&self, a: f64, b: f64) -> Option<DVec3>;
}

/// All rays start in one eye.
#[derive(Debug)]
pub struct Central<L> {
    pub eye: DVec3,
    pub view: View,
    pub lens: L,
}

impl<L: Lens> RayMap for Central<L> {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        let d = self.lens.direction(a, b)?;
        Some(Ray { origin: self.eye, direction: self.view.vector(d.x, d.y, d.z) })
    }
}
