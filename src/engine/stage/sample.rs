//! sample: the samples of the pixels that hold an edge against every triangle; pair by pair, or tile by tile, and the recheck of what that leaves uncertain.

use super::{STEPS, Scopes, Stages, with};
use crate::gpu::Gpu;
use crate::gpu::buffers::Later;
use crate::gpu::layout::{COUNT_BLOCKS, COUNT_PAIRS, COUNT_RECHECK_SAMPLES};
use crate::input::Result;

/// Keys go into the rows of samples.
const KEYS: (&str, &str) = ("visibility", "samples");

impl Stages {
    /// Compiles the kernels of edges and samples that are taken, if they are not.
    pub fn compile_samples(&self, gpu: &Gpu, by_tile: bool) {
        let all: [&[Later]; 2] = [
            self.by_tile.as_ref().filter(|_| by_tile).map_or(&[], |k| k),
            self.by_pair.as_ref().filter(|_| !by_tile).map_or(&[], |k| k),
        ];
        for kernel in all.into_iter().flatten() {
            kernel.get(gpu);
        }
    }

    /// The words of a key go in the steps of [`Stages::raster`].
    pub fn sample(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, step: u32) -> Result<()> {
        let Some([_, sample]) = &self.by_pair else { return Ok(()) };
        let sample = sample.get(gpu);
        self.lay_out(gpu, pass, scopes, COUNT_PAIRS)?;
        let group = sample.bind_renamed(gpu, &with(scopes, &self.steps), &[("step", STEPS[step as usize]), KEYS])?;
        self.dispatch_laid_out(pass, scopes, sample, &group);
        Ok(())
    }

    /// What [`Stages::edges_by_tile`] has listed.
    pub fn sample_by_tile(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes) -> Result<()> {
        let Some([_, sample, recheck]) = &self.by_tile else { return Ok(()) };
        let recheck = recheck.get(gpu);
        self.dispatch_counted(gpu, pass, scopes, sample.get(gpu), (COUNT_BLOCKS, 0))?;
        self.lay_out(gpu, pass, scopes, COUNT_RECHECK_SAMPLES)?;
        let group = recheck.bind_renamed(gpu, &with(scopes, &self.steps), &[("step", STEPS[0]), KEYS])?;
        self.dispatch_laid_out(pass, scopes, recheck, &group);
        Ok(())
    }
}
