//! The images of several cameras, one below another, as the image of one camera: many small images then take one frame.

use super::field::Field;
use super::pieces::Pieces;
use super::{Camera, Rays, TILE};
use std::sync::Arc;

/// Images of one size, one below another. Between them are rows of pixels without rays.
#[derive(Debug, Clone)]
pub(super) struct Stack<T> {
    pub images: Vec<T>,
    /// Rows from the top of an image to that of the next.
    pub step: u32,
}

impl<T> Stack<T> {
    /// The number of the image that row `j` belongs to, or lies below, and the row's number there.
    pub fn at(&self, j: u32) -> (usize, u32) {
        ((j / self.step) as usize, j % self.step)
    }
}

/// Cameras whose images are one.
#[derive(Debug, Clone)]
pub struct Stacked {
    pub camera: Arc<Camera>,
    /// Rows from the top of an image to that of the next: at least those of an image, and whole tiles.
    pub step: u32,
}

/// Stacks the images of cameras; `Err`: why they cannot be one.
pub fn stack(cameras: &[Arc<Camera>]) -> Result<Stacked, &'static str> {
    let Some(first) = cameras.first() else { return Err("there is no camera") };
    let size = |camera: &Camera| (camera.width, camera.height);
    if cameras.iter().any(|camera| size(camera) != size(first)) {
        return Err("the images differ in size");
    }
    if cameras.iter().any(|camera| camera.optics.is_some()) {
        return Err("a camera looks at a mirror or lens");
    }
    if cameras.iter().any(|camera| camera.t_range != first.t_range) {
        return Err("the cameras differ in their range of t");
    }
    let (mut pieces, mut fields) = (Vec::new(), Vec::new());
    for camera in cameras {
        match camera.layers.as_slice() {
            [Rays::Pieces(own)] => pieces.push(own.clone()),
            [Rays::Field(own)] => fields.push(own.clone()),
            [Rays::Curves(_)] => return Err("the rays of a camera are curved"),
            _ => return Err("a camera has several layers of rays"),
        }
    }
    let (rays, step) = match (pieces.is_empty(), fields.is_empty()) {
        (false, true) => {
            let step = first.height.next_multiple_of(TILE);
            (Rays::Pieces(Pieces::stacked(pieces, first.height, step)), step)
        }
        (true, false) => {
            // one row that extends the image for the slopes of its last, and one without rays above the next
            let step = (first.height + 2).next_multiple_of(TILE);
            (Rays::Field(Field::stacked(fields, step)), step)
        }
        _ => return Err("some cameras have pieces, some a ray for each pixel"),
    };
    let height = step * cameras.len() as u32;
    let camera = Camera {
        unfulfilled: cameras.iter().flat_map(|camera| camera.unfulfilled.iter().cloned()).collect(),
        ..Camera::of(first.kind, (first.width, height), first.t_range, rays)
    };
    Ok(Stacked { camera: Arc::new(camera), step })
}
