//! cull: clusters against the tree of nodes, one dispatch a step down.

use super::{Dispatch, KernelId, Number, Threads};
use crate::arrays::MapEach;
use crate::gpu::kernels::Variant;
use crate::gpu::kernels::parts::*;

pub fn kernel(variant: Variant) -> Kernel {
    let mut bindings = vec![
        params(),
        step(),
        table("clusters"),
        reads("nodes", "array<Node>"),
        reads("tile_start", "array<u32>"),
        reads("cells", "array<Cell>"),
        reads("queue_in", "array<vec2<u32>>"),
        writes("queue_out", "array<vec2<u32>>"),
        writes("work", "array<vec2<u32>>"),
        counters(),
    ];
    bindings.extend(variant.incoherent_rays(true));
    let own = snippets!("shared/table.wgsl", "cull.wgsl");
    let snippets = [PARAMS, ITEMS, INDEX, WITHIN, MEETS, PLACES, variant.tile_rays(), own];
    let mut kernel = Kernel::new("cull", bindings, &snippets);
    kernel.constants.push(("CULLING", variant.culling as u32 as f64));
    kernel
}

/// The two queues between the steps; step k reads the first when k is even.
const QUEUES: [&str; 2] = ["queue_even", "queue_odd"];

/// The descent of `clusters` clusters in [`crate::engine::plan::nodes::Nodes::cull_steps`].
pub fn cull(clusters: u32, steps: u32) -> Vec<Dispatch> {
    let step = |k: u32| {
        let [queue_in, queue_out] = [k, k + 1].map_each(|k| QUEUES[k as usize % 2]);
        let threads = if k == 0 { Threads::Items(clusters) } else { Threads::Counted(Number::Index(k)) };
        let dispatch = Dispatch { threads, ..Dispatch::over(KernelId::Cull, clusters).nth(k) };
        dispatch.with("queue_in", queue_in).with("queue_out", queue_out)
    };
    (0..steps).map(step).collect()
}
