//! sort: the pairs that bin has found, those of a tile side by side, where raster goes tile by tile.

use super::{Dispatch, KernelId};
use crate::gpu::layout::Counter;

/// Of `tiles` tiles, of variants that are `by_tile`.
pub fn sort(tiles: u32) -> [Dispatch; 2] {
    [Dispatch::over(KernelId::Allot, tiles), Dispatch::counted(KernelId::Sort, Counter::Pairs)]
}
