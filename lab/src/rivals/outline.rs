//! The pieces of a camera as draws see them.

use super::layout::Outline;
use anamorph::internals::camera::Rays;
use anamorph::internals::camera::pieces::{Piece, Pieces};
use anamorph::internals::engine::plan::tiles::packed_piece;
use anamorph::internals::engine::rival::Setup;
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::buffers::Buffers;
use anamorph::internals::gpu::layout;
use anamorph::internals::input::{Error, Result};

/// All pieces of the camera, by their number, each with its layer and its own number there.
///
/// # Errors
/// [`Error::Input`] where a layer is no pieces.
pub fn pieces<'a>(setup: &Setup<'a>) -> Result<Vec<(u32, &'a Pieces, u32)>> {
    let mut all = Vec::new();
    for (layer, rays) in setup.camera.layers.iter().enumerate() {
        let Rays::Pieces(pieces) = rays else {
            let kind = setup.camera.kind;
            return Err(Error::input(format!("{kind} is no camera of pieces; give it pieces = N, or use raytrace")));
        };
        all.extend((0..pieces.pieces.len() as u32).map(|k| (layer as u32, pieces, k)));
    }
    Ok(all)
}

/// Puts `pieces` and `outlines` in `buffers`: one of each for every piece, 192 and 32 bytes; returns how many. Origins of pieces
/// are pixels of the image.
pub fn upload(gpu: &Gpu, setup: &Setup, buffers: &mut Buffers) -> Result<u32> {
    let all = pieces(setup)?;
    let order: Vec<u32> = (0..all.len() as u32).collect();
    upload_in_order(gpu, setup, (&all, &order), buffers)?;
    Ok(all.len() as u32)
}

/// The same, `pieces` in this order; `outlines` are by number.
pub fn upload_in_order(
    gpu: &Gpu,
    setup: &Setup,
    (all, order): (&[(u32, &Pieces, u32)], &[u32]),
    buffers: &mut Buffers,
) -> Result<()> {
    let (w, h) = (setup.camera.width, setup.camera.height);
    let outline = |(layer, pieces, k): &(u32, &Pieces, u32)| {
        let corners = pieces.pieces[*k as usize].corners_px.map(|c| c.map(|q| q.as_vec2().to_array()));
        let [a, b, c] = corners.unwrap_or([[0.0, 0.0], [2.0 * w as f32, 0.0], [0.0, 2.0 * h as f32]]);
        Outline { a, b, c, is_whole: u32::from(corners.is_none()), layer: *layer }
    };
    let piece = |&number: &u32| -> layout::Piece {
        let (_, pieces, k) = all[number as usize];
        let Piece { centre_px, .. } = &pieces.pieces[k as usize];
        // far from an eye or not, a piece is about a pixel of its own
        let (i, j) = ((centre_px.x.max(0.0) as u32).min(w - 1), (centre_px.y.max(0.0) as u32).min(h - 1));
        packed_piece(&pieces.bundle_at(k, i, j), setup.anchor, [i as f32, j as f32], number)
    };
    buffers.upload(gpu, "outlines", &all.iter().map(outline).collect::<Vec<_>>())?;
    buffers.upload_texels(gpu, "pieces", &order.iter().map(piece).collect::<Vec<_>>())
}
