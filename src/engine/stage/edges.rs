//! edges: the pixels that hold an edge, whose samples do not all see one triangle; pair by pair, or tile by tile.

use super::{STEPS, Scopes, Stages, dispatch_items, with};
use crate::gpu::Gpu;
use crate::gpu::buffers::Pipeline;
use crate::gpu::layout::{COUNT_PAIRS, LANES};
use crate::input::Result;

/// The steps of the kernel, pair by pair.
const SEEN: usize = 0;
const PAIRS: u32 = 1;
const LIST: usize = 2;

impl Stages {
    /// Pixels that hold an edge have several samples.
    pub fn samples_edges(&self) -> bool {
        self.by_pair.is_some()
    }

    /// What is seen at the centres of `pixels` pixels; for every chunk of the scene.
    pub fn look_for_edges(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, pixels: u32) -> Result<()> {
        let Some([edges, _]) = &self.by_pair else { return Ok(()) };
        self.edges_of(gpu, pass, scopes, edges.get(gpu), (pixels, SEEN))
    }

    /// All pairs of a job, once the whole scene was looked at.
    pub fn edges(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes) -> Result<()> {
        let Some([edges, _]) = &self.by_pair else { return Ok(()) };
        self.dispatch_counted(gpu, pass, scopes, edges.get(gpu), (COUNT_PAIRS, PAIRS))
    }

    /// Lists the pixels that were found, once all pairs have passed.
    pub fn list_edges(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, pixels: u32) -> Result<()> {
        let Some([edges, _]) = &self.by_pair else { return Ok(()) };
        self.edges_of(gpu, pass, scopes, edges.get(gpu), (pixels, LIST))
    }

    /// Finds and lists them at once, of `tiles` tiles that have all pairs of the scene.
    pub fn edges_by_tile(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, tiles: u32) -> Result<()> {
        let Some([edges, ..]) = &self.by_tile else { return Ok(()) };
        self.edges_of(gpu, pass, scopes, edges.get(gpu), (LANES * tiles, SEEN))
    }

    fn edges_of(
        &self,
        gpu: &Gpu,
        pass: &mut wgpu::ComputePass,
        scopes: Scopes,
        kernel: &Pipeline,
        (items, step): (u32, usize),
    ) -> Result<()> {
        let group = kernel.bind_renamed(gpu, &with(scopes, &self.steps), &[("step", STEPS[step])])?;
        pass.set_pipeline(kernel.raw());
        pass.set_bind_group(0, &group, &[]);
        dispatch_items(gpu, pass, items);
        Ok(())
    }
}
