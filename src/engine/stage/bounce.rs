//! bounce: the ray of every pixel that meets the optics' surface, turned there.

use super::{Scopes, Stages, dispatch_items};
use crate::gpu::Gpu;
use crate::input::Result;

impl Stages {
    pub fn bounce(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, pixels: u32) -> Result<()> {
        let Some(bounce) = &self.bounce else { return Ok(()) };
        let group = bounce.bind(gpu, scopes)?;
        pass.set_pipeline(bounce.raw());
        pass.set_bind_group(0, &group, &[]);
        dispatch_items(gpu, pass, pixels);
        Ok(())
    }
}
