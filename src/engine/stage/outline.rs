//! outline: lines between pixels that differ, over the colours.

use super::{Scopes, Stages, dispatch_items};
use crate::gpu::Gpu;
use crate::input::Result;

impl Stages {
    /// After all passes of a band.
    pub fn outline(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, pixels: u32) -> Result<()> {
        let Some(outline) = &self.outline else { return Ok(()) };
        let group = outline.bind(gpu, scopes)?;
        pass.set_pipeline(outline.raw());
        pass.set_bind_group(0, &group, &[]);
        dispatch_items(gpu, pass, pixels);
        Ok(())
    }

    pub fn outlines(&self) -> bool {
        self.outline.is_some()
    }
}
