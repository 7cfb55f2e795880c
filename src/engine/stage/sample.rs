//! sample: the samples of the edge pixels against every triangle; pair by pair, or tile by tile, and the recheck of what that leaves
//! uncertain.

use super::{Dispatch, KernelId};
use crate::gpu::layout::Counter;

/// Keys go into the records of samples.
const KEYS: (&str, &str) = ("visibility", "samples");

/// The words of a key go in the steps of [`super::raster::raster_steps`].
pub fn sample(step: u32) -> Dispatch {
    Dispatch::counted(KernelId::Sample, Counter::Pairs).nth(step).with(KEYS.0, KEYS.1)
}

/// What [`super::edges::edges_by_tile`] has listed.
pub fn sample_by_tile() -> [Dispatch; 2] {
    let recheck = Dispatch::counted(KernelId::RecheckSamples, Counter::RecheckSamples);
    [Dispatch::counted(KernelId::SampleByTile, Counter::Blocks), recheck.with(KEYS.0, KEYS.1)]
}
