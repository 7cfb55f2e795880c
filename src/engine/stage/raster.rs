//! raster: every (triangle, tile) pair, pixel by pixel, into the visibility buffer; pair by pair, or tile by tile.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::Variant;
use crate::gpu::layout::Counter;

/// Number of dispatches of `raster` over all pairs: without 64-bit atomics the words of a key go one after the other.
pub fn raster_steps(variant: Variant) -> u32 {
    if variant.path.atomics64 { 1 } else { 2 }
}

/// Tile by tile, `rounds` times: each takes up what the one before has left.
pub fn raster(variant: Variant, step: u32, rounds: u32) -> Vec<Dispatch> {
    let (counter, rounds) = if variant.by_tile() { (Counter::Busy, rounds) } else { (Counter::Pairs, 1) };
    vec![Dispatch::counted(KernelId::Raster, counter).nth(step); rounds as usize]
}
