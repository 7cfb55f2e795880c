//! shade: the channels asked for, once a pixel.

use super::{Dispatch, KernelId};

pub fn shade(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Shade, pixels)
}
