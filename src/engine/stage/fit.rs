//! fit: the tree of nodes over rays after a bounce, a level a dispatch, tiles first.

use super::{Dispatch, KernelId};
use crate::engine::plan::nodes::Level;

pub fn fit(levels: &[Level]) -> Vec<Dispatch> {
    let level = |(n, level): (u32, &Level)| Dispatch::over(KernelId::Fit, level.width * level.height).nth(n);
    (0..).zip(levels).map(level).collect()
}
