//! gather: the caustics of the receivers that a band's pixels show, into the colour planes.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::Variant;
use crate::gpu::kernels::parts::*;
use crate::image::frame::Channel;

/// Caustics into the colour planes, after `shade`.
pub fn kernel(variant: Variant, planes: &[Channel]) -> Kernel {
    let mut bindings = vec![
        params(),
        reads("visibility", "array<u32>"),
        reads("receiver_triangle_of", "array<u32>"),
        reads("receiver_triangles", "array<ReceiverTriangle>"),
        reads("receivers", "array<Receiver>"),
        reads("sums", "array<u32>"),
        writes("planes", "array<u32>"),
    ];
    // of keys the ids alone are read
    let snippets = [PARAMS, ITEMS, SLABS, REAL_F32, KEY, CAUSTICS, snippets!("gather.wgsl")];
    let seen: &[Parts] = if variant.optics.is_some() {
        bindings.extend([optic(), paths()]);
        &[OPTICS_LAYOUT, snippets!("caustics/bounced.wgsl")]
    } else {
        &[snippets!("caustics/plain.wgsl")]
    };
    let mut kernel = Kernel::new("gather", bindings, &[&snippets[..], seen].concat()).with_planes(planes);
    kernel.constants.push(("SLABBED", variant.slabbed as u32 as f64));
    kernel
}

pub fn gather(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Gather, pixels)
}
