//! sort: the pairs that bin has found, those of a tile side by side, where raster goes tile by tile.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::parts::*;
use crate::gpu::layout::Counter;

/// Runs of the tiles in the sorted list of pairs.
pub fn allot_kernel() -> Kernel {
    let bindings = vec![
        params(),
        writes("starts", "array<u32>"),
        writes("ends", "array<u32>"),
        writes("busy", "array<u32>"),
        counters(),
    ];
    Kernel::new("allot", bindings, &[PARAMS, ITEMS, snippets!("allot.wgsl")])
}

pub fn kernel() -> Kernel {
    let bindings = vec![
        params(),
        reads("unsorted", "array<vec2<u32>>"),
        reads("ranks", "array<u32>"),
        reads("starts", "array<u32>"),
        writes("pairs", "array<vec2<u32>>"),
        counters(),
    ];
    Kernel::new("sort", bindings, &[PARAMS, ITEMS, PAIR, snippets!("sort.wgsl")])
}

/// Of `tiles` tiles, of variants that are `by_tile`.
pub fn sort(tiles: u32) -> [Dispatch; 2] {
    [Dispatch::over(KernelId::Allot, tiles), Dispatch::counted(KernelId::Sort, Counter::Pairs)]
}
