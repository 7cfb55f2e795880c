//! fit: the tree of nodes over rays that were turned, a level a dispatch, tiles first.

use super::{STEPS, Scopes, Stages, dispatch_items, with};
use crate::engine::plan::nodes::Level;
use crate::gpu::Gpu;
use crate::input::Result;

impl Stages {
    pub fn fit(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, levels: &[Level]) -> Result<()> {
        let Some(fit) = &self.fit else { return Ok(()) };
        let all = with(scopes, &self.steps);
        pass.set_pipeline(fit.raw());
        for (level, name) in levels.iter().zip(STEPS) {
            let group = fit.bind_renamed(gpu, &all, &[("step", name)])?;
            pass.set_bind_group(0, &group, &[]);
            dispatch_items(gpu, pass, level.width * level.height);
        }
        Ok(())
    }
}
