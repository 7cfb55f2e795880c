//! raster: every (triangle, tile) pair, pixel by pixel, into the visibility buffer; pair by pair, or tile by tile.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::parts::*;
use crate::gpu::kernels::{RaysKind, Variant};
use crate::gpu::layout::Counter;

pub(super) const HITS: Parts = snippets!("shared/hits.wgsl");

pub fn kernel(variant: Variant) -> Kernel {
    if variant.by_tile {
        return by_tile(variant);
    }
    let mut kernel = into_visibility("raster", variant, &[HITS, PAIR, UNCERTAIN, snippets!("raster.wgsl")]);
    kernel.bindings.push(reads("pairs", "array<vec2<u32>>"));
    kernel.constants.push(("ALL_UNCERTAIN", f64::from(u8::from(variant.all_uncertain && variant.rechecks()))));
    kernel
}

/// The t of a triangle at a pixel in recheck arithmetic, or in f32 with a bound.
const EXACT: Parts = snippets!("shared/pixel_edges.wgsl", "shared/pixel_test.wgsl", "shared/nearest_exact.wgsl");
const BOUNDED: Parts = snippets!("shared/pixel_edges.wgsl", "shared/nearest_bounded.wgsl");

fn by_tile(variant: Variant) -> Kernel {
    let mut bindings = vec![
        params(),
        reads("pairs", "array<vec2<u32>>"),
        writes("starts", "array<u32>"),
        reads("ends", "array<u32>"),
        writes("busy", "array<u32>"),
        writes("recheck_items", "array<vec2<u32>>"),
        triangles(),
        vertices(),
        reads("nodes", variant.list_type("array<Node>")),
        counters(),
    ];
    let mut snippets = vec![PARAMS, ITEMS, INDEX, SLABS, VERTEX, PACKED_TRIANGLE];
    if variant.f64_depths {
        bindings.push(writes("visibility", "array<atomic<u64>>"));
        snippets.extend([variant.real(), KEY, variant.merge(), COLUMN]);
    } else {
        snippets.push(snippets!("shared/column_bounded.wgsl"));
    }
    let is_field = variant.rays == RaysKind::Field;
    if is_field {
        bindings.extend([reads("rays_hi", "array<vec2<f32>>"), reads("rays_lo", "array<vec2<f32>>")]);
    } else {
        bindings.extend([pieces(), reads("tile_start", "array<u32>"), reads("cells", "array<Cell>")]);
    }
    let (column, nearest) = match (is_field, variant.f64_depths) {
        (true, true) => (snippets!("camera/field_column.wgsl"), EXACT),
        (true, false) => (snippets!("camera/field_column_bounded.wgsl"), BOUNDED),
        (false, true) => (snippets!("camera/piece.wgsl", "camera/pieces_column.wgsl"), EXACT),
        (false, false) => (snippets!("camera/pieces_column_bounded.wgsl"), BOUNDED),
    };
    if variant.bounced {
        bindings.extend([optic(), paths()]);
    }
    if !is_field {
        snippets.push(variant.lanes_piece());
        if variant.f64_depths {
            snippets.push(BUNDLE);
        }
    }
    snippets.extend([PAIR, WITHIN, variant.lane_places(), LANES, PLACES, variant.item_node(), column, nearest]);
    let own: Parts = snippets!("shared/waiting.wgsl", "raster_by_tile.wgsl");
    let mut kernel = Kernel::new("raster", bindings, &[&snippets[..], &[own], variant.start()].concat());
    kernel.constants = variant.constants();
    kernel.constants.push(("COUNTING", variant.counting as u32 as f64));
    kernel
}

/// A kernel that merges hits of triangles into the visibility buffer.
pub(super) fn into_visibility(name: &'static str, variant: Variant, own: &[Parts]) -> Kernel {
    let mut bindings = vec![
        params(),
        step(),
        writes("recheck_items", "array<vec2<u32>>"),
        triangles(),
        vertices(),
        writes("visibility", variant.keys()),
        counters(),
    ];
    bindings.extend(variant.rays());
    bindings.extend([reads("tile_start", "array<u32>"), reads("cells", "array<Cell>")]);
    bindings.extend(variant.moments());
    bindings.extend(variant.instances());
    if variant.bounced {
        bindings.extend([optic(), paths()]);
    }
    bindings.extend(variant.mask_bindings());
    let (vertex, triangle) = (variant.vertex(), variant.triangle());
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, vertex, variant.real(), triangle, BUNDLE, KEY, variant.alpha_masks()];
    let shared = [BITS, variant.merge(), MEETING, variant.camera()];
    let mut all = [&snippets[..], &shared[..], own, variant.coverage(), variant.start()].concat();
    all.extend(variant.corner_colors().filter(|_| variant.masked));
    let mut kernel = Kernel::new(name, bindings, &all);
    kernel.constants = variant.constants();
    kernel.constants.push(("COUNTING", variant.counting as u32 as f64));
    kernel
}

/// Number of dispatches of `raster` over all pairs: without 64-bit atomics the words of a key go one after the other.
pub fn raster_steps(variant: Variant) -> u32 {
    if variant.atomics64 { 1 } else { 2 }
}

/// Tile by tile, `rounds` times: each takes up what the one before has left.
pub fn raster(variant: Variant, step: u32, rounds: u32) -> Vec<Dispatch> {
    let (counter, rounds) = if variant.by_tile { (Counter::Busy, rounds) } else { (Counter::Pairs, 1) };
    vec![Dispatch::counted(KernelId::Raster, counter).nth(step); rounds as usize]
}
