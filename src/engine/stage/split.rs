//! split: the triangle groups of each kept cluster against the rays of its node.

use super::{Dispatch, KernelId};
use crate::gpu::layout::Counter;

pub fn split() -> Dispatch {
    Dispatch::counted(KernelId::Split, Counter::Work)
}
