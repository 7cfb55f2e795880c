//! meet: smooth surfaces into the visibility buffer, once a pixel.

use super::{Dispatch, KernelId, Pixels};
use crate::gpu::kernels::Variant;
use crate::gpu::kernels::parts::*;

/// Smooth surfaces into the visibility buffer; triangles get there by `raster`.
pub fn kernel(variant: Variant) -> Kernel {
    let visibility = if variant.atomics64 { "array<atomic<u64>>" } else { "array<atomic<u32>>" };
    let (surface, surface_snippets) = variant.surface();
    let mut bindings = vec![params(), step(), optic(), paths(), surface, writes("visibility", visibility)];
    bindings.extend(variant.pixel_rays());
    bindings.push(live());
    let snippets = [PARAMS, ITEMS, SLABS, variant.real(), BUNDLE, KEY, variant.merge(), OPTICS_LAYOUT, REFRACT];
    let own = [variant.camera(), LIVE_PIXELS, snippets!("meet.wgsl")];
    let mut kernel =
        Kernel::new("meet", bindings, &[&snippets[..], surface_snippets, &own[..], variant.pixel()].concat());
    kernel.constants = variant.constants();
    kernel
}

/// The words of a key go in the steps of [`super::raster::raster_steps`].
pub fn meet(step: u32) -> Dispatch {
    Dispatch::of_pixels(KernelId::Meet, Pixels::Live).nth(step)
}
