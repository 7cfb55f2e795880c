//! certify: what is proven of what raster and recheck found, for the channel of that name.

use super::{Dispatch, KernelId, Pixels};
use crate::gpu::kernels::parts::*;
use crate::gpu::kernels::{RaysKind, Variant};
use crate::gpu::layout::Counter;
use crate::image::frame::Channel;

const CERTAINTY: Parts = snippets!("shared/certainty.wgsl");

/// Proofs follow rays through the hierarchy, where there are spheres: those that are not refused.
fn is_traced(variant: Variant) -> bool {
    let is_straight = !matches!(variant.rays, RaysKind::Curves { .. });
    variant.spheres && is_straight && !variant.timed && variant.optics.is_none()
}

/// What is proven of what was found.
pub fn kernel(variant: Variant, planes: &[Channel]) -> Kernel {
    if is_traced(variant) { by_ray(variant, planes) } else { by_pair(variant, planes) }
}

/// Of what raster and recheck found.
fn by_pair(variant: Variant, planes: &[Channel]) -> Kernel {
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
    bindings.extend(variant.mask_bindings());
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, VERTEX, variant.real(), TRIANGLE, BUNDLE, KEY];
    let shared = [PAIR, BITS, MEETING, variant.camera(), snippets!("shared/proof.wgsl")];
    let own = [NEARNESS, variant.alpha_masks(), variant.holes(), CERTAINTY, snippets!("certify.wgsl")];
    let mut all = [&snippets[..], &shared[..], variant.coverage(), &variant.proof(), &own].concat();
    all.extend(variant.corner_colors().filter(|_| variant.masked));
    let mut kernel = Kernel::new("certify", bindings, &all).with_planes(planes);
    kernel.constants.extend(variant.constants());
    kernel
}

/// Of what trace and recheck found.
fn by_ray(variant: Variant, planes: &[Channel]) -> Kernel {
    let mut bindings = vec![
        params(),
        step(),
        triangles(),
        vertices(),
        reads("visibility", "array<u32>"),
        writes("proofs", "array<atomic<u32>>"),
        writes("planes", "array<u32>"),
        table("bvh"),
        table("bvh_triangles"),
    ];
    bindings.extend(variant.rays());
    bindings.extend([reads("tile_start", "array<u32>"), reads("cells", "array<Cell>")]);
    bindings.extend(variant.mask_bindings());
    let path = match variant.rays {
        RaysKind::Field => snippets!("camera/field_path.wgsl", "camera/straight_stretch.wgsl"),
        _ => snippets!("camera/pieces_path.wgsl", "camera/straight_stretch.wgsl"),
    };
    let snippets = [PARAMS, ITEMS, SLABS, VERTEX, variant.real(), TRIANGLE, BUNDLE, KEY, BITS, MEETING];
    let proof = snippets!("shared/proof.wgsl");
    let shared = [variant.camera(), variant.alpha_masks(), proof, NEARNESS, CERTAINTY, path];
    let own = snippets!(
        "shared/every_tile.wgsl",
        "shared/bvh8.wgsl",
        "shared/bvh_triangle.wgsl",
        "shared/followed.wgsl",
        "shared/followed_whole.wgsl",
        "shared/sphere.wgsl",
        "shared/sphere_chord.wgsl",
        "shared/sphere_end.wgsl",
        "camera/straight_sphere_proof.wgsl",
        "certify_traced.wgsl"
    );
    let mut all =
        [&snippets[..], &shared, variant.coverage(), variant.pixel(), &variant.proof(), variant.start(), &[own]]
            .concat();
    all.extend(variant.corner_colors().filter(|_| variant.masked));
    // proofs ask for them
    all.extend(variant.masked.then(|| variant.holes()));
    let mut kernel = Kernel::new("certify", bindings, &all).with_planes(planes);
    kernel.constants.extend(variant.constants());
    kernel
}

/// Number of dispatches of `certify` over all pairs or pixels, after all steps of raster or trace.
pub const CERTIFY_STEPS: u32 = 2;

pub fn certify(step: u32) -> Dispatch {
    Dispatch::counted(KernelId::Certify, Counter::Pairs).nth(step)
}

/// Over the pixels of tiles, where rays are followed.
pub fn certify_traced(pixels: Pixels, step: u32) -> Dispatch {
    Dispatch::of_pixels(KernelId::Certify, pixels).nth(step)
}

/// Writes the plane, once all pairs or rays are processed.
pub fn write_certified(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Certify, pixels).nth(CERTIFY_STEPS)
}
