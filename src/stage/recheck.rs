//! recheck: what raster left in doubt, settled in recheck arithmetic.

use super::{STEPS, Scopes, Stages, with};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::gpu::rows::COUNT_DOUBTS;

impl Stages {
    /// Bounds in f32 do not prove everything.
    pub fn rechecks(&self) -> bool {
        self.recheck.is_some()
    }

    /// After every step of raster.
    pub fn recheck(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, step: u32) -> Result<()> {
        let Some(recheck) = &self.recheck else { return Ok(()) };
        self.lay_out(gpu, pass, scopes, COUNT_DOUBTS)?;
        let group = recheck.bind_renamed(gpu, &with(scopes, &self.steps), &[("step", STEPS[step as usize])])?;
        pass.set_pipeline(&recheck.pipeline);
        pass.set_bind_group(0, &group, &[]);
        if let Some(indirect) = scopes.iter().find_map(|s| s.get("indirect")) {
            pass.dispatch_workgroups_indirect(indirect, 0);
        }
        Ok(())
    }
}
