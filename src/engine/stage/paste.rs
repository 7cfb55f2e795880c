//! paste: what facets show, from an atlas where each has a triangle of its own.

use super::{Scopes, Stages, dispatch_items};
use crate::gpu::Gpu;
use crate::input::Result;

impl Stages {
    /// The camera has an atlas.
    pub fn pastes(&self) -> bool {
        self.paste.is_some()
    }

    pub fn paste(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, pixels: u32) -> Result<()> {
        let Some(paste) = &self.paste else { return Ok(()) };
        let group = paste.bind(gpu, scopes)?;
        pass.set_pipeline(paste.raw());
        pass.set_bind_group(0, &group, &[]);
        dispatch_items(gpu, pass, pixels);
        Ok(())
    }
}
