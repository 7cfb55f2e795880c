//! small: triangles of few pixels of one piece, drawn by one thread each; the others are listed for bin.

use super::{Dispatch, KernelId};
use crate::gpu::layout::Counter;

pub fn small() -> Dispatch {
    Dispatch::counted(KernelId::Small, Counter::Tasks)
}
