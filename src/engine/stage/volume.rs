//! volume: the light of the scene's volume, over the colours of what lies behind or in it.

use super::{Dispatch, KernelId};

/// After all that is drawn on surfaces and between them.
pub fn volume(pixels: u32) -> Dispatch {
    Dispatch::over(KernelId::Volume, pixels)
}
