//! certify: what is proven of what raster and recheck found, for the channel of that name.

use super::{Dispatch, KernelId};
use crate::gpu::layout::Counter;

/// How many times all pairs must pass `certify`, after all steps of raster.
pub const CERTIFY_STEPS: u32 = 2;

pub fn certify(step: u32) -> Dispatch {
    Dispatch::counted(KernelId::Certify, Counter::Pairs).nth(step)
}

/// Writes the plane, once all pairs have passed.
pub fn write_certified(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Certify, pixels).nth(CERTIFY_STEPS)
}
