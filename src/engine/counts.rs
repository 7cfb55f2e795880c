//! What the stages of a frame counted.

use crate::gpu::layout::{self, COUNTERS, Counter};
use std::ops::AddAssign;

/// Sums over all jobs of a frame.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// (cluster, node) items that cull queued for itself.
    pub cull_items: u64,
    /// (cluster, node) items that split read.
    pub split_items: u64,
    /// (triangle group, node) items that small read, or bin where there is no small.
    pub bin_items: u64,
    /// (triangle, node) items that small left to bin.
    pub large_items: u64,
    /// (triangle, tile) pairs that raster read.
    pub pairs: u64,
    /// Pairs that bin tested. This and the next three are counted only in frames that count fragments.
    pub pairs_tested: u64,
    /// Those with a pixel that the triangle may cover.
    pub pairs_kept: u64,
    /// Pixels of kept pairs that raster tested.
    pub fragments_tested: u64,
    /// Those that the triangle covers.
    pub fragments_kept: u64,
    /// Pixels of triangles whose coverage f32 did not prove.
    pub rechecked: u64,
    /// Pixels with an edge, in frames of several samples.
    pub edges: u64,
    /// Samples of these pixels that recheck_samples reads.
    pub recheck_sample_items: u64,
    /// Pixels that trace took over, as raster cost more.
    pub taken_over: u64,
}

impl Counts {
    /// From the counters of all jobs.
    pub(super) fn of(status: &[u32]) -> Counts {
        let sum = |counter: u32| status.chunks_exact(COUNTERS as usize).map(|s| u64::from(s[counter as usize])).sum();
        Counts {
            // the first counters are those of cull's queues
            cull_items: (0..Counter::Work.index()).map(sum).sum(),
            split_items: sum(Counter::Work.index()),
            bin_items: sum(Counter::Tasks.index()),
            large_items: sum(Counter::Large.index()),
            pairs: sum(Counter::Pairs.index()),
            pairs_tested: sum(Counter::PairsTested.index()),
            pairs_kept: sum(Counter::PairsKept.index()),
            fragments_tested: sum(Counter::FragmentsTested.index()),
            fragments_kept: sum(Counter::FragmentsKept.index()),
            rechecked: sum(Counter::RecheckItems.index()).saturating_sub(sum(Counter::Proven.index())),
            edges: sum(Counter::Edges.index()),
            recheck_sample_items: sum(Counter::RecheckSamples.index()),
            taken_over: sum(Counter::Traced.index()),
        }
    }
}

impl Counts {
    /// What raster cost, in the units of [`crate::gpu::layout::CULL_COST`].
    pub fn raster_cost(&self) -> u64 {
        let costs = [
            (self.cull_items, layout::CULL_COST),
            (self.bin_items, layout::TASK_COST),
            (self.large_items, layout::LARGE_COST),
            (self.pairs, layout::PAIR_COST),
        ];
        costs.into_iter().map(|(items, cost)| items * u64::from(cost)).sum()
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Counts) {
        self.cull_items += other.cull_items;
        self.split_items += other.split_items;
        self.bin_items += other.bin_items;
        self.large_items += other.large_items;
        self.pairs += other.pairs;
        self.pairs_tested += other.pairs_tested;
        self.pairs_kept += other.pairs_kept;
        self.fragments_tested += other.fragments_tested;
        self.fragments_kept += other.fragments_kept;
        self.rechecked += other.rechecked;
        self.edges += other.edges;
        self.recheck_sample_items += other.recheck_sample_items;
        self.taken_over += other.taken_over;
    }
}
