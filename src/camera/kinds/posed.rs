//! Cameras that are a lens at a pose.

pub use crate::camera::lens::{Lens, Viewer, is_same};
pub use crate::camera::pose::{KEYS as POSE, Pose};
use crate::camera::view::View;
use crate::camera::{Ray, RayMap};
use glam::DVec3;
use std::sync::Arc;

/// A lens at a pose.
#[derive(Debug)]
pub struct Posed<L> {
    pub eye: DVec3,
    pub view: View,
    pub lens: L,
}

impl<L: Lens + Clone> RayMap for Posed<L> {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        let direction = self.lens.direction(a, b)?;
        Some(self.view.ray(self.eye, Ray { origin: self.lens.origin(a, b), direction }))
    }

    fn viewer(&self) -> Option<Viewer> {
        Some(Viewer { eye: self.eye, view: self.view, lens: Arc::new(self.lens.clone()) })
    }
}
