//! args: the next indirect dispatch, laid out from a counter.

use crate::gpu::kernels::parts::*;

/// Lays out the next indirect dispatch.
pub fn kernel() -> Kernel {
    let bindings = vec![params(), step(), counters(), writes("indirect", "array<u32>")];
    Kernel::new("args", bindings, &[PARAMS, snippets!("args.wgsl")])
}
