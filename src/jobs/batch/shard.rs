//! Divides a list into shards of about equal cost; every process computes the same division.

use super::list::Jobs;
use super::manifest::Costs;
use crate::input::Result;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A part of a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Index, from 0.
    pub index: u32,
    /// Number of parts.
    pub count: u32,
}

/// For each frame whether it is in the shard. `costs` holds earlier times; unless it has all, every N-th frame is the shard's, so that
/// results merged while other shards have yet to run do not change those.
pub fn share(jobs: &Jobs, shard: Shard, costs: &Costs) -> Result<Vec<bool>> {
    let known: Vec<Option<f64>> = jobs.tasks().map(|task| costs.of(&task)).collect::<Result<_>>()?;
    Ok(shared(&known, shard))
}

fn shared(costs: &[Option<f64>], shard: Shard) -> Vec<bool> {
    let Some(known) = costs.iter().copied().collect::<Option<Vec<f64>>>() else {
        return (0..costs.len()).map(|k| k % shard.count as usize == shard.index as usize).collect();
    };
    // the most expensive first, each to the shard with the least cost; in integer microseconds, which are totally ordered
    let mut dearest: Vec<(u64, usize)> = known.iter().enumerate().map(|(k, cost)| ((cost * 1e3) as u64, k)).collect();
    dearest.sort_by_key(|&(cost, k)| (Reverse(cost), k));
    let mut loads: BinaryHeap<Reverse<(u64, u32)>> = (0..shard.count).map(|shard| Reverse((0, shard))).collect();
    let mut own = vec![false; costs.len()];
    for (cost, k) in dearest {
        if let Some(Reverse((load, least))) = loads.pop() {
            own[k] = least == shard.index;
            // every frame costs something
            loads.push(Reverse((load + cost.max(1), least)));
        }
    }
    own
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_frame_is_of_one_shard_and_loads_differ_by_one_frame(
            costs in prop::collection::vec(0.1f64..1000.0, 0..60),
            has_all in any::<bool>(),
            count in 1u32..7,
        ) {
            let is_known = |k: usize| has_all || k % 5 != 3;
            let known: Vec<Option<f64>> = costs.iter().enumerate().map(|(k, c)| is_known(k).then_some(*c)).collect();
            let all: Vec<Vec<bool>> = (0..count).map(|index| shared(&known, Shard { index, count })).collect();
            for k in 0..costs.len() {
                prop_assert_eq!(all.iter().filter(|own| own[k]).count(), 1);
            }
            let cost = |k: usize| if known.iter().all(Option::is_some) { costs[k] } else { 1.0 };
            let load = |own: &Vec<bool>| (0..costs.len()).filter(|k| own[*k]).map(cost).sum::<f64>();
            let loads: Vec<f64> = all.iter().map(load).collect();
            let dearest = (0..costs.len()).map(cost).fold(0.0, f64::max);
            // whole microseconds lose one per frame
            let spread = loads.iter().copied().fold(0.0, f64::max) - loads.iter().copied().fold(f64::INFINITY, f64::min);
            prop_assert!(spread <= dearest + 0.001 * costs.len() as f64, "{:?}", loads);
        }
    }
}
