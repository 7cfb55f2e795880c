//! small: triangles of few pixels of one piece, drawn by one thread each; the others are listed for bin.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::Variant;
use crate::gpu::kernels::parts::*;
use crate::gpu::layout::Counter;

pub fn kernel(variant: Variant) -> Kernel {
    let bindings = vec![
        params(),
        reads("triangle_groups", "array<u32>"),
        reads("nodes", variant.list_type("array<Node>")),
        reads("tasks", "array<u32>"),
        triangles(),
        vertices(),
        pieces(),
        reads("cells", "array<Cell>"),
        writes("large", "array<vec2<u32>>"),
        writes("visibility", variant.keys()),
        writes("recheck_items", "array<vec2<u32>>"),
        counters(),
    ];
    let shared = [
        PARAMS,
        ITEMS,
        INDEX,
        ADDRESS,
        SLABS,
        VERTEX,
        WITHIN,
        variant.lane_places(),
        variant.item_node(),
        variant.real(),
        PACKED_TRIANGLE,
        snippets!("shared/bundle.wgsl"),
        KEY,
    ];
    let own = [
        variant.merge(),
        MEETING,
        MEETING_OF_RAYS,
        UNCERTAIN,
        variant.lanes_piece(),
        snippets!("shared/long_bits.wgsl", "camera/piece.wgsl", "camera/pieces_small.wgsl", "small.wgsl"),
    ];
    let mut kernel = Kernel::new("small", bindings, &[&shared[..], &own].concat());
    kernel.constants.push(("COUNTING", variant.counting as u32 as f64));
    kernel
}

pub fn small() -> Dispatch {
    Dispatch::counted(KernelId::Small, Counter::Tasks)
}
