//! trace: the nearest triangle of each pixel, through a bounding volume hierarchy.

use super::{Dispatch, KernelId, Pixels};
use crate::gpu::kernels::parts::*;
use crate::gpu::kernels::{RaysKind, Variant};
use crate::gpu::layout::Counter;

pub fn kernel(variant: Variant) -> Kernel {
    let path = match variant.rays {
        RaysKind::Pieces => {
            snippets!(
                "camera/pieces_path.wgsl",
                "shared/places.wgsl",
                "camera/straight_stretch.wgsl",
                "camera/straight_seen.wgsl"
            )
        }
        RaysKind::Field => {
            snippets!(
                "camera/field_path.wgsl",
                "shared/places.wgsl",
                "camera/straight_stretch.wgsl",
                "camera/straight_seen.wgsl"
            )
        }
        RaysKind::Curves { .. } => snippets!("camera/curves_path.wgsl"),
    };
    let pixels = if variant.bounced { LIVE_PIXELS } else { snippets!("shared/every_tile.wgsl") };
    let hierarchy = match variant.timed {
        true => snippets!("shared/bvh8.wgsl", "shared/bvh_triangle_timed.wgsl"),
        false => snippets!("shared/bvh8.wgsl", "shared/bvh_triangle.wgsl"),
    };
    let primitives = match (variant.spheres, variant.rays) {
        (false, _) => snippets!("shared/only_triangles.wgsl"),
        (true, RaysKind::Curves { .. }) => {
            snippets!("shared/sphere.wgsl", "shared/sphere_chord.wgsl", "camera/curves_sphere.wgsl")
        }
        (true, _) => snippets!("shared/sphere.wgsl", "camera/straight_sphere.wgsl"),
    };
    let followed = match variant.instanced {
        true => snippets!("shared/followed.wgsl", "camera/straight_placed.wgsl", "shared/followed_placed.wgsl"),
        false => snippets!("shared/followed.wgsl", "shared/followed_whole.wgsl"),
    };
    let own = [pixels, path, hierarchy, primitives, followed, snippets!("trace.wgsl")];
    let holes: &[Parts] = if variant.rechecks() { &[variant.holes()] } else { &[] };
    let mut kernel = super::raster::into_visibility("trace", variant, &[variant.pixel(), &own, holes].concat());
    kernel.bindings.extend([table("bvh"), table("bvh_triangles")]);
    if variant.bounced {
        kernel.bindings.push(live());
    }
    if variant.rechecks() {
        kernel.constants.push(("ALL_UNCERTAIN", f64::from(u8::from(variant.all_uncertain))));
    }
    kernel
}

/// Over the pixels of tiles.
pub fn trace(pixels: Pixels, step: u32) -> Dispatch {
    Dispatch::of_pixels(KernelId::Trace, pixels).nth(step)
}

/// Over all pixels, where it takes over from raster.
pub fn take_over(step: u32) -> Dispatch {
    Dispatch::counted(KernelId::Trace, Counter::Traced).nth(step)
}
