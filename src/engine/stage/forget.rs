//! forget: the rays after a bounce that were there before, tile by tile.

use super::{Dispatch, KernelId, Number, Threads};
use crate::gpu::kernels::parts::*;

pub fn kernel() -> Kernel {
    let bindings = vec![
        params(),
        writes("bounced_live", "array<atomic<u32>>"),
        writes("bounced_hi", "array<f32>"),
        writes("bounced_lo", "array<f32>"),
        writes("bounced_paths", "array<PathState>"),
    ];
    Kernel::new("forget", bindings, &[PARAMS, ITEMS, OPTICS_LAYOUT, snippets!("forget.wgsl")])
}

pub fn forget() -> Dispatch {
    Dispatch { threads: Threads::Counted(Number::Tiles("bounced_live")), ..Dispatch::over(KernelId::Forget, 0) }
}
