//! sort: the pairs that bin has found, those of a tile side by side, where raster goes tile by tile.

use super::{Scopes, Stages, dispatch_items};
use crate::gpu::Gpu;
use crate::gpu::layout::COUNT_PAIRS;
use crate::input::Result;

impl Stages {
    pub fn sorts(&self) -> bool {
        self.sort.is_some()
    }

    /// Of `tiles` tiles.
    pub fn sort(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, tiles: u32) -> Result<()> {
        let Some([allot, sort]) = &self.sort else { return Ok(()) };
        let group = allot.bind(gpu, scopes)?;
        pass.set_pipeline(allot.raw());
        pass.set_bind_group(0, &group, &[]);
        dispatch_items(gpu, pass, tiles);
        self.dispatch_counted(gpu, pass, scopes, sort, (COUNT_PAIRS, 0))
    }
}
