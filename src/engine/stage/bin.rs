//! bin: the triangles of each kept triangle group against the tiles below its node.

use super::{Scopes, Stages};
use crate::gpu::Gpu;
use crate::gpu::layout::COUNT_TASKS;
use crate::input::Result;

impl Stages {
    pub fn bin(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes) -> Result<()> {
        self.dispatch_counted(gpu, pass, scopes, &self.bin, (COUNT_TASKS, 0))
    }
}
