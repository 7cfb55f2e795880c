//! recheck: what raster left uncertain, in recheck arithmetic.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::Variant;
use crate::gpu::kernels::parts::*;
use crate::gpu::layout::Counter;

/// What bounds in f32 may leave to be rechecked.
pub fn kernel(variant: Variant) -> Kernel {
    let primitives = match variant.spheres {
        true => snippets!(
            "shared/sphere.wgsl",
            "shared/sphere_chord.wgsl",
            "shared/sphere_end.wgsl",
            "shared/recheck_spheres.wgsl"
        ),
        false => snippets!("shared/recheck_triangles.wgsl"),
    };
    let own = [super::raster::HITS, SIDES, primitives, snippets!("recheck.wgsl")];
    super::raster::into_visibility("recheck", variant, &own)
}

/// After every step of raster, of variants with [`crate::gpu::kernels::Variant::rechecks`].
pub fn recheck(step: u32) -> Dispatch {
    Dispatch::counted(KernelId::Recheck, Counter::RecheckItems).nth(step)
}
