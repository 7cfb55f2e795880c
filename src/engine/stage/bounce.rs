//! bounce: reflects or refracts the ray of every pixel that meets the optics' surface.

use super::{Dispatch, KernelId, Pixels};
use crate::gpu::kernels::Variant;
use crate::gpu::kernels::parts::*;

/// Bounces the rays that meet the optics' surface.
pub fn kernel(variant: Variant) -> Kernel {
    let (surface, surface_snippets) = variant.surface();
    let mut bindings = vec![
        params(),
        optic(),
        reads("visibility", "array<u32>"),
        paths(),
        surface,
        writes("bounced_live", "array<atomic<u32>>"),
        writes("bounced_hi", "array<f32>"),
        writes("bounced_lo", "array<f32>"),
        writes("bounced_paths", "array<PathState>"),
    ];
    bindings.extend(variant.pixel_rays());
    bindings.push(live());
    let snippets = [PARAMS, ITEMS, SLABS, variant.real(), BUNDLE, KEY, OPTICS_LAYOUT, REFRACT];
    let own = [variant.camera(), LIVE_PIXELS, variant.arrival(), snippets!("bounce.wgsl")];
    let mut kernel =
        Kernel::new("bounce", bindings, &[&snippets[..], surface_snippets, &own[..], variant.pixel()].concat());
    kernel.constants = variant.constants();
    kernel
}

pub fn bounce() -> Dispatch {
    Dispatch::of_pixels(KernelId::Bounce, Pixels::Live)
}
