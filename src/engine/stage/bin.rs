//! bin: the triangles of each kept triangle group against the tiles below its node.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::Variant;
use crate::gpu::kernels::parts::*;
use crate::gpu::layout::Counter;

pub fn kernel(variant: Variant) -> Kernel {
    let mut bindings = vec![
        params(),
        reads("triangle_groups", variant.list_type("array<Cluster>")),
        reads("nodes", variant.list_type("array<Node>")),
        reads("tasks", "array<vec2<u32>>"),
        reads("triangles", "array<vec4<u32>>"),
        reads("vertices_hi", "array<f32>"),
        reads("cells", "array<Cell>"),
        counters(),
    ];
    let mut own = snippets!("shared/triangle_group_load.wgsl", "shared/by_pair.wgsl");
    if variant.by_tile {
        let unsorted = writes("unsorted", "array<vec2<u32>>");
        bindings.extend([unsorted, writes("ranks", "array<u32>"), writes("ends", "array<atomic<u32>>")]);
        own = snippets!("shared/triangle_group_by_lanes.wgsl", "shared/by_tile.wgsl");
    } else {
        bindings.push(writes("pairs", "array<vec2<u32>>"));
    }
    let snippets = [PARAMS, ITEMS, INDEX, ADDRESS, SLABS, VERTEX, PAIR, WITHIN, BOX_MET, variant.item_node()];
    bindings.extend(variant.incoherent_rays(variant.culling));
    let snippets = [&snippets[..], &[variant.item_rays(), own, snippets!("bin.wgsl")]].concat();
    let mut kernel = Kernel::new("bin", bindings, &snippets);
    kernel.constants.push(("SLABBED", variant.slabbed as u32 as f64));
    kernel.constants.push(("COUNTING", variant.counting as u32 as f64));
    kernel.constants.push(("SAMPLE_REACH", variant.sample_reach()));
    kernel
}

pub fn bin() -> Dispatch {
    Dispatch::counted(KernelId::Bin, Counter::Tasks)
}
