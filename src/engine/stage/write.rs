//! write: colour planes to 8-bit sRGB, where shade does not write that itself ([`Variant::writes`](crate::gpu::kernels::Variant::writes)).

use super::{Dispatch, KernelId};
use crate::gpu::kernels::parts::*;
use crate::image::frame::Channel;

pub fn kernel(planes: &[Channel]) -> Kernel {
    let bindings =
        vec![params(), uniform("shading", "Shading"), reads("planes", "array<u32>"), writes("srgb8", "array<u32>")];
    Kernel::new("write", bindings, &[PARAMS, ITEMS, SHADING, snippets!("shared/tone.wgsl", "write.wgsl")])
        .with_planes(planes)
}

pub fn write(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Write, pixels)
}
