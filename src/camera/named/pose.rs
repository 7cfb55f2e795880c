//! Where a viewer stands and looks: what all cameras with one eye share.

use crate::camera::central::{View, view};
use crate::camera::{Ray, RayMap};
use crate::error::Result;
use crate::scene::file::read_pose;
use crate::scene::file::reader::Table;
use glam::DVec3;

/// The keys `eye`, `target` and `up`; the frame is pinhole's: f = unit(target - eye), r = unit(f x up), u = r x f.
#[derive(Debug, Clone, Copy)]
pub struct Pose {
    pub eye: DVec3,
    pub target: DVec3,
    pub up: DVec3,
}

impl Pose {
    pub fn read(table: &Table) -> Result<Pose> {
        let (eye, target, up) = read_pose(table)?;
        Ok(Pose { eye, target, up })
    }

    /// # Errors
    /// No frame: eye = target, or up along the view direction.
    pub fn view(&self) -> Result<View> {
        view(self.eye, self.target, self.up)
    }
}

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
