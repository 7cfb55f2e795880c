//! reach: the tiles of a camera's own rays that may meet its optics.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::Variant;
use crate::gpu::kernels::parts::*;

pub fn kernel(variant: Variant) -> Kernel {
    let bindings = vec![params(), optic(), reads("nodes", "array<Node>"), writes("live", "array<atomic<u32>>")];
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, MEETS, OPTICS_LAYOUT, snippets!("reach.wgsl")];
    let mut kernel = Kernel::new("reach", bindings, &snippets);
    kernel.constants = vec![("SLABBED", variant.slabbed as u32 as f64)];
    kernel
}

pub fn reach(tiles: u32) -> Dispatch {
    Dispatch::over(KernelId::Reach, tiles)
}
