//! choose: whether trace takes over from raster, before each dispatch of raster that follows a counter.

use crate::gpu::kernels::parts::*;

pub fn kernel() -> Kernel {
    let bindings = vec![params(), step(), counters()];
    Kernel::new("choose", bindings, &[PARAMS, snippets!("choose.wgsl")])
}
