//! meet: smooth surfaces into the visibility buffer, once a pixel.

use super::{Dispatch, KernelId, Pixels};

/// The words of a key go in the steps of [`super::raster::raster_steps`].
pub fn meet(step: u32) -> Dispatch {
    Dispatch::of_pixels(KernelId::Meet, Pixels::Live).nth(step)
}
