//! resolve: the colours of the edge pixels, from their samples.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::parts::*;
use crate::gpu::kernels::{RaysKind, Variant};
use crate::gpu::layout::Counter;
use crate::image::frame::Channel;

/// The colours of those pixels.
pub fn kernel(variant: Variant, planes: &[Channel]) -> Kernel {
    let mut bindings = vec![
        params(),
        uniform("shading", "Shading"),
        uniform("sample_offsets", "SampleOffsets"),
        triangles(),
        vertices(),
        reads("slot_of_id", "array<u32>"),
        table("surfaces"),
        table("normals"),
        table("materials"),
        table("lights"),
        reads("samples", "array<u32>"),
        writes("planes", "array<u32>"),
        counters(),
        reads("cell_samples", "array<vec2<u32>>"),
    ];
    bindings.extend(variant.pages());
    bindings.extend(variant.style_binding());
    bindings.extend(variant.pixel_rays());
    let snippets = [
        PARAMS,
        ITEMS,
        INDEX,
        SLABS,
        VERTEX,
        variant.real(),
        PACKED_TRIANGLE,
        BUNDLE,
        KEY,
        SHADING,
        variant.lit_surface(),
        variant.flat_surface(),
    ];
    let mut own = vec![variant.camera(), variant.images(), BITS, CELL_SAMPLES, SAMPLE_OFFSETS];
    own.push(variant.thrown_pictures());
    own.push(variant.style());
    own.push(variant.opacity());
    own.extend(variant.corner_colors());
    own.extend(variant.leaves());
    own.extend(variant.weights());
    own.push(if variant.centred { snippets!("samples/centred.wgsl") } else { snippets!("samples/part.wgsl") });
    own.push(if variant.analytic { snippets!("samples/areas.wgsl") } else { snippets!("samples/counted.wgsl") });
    own.extend(variant.light());
    own.extend(variant.pixel());
    if variant.rays == RaysKind::Pieces {
        own.push(snippets!("camera/pieces_sample_ray.wgsl"));
    } else {
        own.extend(variant.sample_rays(&mut bindings));
    }
    own.push(snippets!("resolve.wgsl"));
    let mut kernel = Kernel::new("resolve", bindings, &[&snippets[..], &own].concat()).with_planes(planes);
    kernel.constants.extend(variant.constants());
    kernel.constants.push(("SAMPLES", f64::from(variant.samples)));
    kernel.constants.push(("NORMALS", variant.normals as u32 as f64));
    kernel
}

/// After `shade`, for every chunk of the scene from the first on.
pub fn resolve() -> Dispatch {
    Dispatch::counted(KernelId::Resolve, Counter::Edges)
}
