//! aim: turns the rays of a lens into those of a viewer.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::Variant;
use crate::gpu::kernels::parts::*;

pub fn kernel(variant: Variant) -> Kernel {
    let bindings = vec![
        uniform("viewer", "ViewerPose"),
        reads("lens_hi", "array<f32>"),
        reads("lens_lo", "array<f32>"),
        writes("rays_hi", "array<f32>"),
        writes("rays_lo", "array<f32>"),
    ];
    Kernel::new("aim", bindings, &[PARAMS, ITEMS, variant.real(), snippets!("aim.wgsl")])
}

/// So many rays.
pub fn aim(rays: u32) -> Dispatch {
    Dispatch::over(KernelId::Aim, rays)
}
