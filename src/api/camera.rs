//! Cameras, and where they show points.

use crate::camera::project::{Images, Projector};
use crate::image::frame::Channel;
use glam::DVec3;
use rayon::prelude::*;
use std::sync::Arc;

/// A camera for one size of image: a ray or a curve for each pixel, or for some. `docs/reference/cameras.md` has the kinds.
#[derive(Debug, Clone)]
pub struct Camera {
    pub(super) camera: Arc<crate::camera::Camera>,
}

impl Camera {
    /// Its kind, as in a scene file.
    pub fn kind(&self) -> &str {
        self.camera.kind
    }

    /// Pixels.
    pub fn width(&self) -> u32 {
        self.camera.width
    }

    /// Pixels.
    pub fn height(&self) -> u32 {
        self.camera.height
    }

    /// How many pieces (general linear cameras, or pieces of curves) its image is cut into; 0 where each pixel has a ray of its own.
    pub fn piece_count(&self) -> usize {
        self.camera.piece_count()
    }

    /// The channels that say something about its pictures: [`RenderOptions::channels`](super::RenderOptions::channels) may have these.
    pub fn channels(&self) -> Vec<Channel> {
        self.camera.channels()
    }

    /// Origin P and direction D, world axes and units, of the ray `P + t D` through the centre of a pixel, row 0 on top; the chord of a
    /// curved ray. `None` where the pixel has none, or lies outside.
    pub fn ray(&self, column: u32, row: u32) -> Option<[[f64; 3]; 2]> {
        if column >= self.camera.width || row >= self.camera.height {
            return None;
        }
        self.camera.ray(column, row).map(|ray| [ray.origin.to_array(), ray.direction.to_array()])
    }
}

/// All images of each point (world units): every place whose ray, or curve, passes through it.
pub fn project(camera: &Camera, points: &[[f64; 3]]) -> Vec<Images> {
    let projector = Projector::new(&camera.camera);
    points.par_iter().map(|point| projector.project(DVec3::from_array(*point))).collect()
}
