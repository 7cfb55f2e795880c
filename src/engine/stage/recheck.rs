//! recheck: what raster left uncertain, in recheck arithmetic.

use super::{Scopes, Stages};
use crate::gpu::Gpu;
use crate::gpu::layout::COUNT_RECHECK_ITEMS;
use crate::input::Result;

impl Stages {
    /// Bounds in f32 do not prove everything.
    pub fn rechecks(&self) -> bool {
        self.recheck.is_some()
    }

    /// After every step of raster.
    pub fn recheck(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, step: u32) -> Result<()> {
        let Some(recheck) = &self.recheck else { return Ok(()) };
        self.dispatch_counted(gpu, pass, scopes, recheck, (COUNT_RECHECK_ITEMS, step))
    }
}
