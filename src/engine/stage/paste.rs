//! paste: what facets show, from an atlas where each has a triangle of its own.

use super::{Dispatch, KernelId};

pub fn paste(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Paste, pixels)
}
