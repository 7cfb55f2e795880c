//! aim: turns the rays of a lens, and the bounds on them, into those of a viewer.

use super::{Dispatch, KernelId};
use crate::engine::plan::turned::Turned;
use crate::gpu::kernels::Variant;

/// Whether frames of a variant read bounds on the rays of a viewer.
pub fn turns_nodes(variant: Variant) -> bool {
    let is_of_viewers = !variant.rays.kind.is_curved() && !variant.is_bounced();
    is_of_viewers && (variant.rasters() || variant.bounces_rays())
}

/// Dispatches over the rays of a field, and over all nodes of a viewer's band.
pub fn aim(turned: &Turned, variant: Variant) -> Vec<Dispatch> {
    let rays = (turned.ray_count() > 0).then(|| Dispatch::over(KernelId::Aim, turned.ray_count()));
    let count = turned.lens.nodes.nodes.len() as u32;
    let nodes = turns_nodes(variant).then(|| Dispatch::over(KernelId::AimNodes, count));
    rays.into_iter().chain(nodes).collect()
}
