//! bounce: reflects or refracts the ray of every pixel that meets the optics' surface.

use super::{Dispatch, KernelId, Pixels};

pub fn bounce() -> Dispatch {
    Dispatch::of_pixels(KernelId::Bounce, Pixels::Live)
}
