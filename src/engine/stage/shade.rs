//! shade: the channels asked for, once a pixel.

use super::{Dispatch, KernelId, Pixels};
use crate::gpu::kernels::Variant;
use crate::gpu::kernels::parts::*;
use crate::image::frame::Channel;

pub fn kernel(variant: Variant, planes: &[Channel]) -> Kernel {
    let mut bindings = vec![
        params(),
        uniform("shading", "Shading"),
        triangles(),
        vertices(),
        reads("slot_of_id", "array<u32>"),
        table("surfaces"),
        table("normals"),
        table("materials"),
        table("lights"),
        reads("visibility", variant.keys_read()),
        writes("planes", "array<u32>"),
    ];
    bindings.extend(variant.pages());
    bindings.extend(variant.pixel_rays());
    bindings.extend(variant.bounced.then(live));
    bindings.extend(variant.moments());
    bindings.extend(variant.instances());
    if variant.optics.is_some() {
        bindings.extend([optic(), paths()]);
    }
    let snippets = [PARAMS, ITEMS, INDEX, SLABS, variant.vertex(), variant.real(), variant.triangle(), BUNDLE, KEY];
    bindings.extend(variant.style_binding());
    bindings.extend(variant.writes.then(|| writes("srgb8", "array<u32>")));
    let own = [
        variant.camera(),
        SHADING,
        variant.lit_surface(),
        variant.flat_surface(),
        variant.images(),
        variant.thrown_pictures(),
        variant.style(),
        variant.pixel_key(),
        variant.pixel_at(),
        variant.slot(),
        variant.opacity(),
        variant.written(),
        snippets!("shade.wgsl"),
    ];
    let mut all = [&snippets[..], &own[..], &variant.light(), variant.pixel(), variant.seen()].concat();
    all.extend(variant.corner_colors());
    all.extend(variant.leaves());
    all.extend(variant.weights());
    let mut kernel = Kernel::new("shade", bindings, &all).with_planes(planes);
    kernel.constants.extend(variant.constants());
    let follows_rays =
        variant.writes || planes.iter().any(|c| !matches!(c, Channel::T | Channel::A | Channel::TriangleId));
    kernel.constants.push(("FOLLOWS_RAYS", follows_rays as u32 as f64));
    kernel.constants.push(("NORMALS", variant.normals as u32 as f64));
    if let Some(optics) = variant.optics {
        kernel.constants.push(("SMOOTH", optics.is_smooth() as u32 as f64));
    }
    kernel
}

pub fn shade(pixels: Pixels) -> Dispatch {
    Dispatch::of_pixels(KernelId::Shade, pixels)
}
