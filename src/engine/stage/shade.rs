//! shade: the channels asked for, once a pixel.

use super::{Scopes, Stages, dispatch_items};
use crate::gpu::Gpu;
use crate::input::Result;

impl Stages {
    pub fn shade(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, pixels: u32) -> Result<()> {
        let group = self.shade.bind(gpu, scopes)?;
        pass.set_pipeline(self.shade.raw());
        pass.set_bind_group(0, &group, &[]);
        dispatch_items(gpu, pass, pixels);
        Ok(())
    }
}
