//! Cameras, and projection of points.

use crate::camera::project::{Images, Projector};
use crate::image::frame::Channel;
use glam::DVec3;
use rayon::prelude::*;
use std::sync::Arc;

/// A camera for an image of one size: each pixel has a ray, a curve, or none. `docs/reference/cameras.md` lists the kinds.
#[derive(Debug, Clone)]
pub struct Camera {
    pub(super) camera: Arc<crate::camera::Camera>,
}

impl Camera {
    /// The `kind` key of a scene file.
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

    /// Number of pieces (general linear cameras, or pieces of curves) of its image; 0 if each pixel has its own ray.
    pub fn piece_count(&self) -> usize {
        self.camera.piece_count()
    }

    /// The channels of its images, for [`RenderOptions::channels`](super::RenderOptions::channels).
    pub fn channels(&self) -> Vec<Channel> {
        self.camera.channels()
    }

    /// Origin P and direction D of the ray `P + t D` through the centre of pixel (column, row), row 0 on top, in world axes and units; for
    /// a curved ray its chord. `None` if the pixel has no ray or lies outside the image.
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
