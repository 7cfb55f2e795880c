//! trace: the nearest triangle of each pixel, through a bounding volume hierarchy.

use super::{Dispatch, KernelId, Pixels};
use crate::gpu::layout::Counter;

/// Over the pixels of tiles.
pub fn trace(pixels: Pixels, step: u32) -> Dispatch {
    Dispatch::of_pixels(KernelId::Trace, pixels).nth(step)
}

/// Over all pixels, where it takes over from raster.
pub fn take_over(step: u32) -> Dispatch {
    Dispatch::counted(KernelId::Trace, Counter::Traced).nth(step)
}
