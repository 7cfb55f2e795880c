//! reach: the tiles of a camera's own rays that may meet its optics.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::parts::*;

pub fn kernel() -> Kernel {
    let bindings = vec![params(), optic(), reads("nodes", "array<Node>"), writes("live", "array<atomic<u32>>")];
    Kernel::new("reach", bindings, &[PARAMS, ITEMS, INDEX, MEETS, OPTICS_LAYOUT, snippets!("reach.wgsl")])
}

pub fn reach(tiles: u32) -> Dispatch {
    Dispatch::over(KernelId::Reach, tiles)
}
