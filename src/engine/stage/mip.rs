//! mip: the levels of an image, each from the one before; no part of a frame.

use crate::gpu::kernels::parts::*;

pub fn kernel() -> Kernel {
    let coarser = writes_texture("coarser", "texture_storage_2d<rgba16float, write>");
    let bindings = vec![texture("finer", "texture_2d<f32>"), coarser];
    Kernel::new("mip", bindings, &[PARAMS, ITEMS, snippets!("mip.wgsl")])
}
