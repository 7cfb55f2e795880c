//! bin: the triangles of each kept cluster against the tiles below its node.

use super::{Scopes, Stages};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::gpu::rows::COUNT_WORK;

impl Stages {
    pub fn bin(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes) -> Result<()> {
        self.dispatch_counted(gpu, pass, scopes, &self.bin, (COUNT_WORK, 0))
    }
}
