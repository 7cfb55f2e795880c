//! certify: what is proven of what raster and recheck found, for the channel of that name.

use super::{STEPS, Scopes, Stages, dispatch_items, with};
use crate::gpu::Gpu;
use crate::gpu::layout::COUNT_PAIRS;
use crate::input::Result;

/// How many times all pairs must pass `certify`, after all steps of raster.
pub const CERTIFY_STEPS: u32 = 2;

/// The step in which all pixels pass it.
const PIXELS: usize = CERTIFY_STEPS as usize;

impl Stages {
    /// The channel was asked for.
    pub fn certifies(&self) -> bool {
        self.certify.is_some()
    }

    pub fn certify(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, step: u32) -> Result<()> {
        let Some(certify) = &self.certify else { return Ok(()) };
        self.dispatch_counted(gpu, pass, scopes, certify, (COUNT_PAIRS, step))
    }

    /// Writes the plane, once all pairs have passed.
    pub fn write_certified(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, pixels: u32) -> Result<()> {
        let Some(certify) = &self.certify else { return Ok(()) };
        let group = certify.bind_renamed(gpu, &with(scopes, &self.steps), &[("step", STEPS[PIXELS])])?;
        pass.set_pipeline(certify.raw());
        pass.set_bind_group(0, &group, &[]);
        dispatch_items(gpu, pass, pixels);
        Ok(())
    }
}
