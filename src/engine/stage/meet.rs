//! meet: smooth surfaces into the visibility buffer, once a pixel.

use super::{Dispatch, KernelId};

/// The words of a key go in the steps of [`super::raster::raster_steps`].
pub fn meet(pixels: u32, step: u32) -> Dispatch {
    Dispatch::over(KernelId::Meet, pixels).nth(step)
}
