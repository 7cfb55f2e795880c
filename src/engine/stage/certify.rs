//! certify: what is proven of what raster and recheck found, for the channel of that name.

use super::{Dispatch, KernelId, Pixels};
use crate::gpu::kernels::Variant;
use crate::gpu::layout::Counter;

/// Proofs follow rays through the hierarchy where there are spheres, in frames that are not refused.
pub fn entry_file(variant: Variant) -> &'static str {
    let is_straight = !variant.rays.kind.is_curved();
    let is_traced = variant.has_round() && is_straight && !variant.is_timed() && variant.rays.optics.is_none();
    if is_traced { "certify_traced.wgsl" } else { "certify.wgsl" }
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
