//! edges: the edge pixels, whose samples do not all see one triangle; pair by pair, or tile by tile.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::Variant;
use crate::gpu::kernels::parts::*;
use crate::gpu::layout::{self, Counter};

/// The edge pixels, pair by pair.
pub fn kernel(variant: Variant) -> Kernel {
    let mut bindings = vec![
        params(),
        step(),
        reads("pairs", "array<vec2<u32>>"),
        triangles(),
        vertices(),
        reads("slot_of_id", "array<u32>"),
        reads("visibility", "array<u32>"),
        reads("nodes", "array<Node>"),
        reads("tile_start", "array<u32>"),
        reads("cells", "array<Cell>"),
        reads("cell_samples", "array<vec2<u32>>"),
        writes("edge_of", "array<atomic<u32>>"),
        writes("samples", "array<u32>"),
        counters(),
    ];
    bindings.extend(variant.masked.then(|| [table("surfaces"), table("materials")]).into_iter().flatten());
    // of keys the ids and layers alone are read
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, VERTEX, PACKED_TRIANGLE, REAL_F32, KEY, PAIR, BITS, CELLS, WITHIN];
    let own = [DEPTH_BOUNDS, NEARNESS, CELL_SAMPLES, variant.holes(), snippets!("edges.wgsl")];
    let mut all = [&snippets[..], &own].concat();
    all.extend(variant.hole_surfaces());
    all.extend(variant.corner_colors().filter(|_| variant.masked));
    let mut kernel = Kernel::new("edges", bindings, &all);
    kernel.constants = variant.sample_constants();
    kernel
}

/// The edge pixels, tile by tile.
pub fn by_tile_kernel(variant: Variant) -> Kernel {
    let bindings = vec![
        params(),
        reads("pairs", "array<vec2<u32>>"),
        reads("starts", "array<u32>"),
        reads("ends", "array<u32>"),
        triangles(),
        vertices(),
        reads("visibility", "array<vec2<u32>>"),
        reads("nodes", variant.list_type("array<Node>")),
        reads("tile_start", "array<u32>"),
        reads("cell_samples", "array<vec2<u32>>"),
        writes("edge_of", "array<u32>"),
        writes("samples", "array<vec2<u32>>"),
        writes("touches", "array<vec4<u32>>"),
        writes("blocks", "array<vec4<u32>>"),
        counters(),
    ];
    // of keys the ids alone are read
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, VERTEX, PACKED_TRIANGLE, REAL_F32, KEY, PAIR, BITS, WITHIN, COLUMN];
    let four = snippets!("samples/four.wgsl");
    let own = [
        DEPTH_BOUNDS,
        variant.lane_places(),
        LANES,
        variant.item_node(),
        CELL_SAMPLES,
        four,
        snippets!("edges_by_tile.wgsl"),
    ];
    let mut kernel = Kernel::new("edges", bindings, &[&snippets[..], &own].concat());
    kernel.constants = variant.sample_constants();
    kernel.constants.push(("STRIPS", variant.strips()));
    kernel
}

/// The steps of the kernel, pair by pair.
const SEEN: u32 = 0;
const PAIRS: u32 = 1;
const LIST: u32 = 2;

/// What is seen at the centres of `pixels` pixels; for every chunk of the scene.
pub fn find_edges(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Edges, pixels).nth(SEEN)
}

/// All pairs of a job, once the whole scene was looked at.
pub fn edges() -> Dispatch {
    Dispatch::counted(KernelId::Edges, Counter::Pairs).nth(PAIRS)
}

/// Lists the pixels that were found, once all pairs are processed.
pub fn list_edges(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Edges, pixels).nth(LIST)
}

/// Finds and lists them at once, of `tiles` tiles that have all pairs of the scene.
pub fn edges_by_tile(tiles: u32) -> Dispatch {
    Dispatch::over(KernelId::EdgesByTile, layout::LANES * tiles)
}
