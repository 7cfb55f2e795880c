//! raster: every (triangle, tile) pair, pixel by pixel, into the visibility buffer; pair by pair, or tile by tile.

use super::{Scopes, Stages};
use crate::gpu::Gpu;
use crate::gpu::layout::{COUNT_BUSY, COUNT_PAIRS};
use crate::input::Result;

impl Stages {
    /// How many times all pairs must pass `raster`: without 64-bit atomics the words of a key go one after the other.
    pub fn raster_steps(&self) -> u32 {
        if self.variant.atomics64 { 1 } else { 2 }
    }

    /// Tile by tile, `rounds` times: each takes up what the one before has left.
    pub fn raster(
        &self,
        gpu: &Gpu,
        pass: &mut wgpu::ComputePass,
        scopes: Scopes,
        step: u32,
        rounds: u32,
    ) -> Result<()> {
        if self.variant.by_tile {
            let round = |_| self.dispatch_counted(gpu, pass, scopes, &self.raster, (COUNT_BUSY, step));
            return (0..rounds).try_for_each(round);
        }
        self.dispatch_counted(gpu, pass, scopes, &self.raster, (COUNT_PAIRS, step))
    }
}
