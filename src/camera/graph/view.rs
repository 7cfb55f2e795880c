//! A pinhole view that lands somewhere in the image.

use super::super::bundle::{Bundle, Ray};
use super::super::kinds::pinhole;
use super::super::pieces::{Piece, Pieces};
use super::super::pose::Pose;
use crate::input::Result;
use crate::input::reader::Table;
use glam::{DVec2, DVec3};

/// A pinhole camera as a scene file gives it; `vfov` in degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pinhole {
    pub pose: Pose,
    pub vfov: f64,
}

impl Pinhole {
    /// Reads the keys of a pose, and `vfov`.
    pub fn read(table: &Table) -> Result<Pinhole> {
        Ok(Pinhole { pose: Pose::read(table)?, vfov: table.need("vfov", "40")?.number()? })
    }
}

/// The rays of a pinhole over the image: those of the plain camera of its pose at pixels `centre_px` from its middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    bundle: Bundle,
    centre_px: DVec2,
}

impl View {
    /// `vfov` spans `height` pixels; the view's axis is at `centre_px`.
    pub fn new(pinhole: &Pinhole, height: u32, centre_px: DVec2) -> Result<View> {
        Ok(View { bundle: pinhole::bundle(&pinhole.pose, pinhole.vfov, height)?, centre_px })
    }

    /// All of the view as a camera of one piece.
    pub fn whole(&self, (width, height): (u32, u32)) -> Pieces {
        let piece = Piece { bundle: self.bundle, centre_px: self.centre_px, corners_px: None };
        Pieces::new(vec![piece], width, height)
    }

    pub fn eye(&self) -> DVec3 {
        self.bundle.p[0]
    }

    /// Unit axis of the view.
    pub fn forward(&self) -> DVec3 {
        self.bundle.d[0]
    }

    /// The ray at an image place; t is the depth along the axis.
    pub fn ray(&self, place_px: DVec2) -> Ray {
        let at = place_px - self.centre_px;
        self.bundle.ray(at.x, at.y)
    }

    /// The point of the ray at an image place on the plane `depth` before the eye.
    pub fn point(&self, place_px: DVec2, depth: f64) -> DVec3 {
        let ray = self.ray(place_px);
        ray.origin + depth * ray.direction
    }

    /// Right and down in the picture: how a ray moves at depth 1 from one pixel to the next.
    pub fn steps(&self) -> [DVec3; 2] {
        [self.bundle.d[1], self.bundle.d[2]]
    }

    pub fn depth(&self, point: DVec3) -> f64 {
        (point - self.eye()).dot(self.forward())
    }

    /// The image place of a point; `None` behind the eye.
    pub fn place(&self, point: DVec3) -> Option<DVec2> {
        let (v, depth) = (point - self.eye(), self.depth(point));
        let [right, down] = self.steps();
        let along = |step: DVec3| v.dot(step) / (step.length_squared() * depth);
        (depth > 0.0).then(|| self.centre_px + DVec2::new(along(right), along(down)))
    }
}

/// A depth beyond the whole scene from every one of the eyes: twice the distance to its farthest corner, so that rays
/// that turn between two views pass it too; `otherwise` in an empty scene. `scene` are the corners of the box around it.
pub fn beyond(scene: Option<(DVec3, DVec3)>, eyes: &[DVec3], otherwise: f64) -> f64 {
    let Some((lo, hi)) = scene else { return otherwise };
    let farthest = eyes.iter().map(|eye| (*eye - lo).abs().max((hi - *eye).abs()).length()).fold(0.0, f64::max);
    if farthest > 0.0 { 2.0 * farthest } else { otherwise }
}
