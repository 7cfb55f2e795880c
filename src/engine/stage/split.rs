//! split: the triangle groups of each kept cluster against the rays of its node.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::Variant;
use crate::gpu::kernels::parts::*;
use crate::gpu::layout::Counter;

pub fn kernel(variant: Variant) -> Kernel {
    let mut bindings = vec![
        params(),
        reads("triangle_groups", "array<Cluster>"),
        reads("nodes", variant.list_type("array<Node>")),
        reads("cells", "array<Cell>"),
        reads("work", "array<vec2<u32>>"),
        writes("tasks", "array<vec2<u32>>"),
        counters(),
    ];
    bindings.extend(variant.incoherent_rays(variant.culling));
    let own = [variant.item_rays(), variant.item_node(), snippets!("split.wgsl")];
    let snippets = [&[PARAMS, ITEMS, INDEX, ADDRESS, MEETS, PLACES][..], &own].concat();
    let mut kernel = Kernel::new("split", bindings, &snippets);
    kernel.constants.push(("CULLING", variant.culling as u32 as f64));
    kernel
}

pub fn split() -> Dispatch {
    Dispatch::counted(KernelId::Split, Counter::Work)
}
