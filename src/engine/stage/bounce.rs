//! bounce: the ray of every pixel that meets the optics' surface, turned there.

use super::{Dispatch, KernelId};

pub fn bounce(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Bounce, pixels)
}
