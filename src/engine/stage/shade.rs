//! shade: the channels asked for, once a pixel.

use super::{Dispatch, KernelId, Pixels};

pub fn shade(pixels: Pixels) -> Dispatch {
    Dispatch::of_pixels(KernelId::Shade, pixels)
}
