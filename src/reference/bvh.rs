//! A bounding volume hierarchy over triangles, in f64.

use crate::parallel;
use glam::DVec3;

/// Most triangles in a leaf.
const LEAF: usize = 4;
/// Bins along the longest side for the surface area heuristic.
const BINS: usize = 16;
/// Deeper nodes split at the median, so that the depth stays under `MAX_SAH_DEPTH` + 31 for any u32 count.
const MAX_SAH_DEPTH: u32 = 36;
/// One pending sibling per level, and the current node.
const STACK: usize = 72;
/// Subtrees of at least this many triangles are built in parallel.
const PARALLEL: usize = 1 << 14;

/// Nodes in depth-first order: the first child of `k` is `k + 1`.
#[derive(Debug, Default)]
pub struct Bvh {
    nodes: Vec<Node>,
    /// Triangle ids; a leaf owns a run of them.
    order: Vec<u32>,
}

/// A query against boxes: rays or curves.
pub trait Probe {
    /// An interval that contains every `t` in `range` at which some ray or curve is in the box `lo..hi`.
    fn span(&self, lo: DVec3, hi: DVec3, range: [f64; 2]) -> Option<[f64; 2]>;
}

/// One triangle to be inserted.
#[derive(Debug, Clone, Copy)]
pub struct Item {
    pub lo: DVec3,
    pub hi: DVec3,
    pub id: u32,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    lo: DVec3,
    hi: DVec3,
    /// Leaf: start in `order`. Inner node: the second child's index less this node's.
    link: u32,
    /// Triangles of a leaf; 0 marks an inner node.
    count: u32,
}

impl Bvh {
    pub fn build(mut items: Vec<Item>) -> Bvh {
        let mut nodes = Vec::new();
        if !items.is_empty() {
            grow(&mut items, 0, 0, &mut nodes);
        }
        Bvh { nodes, order: items.iter().map(|i| i.id).collect() }
    }

    /// Visits every triangle whose box the probe meets at a `t` in `range`, mostly near to far. `visit` returns
    /// the largest `t` still of interest.
    pub fn walk(&self, probe: &impl Probe, range: [f64; 2], visit: impl FnMut(u32) -> f64) {
        self.walk_boxes(probe, |corners| corners, range, visit);
    }

    /// The same with each box where `placed` puts it.
    pub fn walk_boxes(
        &self,
        probe: &impl Probe,
        placed: impl Fn((DVec3, DVec3)) -> (DVec3, DVec3),
        range: [f64; 2],
        mut visit: impl FnMut(u32) -> f64,
    ) {
        let [t_min, mut t_max] = range;
        let enter = |k: usize, t_max: f64| {
            let node = self.nodes.get(k)?;
            let (lo, hi) = placed((node.lo, node.hi));
            probe.span(lo, hi, [t_min, t_max]).map(|s| (k, s[0]))
        };
        let mut stack = [(0_usize, 0.0_f64); STACK];
        let mut top = 0;
        let mut next = enter(0, t_max);
        loop {
            let Some((k, _)) = next else {
                if top == 0 {
                    return;
                }
                top -= 1;
                next = Some(stack[top]).filter(|s| s.1 <= t_max);
                continue;
            };
            let node = &self.nodes[k];
            if node.count > 0 {
                for &id in &self.order[node.link as usize..(node.link + node.count) as usize] {
                    t_max = t_max.min(visit(id));
                }
                next = None;
                continue;
            }
            next = match (enter(k + 1, t_max), enter(k + node.link as usize, t_max)) {
                (Some(a), Some(b)) => {
                    let (near, far) = if b.1 < a.1 { (b, a) } else { (a, b) };
                    stack[top] = far;
                    top += 1;
                    Some(near)
                }
                (a, b) => a.or(b),
            };
        }
    }
}

/// Appends the subtree over `items`, which are `order[first..]` in the end.
fn grow(items: &mut [Item], first: u32, depth: u32, nodes: &mut Vec<Node>) {
    let at = nodes.len();
    let (lo, hi) = bounds(items.iter().map(|i| (i.lo, i.hi)));
    nodes.push(Node { lo, hi, link: first, count: items.len() as u32 });
    if items.len() <= LEAF {
        return;
    }
    let parallel = items.len() >= PARALLEL;
    let middle = split(items, depth);
    let (a, b) = items.split_at_mut(middle);
    let first_b = first + middle as u32;
    if parallel {
        let (mut nodes_a, mut nodes_b) = (Vec::new(), Vec::new());
        let mut grow_a = || grow(a, first, depth + 1, &mut nodes_a);
        parallel::both(&mut grow_a, &mut || grow(b, first_b, depth + 1, &mut nodes_b));
        nodes.append(&mut nodes_a);
        nodes[at].link = (nodes.len() - at) as u32;
        nodes.append(&mut nodes_b);
    } else {
        grow(a, first, depth + 1, nodes);
        nodes[at].link = (nodes.len() - at) as u32;
        grow(b, first_b, depth + 1, nodes);
    }
    nodes[at].count = 0;
}

/// The box around boxes.
pub fn bounds(boxes: impl Iterator<Item = (DVec3, DVec3)>) -> (DVec3, DVec3) {
    boxes.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), (a, b)| (lo.min(a), hi.max(b)))
}

/// Twice the centre of an item's box.
fn centre(item: &Item) -> DVec3 {
    item.lo + item.hi
}

/// Reorders `items` and returns where the second part starts: neither part is empty.
fn split(items: &mut [Item], depth: u32) -> usize {
    let (lo, hi) = bounds(items.iter().map(|i| (centre(i), centre(i))));
    let axis = (hi - lo).max_position();
    let extent = hi[axis] - lo[axis];
    if depth < MAX_SAH_DEPTH && extent > 0.0 {
        let bin = |item: &Item| (((centre(item)[axis] - lo[axis]) * (BINS as f64 / extent)) as usize).min(BINS - 1);
        let last = best_bin(items, bin);
        let middle = partition(items, |i| last.is_some_and(|last| bin(i) <= last));
        if middle > 0 && middle < items.len() {
            return middle;
        }
    }
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| centre(a)[axis].total_cmp(&centre(b)[axis]).then(a.id.cmp(&b.id)));
    middle
}

#[derive(Clone, Copy)]
struct Bin {
    lo: DVec3,
    hi: DVec3,
    count: usize,
}

impl Bin {
    const EMPTY: Bin = Bin { lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY, count: 0 };

    fn join(&mut self, other: &Bin) {
        self.lo = self.lo.min(other.lo);
        self.hi = self.hi.max(other.hi);
        self.count += other.count;
    }

    /// Half the surface times the count; 0 when empty.
    fn cost(&self) -> f64 {
        if self.count == 0 {
            return 0.0;
        }
        let e = self.hi - self.lo;
        (e.x * e.y + e.y * e.z + e.z * e.x) * self.count as f64
    }
}

/// The last bin of the first part with the least surface area cost; `None` when all centres fall into one bin or the cost is not a number.
fn best_bin(items: &[Item], bin: impl Fn(&Item) -> usize) -> Option<usize> {
    let mut bins = [Bin::EMPTY; BINS];
    for item in items {
        bins[bin(item)].join(&Bin { lo: item.lo, hi: item.hi, count: 1 });
    }
    let mut after = [Bin::EMPTY; BINS];
    for b in (0..BINS - 1).rev() {
        after[b] = after[b + 1];
        after[b].join(&bins[b + 1]);
    }
    let (mut best, mut best_cost) = (None, f64::INFINITY);
    let mut before = Bin::EMPTY;
    for b in 0..BINS - 1 {
        before.join(&bins[b]);
        let cost = before.cost() + after[b].cost();
        if before.count > 0 && after[b].count > 0 && cost < best_cost {
            (best, best_cost) = (Some(b), cost);
        }
    }
    best
}

/// Moves the items with `first` to the front and returns their number.
fn partition(items: &mut [Item], first: impl Fn(&Item) -> bool) -> usize {
    let (mut from, mut to) = (0, items.len());
    while from < to {
        if first(&items[from]) {
            from += 1;
        } else {
            to -= 1;
            items.swap(from, to);
        }
    }
    from
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(bvh: &Bvh, k: usize, depth: usize) -> (usize, usize) {
        let node = bvh.nodes[k];
        if node.count > 0 {
            assert!(node.count as usize <= LEAF);
            return (node.count as usize, depth);
        }
        let (a, b) = (k + 1, k + node.link as usize);
        for c in [a, b] {
            assert!(bvh.nodes[c].lo.cmpge(node.lo).all() && bvh.nodes[c].hi.cmple(node.hi).all());
        }
        let (na, da) = check(bvh, a, depth + 1);
        let (nb, db) = check(bvh, b, depth + 1);
        (na + nb, da.max(db))
    }

    #[test]
    fn every_item_is_in_one_leaf_and_the_stack_is_deep_enough() {
        // All in one place, on a line, and at distances that defeat bins (each split takes one item).
        let same = |_: u32| DVec3::ONE;
        let line = |k: u32| DVec3::new(f64::from(k), 0.0, 0.0);
        let steep = |k: u32| DVec3::new(0.5_f64.powi((k % 900) as i32), 0.0, 0.0);
        for place in [&same as &dyn Fn(u32) -> DVec3, &line, &steep] {
            for n in [1, 4, 5, 100, 40_000] {
                let items = (0..n).map(|id| Item { lo: place(id), hi: place(id), id }).collect();
                let bvh = Bvh::build(items);
                let (count, depth) = check(&bvh, 0, 0);
                assert_eq!(count, n as usize);
                assert!(depth < STACK);
                let mut ids = bvh.order.clone();
                ids.sort_unstable();
                assert!(ids.into_iter().eq(0..n));
            }
        }
        assert!(Bvh::build(Vec::new()).nodes.is_empty());
    }
}
