//! volume: the light of the scene's volume, over the colours of what lies behind or in it.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::parts::*;
use crate::gpu::kernels::{RaysKind, Variant, VolumeKind};
use crate::image::frame::Channel;

pub fn kernel(variant: Variant, planes: &[Channel]) -> Kernel {
    let kind = variant.volume.unwrap_or(VolumeKind::Plain);
    let mut bindings = vec![
        params(),
        uniform("medium", "Medium"),
        reads("visibility", variant.keys_read()),
        reads("voxels", if kind == VolumeKind::Lit { "array<vec4<f32>>" } else { "array<f32>" }),
        writes("planes", "array<u32>"),
    ];
    bindings.extend(variant.pixel_rays());
    let legs = match variant.rays {
        RaysKind::Curves { .. } => snippets!("volume/curved_legs.wgsl"),
        _ => snippets!("volume/straight_legs.wgsl"),
    };
    let along = match kind {
        VolumeKind::Lit => snippets!("volume/lit.wgsl"),
        _ => snippets!("volume/unlit.wgsl"),
    };
    let seen = match kind {
        VolumeKind::Maximum => snippets!("volume/maximum.wgsl"),
        _ => snippets!("volume/composite.wgsl"),
    };
    let shared = [PARAMS, ITEMS, SLABS, variant.real(), BUNDLE, KEY, variant.camera(), variant.pixel_key()];
    let own = [
        snippets!("volume/layout.wgsl", "volume/cubic.wgsl", "volume/transfer.wgsl"),
        legs,
        along,
        seen,
        snippets!("volume.wgsl"),
    ];
    let mut kernel =
        Kernel::new("volume", bindings, &[&shared[..], variant.pixel(), &own].concat()).with_planes(planes);
    kernel.constants.extend(variant.constants());
    kernel
}

/// After all that is drawn on surfaces and between them.
pub fn volume(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Volume, pixels)
}
