//! aim: turns the rays of a lens, and the bounds on them, into those of a viewer.

use super::{Dispatch, KernelId};
use crate::engine::plan::turned::Turned;
use crate::gpu::kernels::parts::*;
use crate::gpu::kernels::{RaysKind, Variant};

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

/// Whether frames of a variant read bounds on the rays of a viewer.
pub fn turns_nodes(variant: Variant) -> bool {
    let is_of_viewers = matches!(variant.rays, RaysKind::Field | RaysKind::Pieces) && !variant.bounced;
    is_of_viewers && (variant.rasters() || variant.bounces_rays())
}

/// Turns bounds on rays.
pub fn nodes_kernel() -> Kernel {
    let bindings =
        vec![uniform("viewer", "ViewerPose"), reads("lens_nodes", "array<Node>"), writes("nodes", "array<Node>")];
    Kernel::new("aim_nodes", bindings, &[PARAMS, ITEMS, snippets!("aim_nodes.wgsl")])
}

/// Dispatches over the rays of a field, and over all nodes of a viewer's band.
pub fn aim(turned: &Turned, variant: Variant) -> Vec<Dispatch> {
    let rays = (turned.ray_count() > 0).then(|| Dispatch::over(KernelId::Aim, turned.ray_count()));
    let count = turned.lens.nodes.nodes.len() as u32;
    let nodes = turns_nodes(variant).then(|| Dispatch::over(KernelId::AimNodes, count));
    rays.into_iter().chain(nodes).collect()
}
