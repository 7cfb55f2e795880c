//! reach: the tiles of a camera's own rays that may meet its optics.

use super::{Dispatch, KernelId};

pub fn reach(tiles: u32) -> Dispatch {
    Dispatch::over(KernelId::Reach, tiles)
}
