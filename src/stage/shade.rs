//! shade: the channels asked for, once a pixel.

use super::{Scopes, Stages, dispatch_items};
use crate::TILE;
use crate::error::Result;
use crate::gpu::Gpu;

impl Stages {
    /// A band of these pixels.
    pub fn shade(
        &self,
        gpu: &Gpu,
        pass: &mut wgpu::ComputePass,
        scopes: Scopes,
        (width, rows): (u32, u32),
    ) -> Result<()> {
        let tiles = [width, rows].map(|side| side.next_multiple_of(TILE)).into_iter().product();
        let items = if self.variant.shades_tiles() { tiles } else { width * rows };
        let group = self.shade.bind(gpu, scopes)?;
        pass.set_pipeline(&self.shade.pipeline);
        pass.set_bind_group(0, &group, &[]);
        dispatch_items(gpu, pass, items);
        Ok(())
    }
}
