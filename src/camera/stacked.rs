//! The images of several cameras, one below another, as the image of one camera: many small images then take one frame.

use super::field::Field;
use super::pieces::Pieces;
use super::ray_order::is_incoherent;
use super::{Camera, Rays, TILE};
use std::sync::Arc;

/// Cameras whose images are one.
#[derive(Debug, Clone)]
pub struct Stacked {
    pub camera: Arc<Camera>,
    /// Rows from the top of an image to that of the next: at least those of an image, and whole tiles.
    pub step: u32,
}

/// Whether the images of cameras can be one; `Err`: why not.
pub fn can_stack(cameras: &[Arc<Camera>]) -> Result<(), &'static str> {
    let is_field = |camera: &Camera| matches!(camera.layers.as_slice(), [Rays::Field(_)]);
    let refused = |camera: &Arc<Camera>| match camera.layers.as_slice() {
        _ if (camera.width, camera.height) != (cameras[0].width, cameras[0].height) => {
            Some("the images differ in size")
        }
        _ if camera.optics.is_some() => Some("a camera looks at a mirror or lens"),
        _ if camera.composition.is_some() => Some("a camera is a composite"),
        _ if camera.moving.is_some() => Some("a camera moves while an image is taken"),
        [Rays::Curves(_)] => Some("the rays of a camera are curved"),
        [] | [_, _, ..] => Some("a camera has several layers of rays"),
        _ if camera.t_range != cameras[0].t_range => Some("the cameras differ in their range of t"),
        _ if is_field(camera) != is_field(&cameras[0]) => Some("some cameras have pieces, some a ray for each pixel"),
        _ if is_incoherent(camera) => Some("rays of neighbouring pixels of a camera are unrelated"),
        _ => None,
    };
    cameras.iter().find_map(refused).map_or(Ok(()), Err)
}

/// The images of cameras, one at least, which can be stacked.
pub fn stack(cameras: &[Arc<Camera>]) -> Stacked {
    let first = &cameras[0];
    let (mut pieces, mut fields) = (Vec::new(), Vec::new());
    for rays in cameras.iter().flat_map(|camera| &camera.layers) {
        match rays {
            Rays::Pieces(own) => pieces.push(own.clone()),
            Rays::Field(own) => fields.push(own.clone()),
            Rays::Curves(_) => {}
        }
    }
    let (rays, step) = if fields.is_empty() {
        let step = first.height.next_multiple_of(TILE);
        (Rays::Pieces(Pieces::stacked(pieces, first.height, step)), step)
    } else {
        // one row that extends the image for the slopes of its last, and one without rays above the next
        let step = (first.height + 2).next_multiple_of(TILE);
        (Rays::Field(Field::stacked(fields, step)), step)
    };
    let height = step * cameras.len() as u32;
    Stacked { camera: Arc::new(Camera::of(first.kind, (first.width, height), first.t_range, rays)), step }
}
