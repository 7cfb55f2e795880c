//! What the stages counted in one frame.

use crate::gpu::rows::{
    COUNT_DOUBTS, COUNT_EDGES, COUNT_FRAGMENTS_KEPT, COUNT_FRAGMENTS_TESTED, COUNT_PAIRS, COUNT_PAIRS_KEPT,
    COUNT_PAIRS_TESTED, COUNT_RECHECKED, COUNT_SAMPLE_DOUBTS, COUNT_TASKS, COUNT_WORK, COUNTERS,
};
use std::ops::AddAssign;

/// Sums over all jobs of a frame.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// (cluster, node) items that cull queued for its next steps.
    pub cull_items: u64,
    /// (cluster, node) items that split took.
    pub split_items: u64,
    /// (bunch, node) items that bin took.
    pub bin_items: u64,
    /// (triangle, tile) pairs that raster took.
    pub pairs: u64,
    /// Of these four the pairs that bin looked at, those with a pixel that the triangle may cover, and pixels of these that were tested and
    /// that are covered: where frames count fragments.
    pub pairs_tested: u64,
    pub pairs_kept: u64,
    pub fragments_tested: u64,
    pub fragments_kept: u64,
    /// Half tiles of pairs that recheck took.
    pub recheck_items: u64,
    /// Pixels of pairs whose signs f32 did not prove.
    pub rechecked: u64,
    /// Pixels that hold an edge, where they have several samples.
    pub edges: u64,
    /// Samples of these that settle took.
    pub settle_items: u64,
}

impl Counts {
    /// From the counters of all jobs.
    pub(super) fn of(status: &[u32]) -> Counts {
        let sum = |counter: u32| status.chunks_exact(COUNTERS as usize).map(|s| u64::from(s[counter as usize])).sum();
        Counts {
            // the queues of the steps come first
            cull_items: (0..COUNT_WORK).map(sum).sum(),
            split_items: sum(COUNT_WORK),
            bin_items: sum(COUNT_TASKS),
            pairs: sum(COUNT_PAIRS),
            pairs_tested: sum(COUNT_PAIRS_TESTED),
            pairs_kept: sum(COUNT_PAIRS_KEPT),
            fragments_tested: sum(COUNT_FRAGMENTS_TESTED),
            fragments_kept: sum(COUNT_FRAGMENTS_KEPT),
            recheck_items: sum(COUNT_DOUBTS),
            rechecked: sum(COUNT_RECHECKED),
            edges: sum(COUNT_EDGES),
            settle_items: sum(COUNT_SAMPLE_DOUBTS),
        }
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Counts) {
        self.cull_items += other.cull_items;
        self.split_items += other.split_items;
        self.bin_items += other.bin_items;
        self.pairs += other.pairs;
        self.pairs_tested += other.pairs_tested;
        self.pairs_kept += other.pairs_kept;
        self.fragments_tested += other.fragments_tested;
        self.fragments_kept += other.fragments_kept;
        self.recheck_items += other.recheck_items;
        self.rechecked += other.rechecked;
        self.edges += other.edges;
        self.settle_items += other.settle_items;
    }
}
