//! bin: the triangles of each kept triangle group against the tiles below its node.

use super::{Dispatch, KernelId};
use crate::gpu::layout::Counter;

pub fn bin() -> Dispatch {
    Dispatch::counted(KernelId::Bin, Counter::Tasks)
}
