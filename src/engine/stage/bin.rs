//! bin: the triangles of each kept triangle group, or those that small leaves, against the tiles below their node.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::Variant;
use crate::gpu::kernels::parts::*;
use crate::gpu::layout::Counter;

pub fn kernel(variant: Variant) -> Kernel {
    let mut bindings = vec![
        params(),
        reads("nodes", if variant.small { "array<Node>" } else { variant.list_type("array<Node>") }),
        triangles(),
        vertices(),
        reads("cells", "array<Cell>"),
        counters(),
    ];
    let items: &[Parts] = if variant.small {
        bindings.push(reads("large", "array<vec2<u32>>"));
        &[snippets!("shared/bin_item.wgsl", "shared/bin_large.wgsl")]
    } else {
        let groups = reads("triangle_groups", variant.list_type("array<Cluster>"));
        bindings.extend([groups, reads("tasks", "array<vec2<u32>>")]);
        let loads = match variant.loads_by_lanes() {
            true => snippets!("shared/triangle_group_by_lanes.wgsl"),
            false => snippets!("shared/triangle_group_load.wgsl"),
        };
        &[loads, variant.item_node(), snippets!("shared/bin_item.wgsl", "shared/bin_groups.wgsl")]
    };
    let mut own = snippets!("shared/by_pair.wgsl");
    if variant.by_tile {
        let unsorted = writes("unsorted", "array<vec2<u32>>");
        bindings.extend([unsorted, writes("ranks", "array<u32>"), writes("ends", "array<atomic<u32>>")]);
        own = snippets!("shared/by_tile.wgsl");
    } else {
        bindings.push(writes("pairs", "array<vec2<u32>>"));
    }
    bindings.extend(variant.incoherent_rays(variant.culling));
    let snippets = [PARAMS, ITEMS, INDEX, ADDRESS, SLABS, VERTEX, PAIR, WITHIN, BOX_MET, PLACES, variant.item_rays()];
    let snippets = [&snippets[..], items, &[own, snippets!("bin.wgsl")]].concat();
    let mut kernel = Kernel::new("bin", bindings, &snippets);
    kernel.constants.push(("SLABBED", variant.slabbed as u32 as f64));
    kernel.constants.push(("COUNTING", variant.counting as u32 as f64));
    kernel.constants.push(("SAMPLE_REACH", variant.sample_reach()));
    kernel
}

pub fn bin(variant: Variant) -> Dispatch {
    Dispatch::counted(KernelId::Bin, if variant.small { Counter::Large } else { Counter::Tasks })
}
