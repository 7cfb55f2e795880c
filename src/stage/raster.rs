//! raster: every (triangle, cell) pair, pixel by pixel, into the visibility buffer.

use super::{STEPS, Scopes, Stages, with};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::gpu::rows::COUNT_PAIRS;

impl Stages {
    /// How many times all pairs must pass `raster`: without 64-bit atomics the words of a key go one after the other.
    pub fn raster_steps(&self) -> u32 {
        if self.variant.atomics64 { 1 } else { 2 }
    }

    pub fn raster(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, step: u32) -> Result<()> {
        self.lay_out(gpu, pass, scopes, COUNT_PAIRS)?;
        let all = with(scopes, &self.steps);
        let group = self.raster.bind_renamed(gpu, &all, &[("step", STEPS[step as usize])])?;
        pass.set_pipeline(&self.raster.pipeline);
        pass.set_bind_group(0, &group, &[]);
        if let Some(indirect) = scopes.iter().find_map(|s| s.get("indirect")) {
            pass.dispatch_workgroups_indirect(indirect, 0);
        }
        Ok(())
    }
}
