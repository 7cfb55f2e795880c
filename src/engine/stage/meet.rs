//! meet: smooth surfaces into the visibility buffer, once a pixel.

use super::{STEPS, Scopes, Stages, dispatch_items, with};
use crate::gpu::Gpu;
use crate::input::Result;

impl Stages {
    /// The optics are a smooth surface.
    pub fn meets(&self) -> bool {
        self.meet.is_some()
    }

    /// The words of a key go in the steps of [`Stages::raster`].
    pub fn meet(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, pixels: u32, step: u32) -> Result<()> {
        let Some(meet) = &self.meet else { return Ok(()) };
        let all = with(scopes, &self.steps);
        let group = meet.bind_renamed(gpu, &all, &[("step", STEPS[step as usize])])?;
        pass.set_pipeline(meet.raw());
        pass.set_bind_group(0, &group, &[]);
        dispatch_items(gpu, pass, pixels);
        Ok(())
    }
}
