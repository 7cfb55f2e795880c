//! certify: what is proven of what raster and recheck found, for the channel of that name.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::Variant;
use crate::gpu::kernels::parts::*;
use crate::gpu::layout::Counter;
use crate::image::frame::Channel;

/// What is proven of what raster and recheck found.
pub fn kernel(variant: Variant, planes: &[Channel]) -> Kernel {
    let mut bindings = vec![
        params(),
        step(),
        reads("pairs", "array<vec2<u32>>"),
        triangles(),
        vertices(),
        reads("visibility", "array<u32>"),
        writes("proofs", "array<atomic<u32>>"),
        writes("planes", "array<u32>"),
        counters(),
    ];
    bindings.extend(variant.rays());
    bindings.extend([reads("tile_start", "array<u32>"), reads("cells", "array<Cell>")]);
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, VERTEX, variant.real(), TRIANGLE, BUNDLE, KEY];
    let shared = [PAIR, BITS, MEETING, variant.camera(), snippets!("shared/proof.wgsl")];
    let own = [NEARNESS, SOLID, snippets!("certify.wgsl")];
    let all = [&snippets[..], &shared[..], variant.coverage(), variant.proof(), &own].concat();
    let mut kernel = Kernel::new("certify", bindings, &all).with_planes(planes);
    kernel.constants.extend(variant.constants());
    kernel
}

/// Number of dispatches of `certify` over all pairs, after all steps of raster.
pub const CERTIFY_STEPS: u32 = 2;

pub fn certify(step: u32) -> Dispatch {
    Dispatch::counted(KernelId::Certify, Counter::Pairs).nth(step)
}

/// Writes the plane, once all pairs are processed.
pub fn write_certified(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Certify, pixels).nth(CERTIFY_STEPS)
}
