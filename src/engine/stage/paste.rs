//! paste: what facets show, from an atlas where each has a triangle of its own.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::Variant;
use crate::gpu::kernels::parts::*;
use crate::image::frame::Channel;

/// What facets show, from their atlas.
pub fn kernel(variant: Variant, planes: &[Channel]) -> Kernel {
    let (surface, surface_snippets) = variant.surface();
    let mut bindings = vec![
        params(),
        optic(),
        uniform("atlas_layout", "AtlasLayout"),
        reads("visibility", "array<u32>"),
        surface,
        reads("atlas", "array<u32>"),
        writes("planes", "array<u32>"),
    ];
    bindings.extend(variant.pixel_rays());
    let snippets = [PARAMS, ITEMS, SLABS, variant.real(), BUNDLE, KEY, OPTICS_LAYOUT, REFRACT];
    let own = [variant.camera(), snippets!("paste.wgsl")];
    let mut kernel =
        Kernel::new("paste", bindings, &[&snippets[..], surface_snippets, &own[..], variant.pixel()].concat())
            .with_planes(planes);
    kernel.constants.extend(variant.constants());
    kernel
}

pub fn paste(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Paste, pixels)
}
