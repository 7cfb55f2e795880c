//! cull: clusters against the tree of nodes, one dispatch a step down.

use super::{Dispatch, KernelId, Number, Threads};
use crate::arrays::MapEach;

/// The two queues between the steps; step k reads the first when k is even.
const QUEUES: [&str; 2] = ["queue_even", "queue_odd"];

/// The descent of `clusters` clusters in [`crate::engine::plan::nodes::Nodes::cull_steps`].
pub fn cull(clusters: u32, steps: u32) -> Vec<Dispatch> {
    let step = |k: u32| {
        let [queue_in, queue_out] = [k, k + 1].map_each(|k| QUEUES[k as usize % 2]);
        let threads = if k == 0 { Threads::Items(clusters) } else { Threads::Counted(Number::Index(k)) };
        let dispatch = Dispatch { threads, ..Dispatch::over(KernelId::Cull, clusters).nth(k) };
        dispatch.with("queue_in", queue_in).with("queue_out", queue_out)
    };
    (0..steps).map(step).collect()
}
