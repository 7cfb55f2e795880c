//! write: colour planes to 8-bit sRGB.

use super::{Scopes, Stages, dispatch_items};
use crate::gpu::Gpu;
use crate::input::Result;

impl Stages {
    pub fn write(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, pixels: u32) -> Result<()> {
        let group = self.write.bind(gpu, scopes)?;
        pass.set_pipeline(self.write.raw());
        pass.set_bind_group(0, &group, &[]);
        dispatch_items(gpu, pass, pixels);
        Ok(())
    }
}
