//! write: colour planes to 8-bit sRGB, where shade does not write that itself ([`Variant::writes`](crate::gpu::kernels::Variant::writes)).

use super::{Dispatch, KernelId};

pub fn write(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Write, pixels)
}
