//! bin: the triangles of each kept triangle group, or those that small leaves, against the tiles below their node.

use super::{Dispatch, KernelId};
use crate::gpu::kernels::Variant;
use crate::gpu::layout::Counter;

pub fn bin(variant: Variant) -> Dispatch {
    Dispatch::counted(KernelId::Bin, if variant.draws_small() { Counter::Large } else { Counter::Tasks })
}
