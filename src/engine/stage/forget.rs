//! forget: the rays after a bounce that were there before, tile by tile.

use super::{Dispatch, KernelId, Number, Threads};

pub fn forget() -> Dispatch {
    Dispatch { threads: Threads::Counted(Number::Tiles("bounced_live")), ..Dispatch::over(KernelId::Forget, 0) }
}
