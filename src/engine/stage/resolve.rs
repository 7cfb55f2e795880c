//! resolve: the colours of the pixels that hold an edge, from their samples.

use super::{Scopes, Stages};
use crate::gpu::Gpu;
use crate::gpu::layout::COUNT_EDGES;
use crate::input::Result;

impl Stages {
    /// After `shade`, for every chunk of the scene from the first on.
    pub fn resolve(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes) -> Result<()> {
        let Some(resolve) = &self.resolve else { return Ok(()) };
        self.dispatch_counted(gpu, pass, scopes, resolve, (COUNT_EDGES, 0))
    }
}
