//! split: the triangle groups of each kept cluster against the rays of its node.

use super::{Scopes, Stages};
use crate::gpu::Gpu;
use crate::gpu::layout::COUNT_WORK;
use crate::input::Result;

impl Stages {
    pub fn split(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes) -> Result<()> {
        self.dispatch_counted(gpu, pass, scopes, &self.split, (COUNT_WORK, 0))
    }
}
