//! resolve: the colours of the edge pixels, from their samples.

use super::{Dispatch, KernelId};
use crate::gpu::layout::Counter;

/// After `shade`, for every chunk of the scene from the first on.
pub fn resolve() -> Dispatch {
    Dispatch::counted(KernelId::Resolve, Counter::Edges)
}
