//! The pieces of a camera as draws see them: rows that are on the device anyway, and their outlines in the image.

use super::Setup;
use super::rows::Outline;
use crate::camera::Rays;
use crate::camera::pieces::Piece;
use crate::error::{Error, Result};
use crate::gpu::Gpu;
use crate::gpu::buffers::Buffers;

/// All pieces of the camera, by their number, and their layers.
///
/// # Errors
/// [`Error::Input`] where a layer is no pieces.
pub fn pieces<'a>(setup: &Setup<'a>) -> Result<Vec<(u32, &'a Piece)>> {
    let mut all = Vec::new();
    for (layer, rays) in setup.camera.layers.iter().enumerate() {
        let Rays::Pieces(pieces) = rays else {
            let kind = setup.camera.kind;
            return Err(Error::input(format!("{kind} is no camera of pieces; give it pieces = N, or use raytrace")));
        };
        all.extend(pieces.pieces.iter().map(|p| (layer as u32, p)));
    }
    Ok(all)
}

/// `outlines`: a row for each piece.
pub fn outlines(gpu: &Gpu, setup: &Setup) -> Result<Buffers> {
    let (w, h) = (setup.camera.width as f32, setup.camera.height as f32);
    let row = |(layer, piece): &(u32, &Piece)| {
        let corners = piece.corners_px.map(|c| c.map(|q| q.as_vec2().to_array()));
        let [a, b, c] = corners.unwrap_or([[0.0, 0.0], [2.0 * w, 0.0], [0.0, 2.0 * h]]);
        Outline { a, b, c, is_whole: u32::from(corners.is_none()), layer: *layer }
    };
    let mut buffers = Buffers::default();
    buffers.upload(gpu, "outlines", &pieces(setup)?.iter().map(row).collect::<Vec<_>>())?;
    Ok(buffers)
}
