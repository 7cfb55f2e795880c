//! edges: the edge pixels, whose samples do not all see one triangle; pair by pair, or tile by tile.

use super::{Dispatch, KernelId};
use crate::gpu::layout::{self, Counter};

/// The steps of the kernel, pair by pair.
const SEEN: u32 = 0;
const PAIRS: u32 = 1;
const LIST: u32 = 2;

/// What is seen at the centres of `pixels` pixels; for every chunk of the scene.
pub fn find_edges(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Edges, pixels).nth(SEEN)
}

/// All pairs of a job, once the whole scene was looked at.
pub fn edges() -> Dispatch {
    Dispatch::counted(KernelId::Edges, Counter::Pairs).nth(PAIRS)
}

/// Lists the pixels that were found, once all pairs are processed.
pub fn list_edges(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Edges, pixels).nth(LIST)
}

/// Finds and lists them at once, of `tiles` tiles that have all pairs of the scene.
pub fn edges_by_tile(tiles: u32) -> Dispatch {
    Dispatch::over(KernelId::EdgesByTile, layout::LANES * tiles)
}
