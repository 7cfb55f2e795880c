//! bin: the triangles of each kept bunch against the tiles below its node.

use super::{Scopes, Stages};
use crate::gpu::Gpu;
use crate::gpu::rows::COUNT_TASKS;
use crate::input::Result;

impl Stages {
    pub fn bin(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes) -> Result<()> {
        self.dispatch_counted(gpu, pass, scopes, &self.bin, (COUNT_TASKS, 0))
    }
}
