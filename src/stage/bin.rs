//! bin: the triangles of each kept cluster against the tiles below its node.

use super::{Scopes, Stages};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::gpu::rows::COUNT_WORK;

impl Stages {
    pub fn bin(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes) -> Result<()> {
        self.lay_out(gpu, pass, scopes, COUNT_WORK)?;
        let group = self.bin.bind(gpu, scopes)?;
        pass.set_pipeline(&self.bin.pipeline);
        pass.set_bind_group(0, &group, &[]);
        if let Some(indirect) = scopes.iter().find_map(|s| s.get("indirect")) {
            pass.dispatch_workgroups_indirect(indirect, 0);
        }
        Ok(())
    }
}
