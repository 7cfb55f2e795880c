//! sample: the samples of the edge pixels against every triangle; pair by pair, or tile by tile, and the recheck of what that leaves
//! uncertain.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::parts::*;
use crate::gpu::kernels::{RaysKind, Variant};
use crate::gpu::layout::Counter;

/// What the samples of those pixels see, pair by pair.
pub fn kernel(variant: Variant) -> Kernel {
    let mut bindings = vec![
        params(),
        step(),
        reads("pairs", "array<vec2<u32>>"),
        triangles(),
        vertices(),
        writes("visibility", variant.keys()),
        counters(),
        reads("nodes", "array<Node>"),
        reads("tile_start", "array<u32>"),
        reads("cells", "array<Cell>"),
        reads("cell_samples", "array<vec2<u32>>"),
        reads("edge_of", "array<u32>"),
    ];
    bindings.extend(variant.rays());
    bindings.extend(variant.mask_bindings());
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, VERTEX, variant.real(), TRIANGLE, BUNDLE, KEY, PAIR, BITS];
    let own = [WITHIN, variant.merge(), MEETING, MEETING_OF_RAYS, SIDES, variant.camera(), CELL_SAMPLES, SAMPLE_HITS];
    let masks = match variant.masked {
        true => [Some(variant.alpha_masks()), variant.corner_colors()],
        false => [Some(snippets!("textures/solid.wgsl")), None],
    };
    let masks: Vec<Parts> = masks.into_iter().flatten().collect();
    let rays = variant.sample_rays(&mut bindings);
    let offsets: &[Parts] = match variant.rays {
        RaysKind::Pieces => &[],
        _ => {
            bindings.push(uniform("sample_offsets", "SampleOffsets"));
            &[SAMPLE_OFFSETS]
        }
    };
    let all = [&snippets[..], &own, &masks, rays, offsets, &[snippets!("sample.wgsl")]].concat();
    let mut kernel = Kernel::new("sample", bindings, &all);
    kernel.constants = variant.sample_constants();
    kernel
}

/// What the samples of those pixels see, tile by tile.
pub fn by_tile_kernel(variant: Variant) -> Kernel {
    let mut bindings = vec![
        params(),
        reads("blocks", "array<vec4<u32>>"),
        reads("touches", "array<vec4<u32>>"),
        triangles(),
        vertices(),
        reads("nodes", variant.list_type("array<Node>")),
        writes("samples", "array<vec2<u32>>"),
        writes("recheck_items", "array<vec2<u32>>"),
        counters(),
        reads("tile_start", "array<u32>"),
        reads("cell_samples", "array<vec2<u32>>"),
    ];
    let rays: &[Parts] = match variant.rays {
        RaysKind::Field => {
            bindings.extend([reads("rays_hi", "array<vec2<f32>>"), reads("rays_lo", "array<vec2<f32>>")]);
            bindings.push(reads("sample_ray_deltas", "array<vec2<f32>>"));
            &[snippets!("camera/field_column.wgsl"), snippets!("camera/field_strip.wgsl")]
        }
        _ => {
            bindings.extend([pieces(), reads("cells", "array<Cell>"), uniform("sample_offsets", "SampleOffsets")]);
            &[BUNDLE, PIECES, SAMPLE_OFFSETS, snippets!("camera/pieces_strip.wgsl")]
        }
    };
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, VERTEX, variant.real(), PACKED_TRIANGLE, KEY, BITS, WITHIN, PLACES];
    let own = [variant.lane_places(), LANES, variant.item_node(), COLUMN, CELL_SAMPLES];
    let stage = [
        snippets!("shared/waiting.wgsl"),
        snippets!("shared/pixel_edges.wgsl", "shared/pixel_test.wgsl"),
        snippets!("sample_by_tile.wgsl"),
    ];
    let mut kernel = Kernel::new("sample", bindings, &[&snippets[..], &own, rays, &stage].concat());
    kernel.constants = variant.constants();
    kernel.constants.extend([("SAMPLES", f64::from(variant.samples)), ("STRIPS", variant.strips())]);
    kernel
}

/// What that leaves uncertain.
pub fn recheck_kernel(variant: Variant) -> Kernel {
    let mut bindings = vec![
        params(),
        step(),
        reads("pairs", "array<vec2<u32>>"),
        reads("recheck_items", "array<vec2<u32>>"),
        triangles(),
        vertices(),
        writes("visibility", variant.keys()),
        counters(),
        reads("tile_start", "array<u32>"),
        reads("cells", "array<Cell>"),
        reads("cell_samples", "array<vec2<u32>>"),
    ];
    bindings.extend(variant.rays());
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, VERTEX, variant.real(), TRIANGLE, BUNDLE, KEY, PAIR, BITS];
    let own = [
        variant.merge(),
        MEETING,
        MEETING_OF_RAYS,
        SIDES,
        variant.camera(),
        CELL_SAMPLES,
        SAMPLE_HITS,
        snippets!("textures/solid.wgsl"),
    ];
    let rays = variant.sample_rays(&mut bindings);
    let mut kernel = Kernel::new(
        "recheck_samples",
        bindings,
        &[&snippets[..], &own, rays, &[snippets!("recheck_samples.wgsl")]].concat(),
    );
    kernel.constants = variant.constants();
    kernel.constants.extend([("SAMPLES", f64::from(variant.samples)), ("STRIPS", variant.strips())]);
    kernel
}

/// Keys go into the records of samples.
const KEYS: (&str, &str) = ("visibility", "samples");

/// The words of a key go in the steps of [`super::raster::raster_steps`].
pub fn sample(step: u32) -> Dispatch {
    Dispatch::counted(KernelId::Sample, Counter::Pairs).nth(step).with(KEYS.0, KEYS.1)
}

/// What [`super::edges::edges_by_tile`] has listed.
pub fn sample_by_tile() -> [Dispatch; 2] {
    let recheck = Dispatch::counted(KernelId::RecheckSamples, Counter::RecheckSamples);
    [Dispatch::counted(KernelId::SampleByTile, Counter::Blocks), recheck.with(KEYS.0, KEYS.1)]
}
