//! recheck: what raster left uncertain, in recheck arithmetic.

use super::{Dispatch, KernelId};
use crate::gpu::layout::Counter;

/// After every step of raster, of variants with [`crate::gpu::kernels::Variant::rechecks`].
pub fn recheck(step: u32) -> Dispatch {
    Dispatch::counted(KernelId::Recheck, Counter::RecheckItems).nth(step)
}
