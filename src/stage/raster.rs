//! raster: every (triangle, cell) pair, pixel by pixel, into the visibility buffer.

use super::{Scopes, Stages};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::gpu::rows::COUNT_PAIRS;

impl Stages {
    /// How many times all pairs must pass `raster`: without 64-bit atomics the words of a key go one after the other.
    pub fn raster_steps(&self) -> u32 {
        if self.variant.atomics64 { 1 } else { 2 }
    }

    pub fn raster(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, step: u32) -> Result<()> {
        self.dispatch_counted(gpu, pass, scopes, &self.raster, (COUNT_PAIRS, step))
    }
}
