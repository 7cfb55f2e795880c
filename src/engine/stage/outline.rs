//! outline: lines between pixels that differ, over the colours.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::parts::*;
use crate::image::frame::Channel;

/// Lines between pixels, into the colour planes.
pub fn kernel(planes: &[Channel]) -> Kernel {
    let bindings = vec![params(), uniform("style", "Style"), writes("planes", "array<u32>")];
    let snippets = [PARAMS, ITEMS, snippets!("styles/layout.wgsl"), snippets!("outline.wgsl")];
    Kernel::new("outline", bindings, &snippets).with_planes(planes)
}

/// After all bounces of a band.
pub fn outline(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Outline, pixels)
}
