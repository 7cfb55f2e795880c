//! gather: the caustics of the receivers that a band's pixels show, into the colour planes.

use super::{Dispatch, KernelId};

pub fn gather(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Gather, pixels)
}
