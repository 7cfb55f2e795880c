//! write: colour planes to 8-bit sRGB.

use super::{Dispatch, KernelId};

pub fn write(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Write, pixels)
}
