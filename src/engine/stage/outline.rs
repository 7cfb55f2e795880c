//! outline: lines between pixels that differ, over the colours.

use super::{Dispatch, KernelId};

/// After all bounces of a band.
pub fn outline(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Outline, pixels)
}
