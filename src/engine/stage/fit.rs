//! fit: the tree of nodes over rays after a bounce, a level a dispatch, tiles first.

use super::{Dispatch, KernelId};
use crate::engine::plan::nodes::Level;
use crate::gpu::kernels::Variant;
use crate::gpu::kernels::parts::*;

/// Bounds on the rays after a bounce, node by node.
pub fn kernel(variant: Variant) -> Kernel {
    let variant = variant.after_bounce();
    let mut bindings = vec![params(), step(), optic(), writes("nodes", "array<Node>"), writes("cells", "array<Cell>")];
    bindings.extend(variant.rays());
    bindings.push(live());
    // bounds are f32
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, BITS, REAL_F32, BUNDLE, OPTICS_LAYOUT];
    let mut kernel =
        Kernel::new("fit", bindings, &[&snippets[..], &[variant.camera(), snippets!("fit.wgsl")]].concat());
    kernel.constants = variant.constants();
    kernel
}

pub fn fit(levels: &[Level]) -> Vec<Dispatch> {
    let level = |(n, level): (u32, &Level)| Dispatch::over(KernelId::Fit, level.width * level.height).nth(n);
    (0..).zip(levels).map(level).collect()
}
