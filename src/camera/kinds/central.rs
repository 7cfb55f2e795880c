//! Cameras with one eye: rays from directions in the viewer's frame.

pub use crate::camera::directions::{Lens, Viewer, is_same};
pub use crate::camera::pose::{KEYS as POSE, Pose};
use crate::camera::view::View;
use crate::camera::{Ray, RayMap};
use glam::DVec3;
use std::sync::Arc;

/// All rays start in one eye.
#[derive(Debug)]
pub struct Central<L> {
    pub eye: DVec3,
    pub view: View,
    pub lens: L,
}

impl<L: Lens + Clone> RayMap for Central<L> {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        let d = self.lens.direction(a, b)?;
        Some(Ray { origin: self.eye, direction: self.view.vector(d.x, d.y, d.z) })
    }

    fn viewer(&self) -> Option<Viewer> {
        Some(Viewer { eye: self.eye, view: self.view, lens: Arc::new(self.lens.clone()) })
    }
}
