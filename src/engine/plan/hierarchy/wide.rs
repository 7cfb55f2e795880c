//! Hierarchies of eight boxes a node. Neighboring items form parts, each part is built by one core, and a small top tree joins all parts.
//!
//! Only the boxes of parts that are being built are held, not those of all items.

use super::crowd;
use crate::arrays::MapEach;
use crate::geometry::bvh;
use crate::parallel;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::cwbvh::node::CwBvhNode;

/// A hierarchy: its nodes, those below a node after it, and the items of its leaves in their order.
pub struct Wide {
    pub nodes: Vec<CwBvhNode>,
    pub items: Vec<u32>,
}

/// Items of a leaf at most.
const LEAF_MAX: u32 = 3;

/// Number of consecutive items in a run, which is never cut. The longer runs are, the more the boxes of parts overlap, and the more nodes
/// a ray enters.
const RUN: u32 = 2;

/// Largest number of runs in a part. Smaller parts are built faster, but their boxes overlap more.
const PART_RUNS: usize = 1 << 16;

/// Least number of parts, so that every core has one to build, unless these have fewer runs than [`PART_RUNS_MIN`].
const PARTS_MIN: usize = 16;
const PART_RUNS_MIN: usize = 1 << 12;

impl Wide {
    /// A hierarchy over items `0..count` with these boxes, of which there is at least one. Consecutive items should be neighbors.
    pub fn build(count: u32, boxed: impl Fn(u32) -> Aabb + Sync) -> Wide {
        let runs = count.div_ceil(RUN) as usize;
        Wide::in_parts(count, (runs / PARTS_MIN).clamp(PART_RUNS_MIN, PART_RUNS), boxed)
    }

    /// Builds a hierarchy as [`Wide::build`] does, of parts with at most `part_runs` runs.
    fn in_parts(count: u32, part_runs: usize, boxed: impl Fn(u32) -> Aabb + Sync) -> Wide {
        let run_items = |run: u32| run * RUN..((run + 1) * RUN).min(count);
        let run_box = |run: u32| run_items(run).map(&boxed).reduce(|a, b| a.union(&b)).unwrap_or_default();
        let parts = bvh::groups(count.div_ceil(RUN), part_runs, |run| in_f64(&run_box(run)));
        let part = |runs: &Vec<u32>| {
            let items: Vec<u32> = runs.iter().flat_map(|run| run_items(*run)).collect();
            let boxes: Vec<Aabb> = items.iter().map(|item| boxed(*item)).collect();
            let mut tree = converted(&boxes, LEAF_MAX);
            tree.primitive_indices.iter_mut().for_each(|k| *k = items[*k as usize]);
            (tree, boxes.into_iter().reduce(|a, b| a.union(&b)).unwrap_or_default())
        };
        let (mut trees, boxes): (Vec<CwBvh>, Vec<Aabb>) = parallel::map(&parts, part).into_iter().unzip();
        match &mut trees[..] {
            [tree] => {
                Wide { nodes: std::mem::take(&mut tree.nodes), items: std::mem::take(&mut tree.primitive_indices) }
            }
            _ => Wide::joined(&converted(&boxes, 1), trees),
        }
    }

    /// The trees as one, below the leaves of `top`, each of which names one of them.
    fn joined(top: &CwBvh, trees: Vec<CwBvh>) -> Wide {
        let mut joining = Joining { top, nodes: vec![CwBvhNode::default()] };
        let mut place_of_root = vec![0; trees.len()];
        joining.place(0, 0, &mut place_of_root);
        let mut wide = Wide { nodes: joining.nodes, items: Vec::new() };
        for (tree, root) in trees.into_iter().zip(place_of_root) {
            // the root has its place above; the others follow
            let (first_node, first_item) = (wide.nodes.len() as u32 - 1, wide.items.len() as u32);
            let mut nodes = tree.nodes.iter().map(|node| CwBvhNode {
                child_base_idx: node.child_base_idx + first_node,
                primitive_base_idx: node.primitive_base_idx + first_item,
                ..*node
            });
            if let Some(first) = nodes.next() {
                wide.nodes[root] = first;
            }
            wide.nodes.extend(nodes);
            wide.items.extend(tree.primitive_indices);
        }
        wide
    }
}

struct Joining<'a> {
    top: &'a CwBvh,
    nodes: Vec<CwBvhNode>,
}

impl Joining<'_> {
    /// Puts a node of `top` at a place that is there already, and all below it behind the others. Leaves become places for the roots of
    /// their trees.
    fn place(&mut self, node: usize, at: usize, place_of_root: &mut [usize]) {
        let mut own = self.top.nodes[node];
        let is_there: Vec<usize> = (0..8).filter(|slot| own.child_meta[*slot] != 0).collect();
        let first = self.nodes.len();
        self.nodes.resize(first + is_there.len(), CwBvhNode::default());
        for (&slot, place) in is_there.iter().zip(first..) {
            if own.is_leaf(slot) {
                let item = own.primitive_base_idx + u32::from(own.child_meta[slot] & 31);
                let tree = self.top.primitive_indices[item as usize] as usize;
                place_of_root[tree] = place;
            } else {
                self.place(own.child_node_index(slot) as usize, place, place_of_root);
            }
        }
        for slot in is_there {
            own.imask |= 1 << slot;
            own.child_meta[slot] = 0b0010_0000 | (24 + slot as u8);
        }
        own.child_base_idx = first as u32;
        self.nodes[at] = own;
    }
}

/// A hierarchy of one core.
fn converted(boxes: &[Aabb], leaf_max: u32) -> CwBvh {
    let params = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
    bvh2_to_cwbvh(&crowd::build(boxes, params), leaf_max, true, false)
}

fn in_f64(b: &Aabb) -> bvh::Aabb {
    let [lo, hi] = [b.min, b.max].map_each(|corner| corner.as_dvec3());
    bvh::Aabb { lo, hi }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::testing::Rng;
    use glam::Vec3A;

    /// The box of a node's child, rounded outwards.
    fn child_box(node: &CwBvhNode, slot: usize) -> Aabb {
        let step = node.e.map_each(|e| f32::from_bits(u32::from(e) << 23));
        let corner = |x: u8, y: u8, z: u8| {
            Vec3A::from(node.p) + Vec3A::new(f32::from(x) * step[0], f32::from(y) * step[1], f32::from(z) * step[2])
        };
        let min = corner(node.child_min_x[slot], node.child_min_y[slot], node.child_min_z[slot]);
        let max = corner(node.child_max_x[slot], node.child_max_y[slot], node.child_max_z[slot]);
        let more = Vec3A::splat(4.0 * f32::EPSILON);
        Aabb { min: min - more, max: max + more }
    }

    /// Each item lies once in a leaf, in all boxes above it, and nodes lie behind the nodes above them.
    pub fn assert_whole(wide: &Wide, boxes: &[Aabb]) {
        let mut found = vec![0; boxes.len()];
        let mut todo = vec![(0, Aabb { min: Vec3A::NEG_INFINITY, max: Vec3A::INFINITY })];
        while let Some((at, within)) = todo.pop() {
            let node = &wide.nodes[at];
            for slot in (0..8).filter(|slot| node.child_meta[*slot] != 0) {
                let own = child_box(node, slot);
                let own = Aabb { min: own.min.max(within.min), max: own.max.min(within.max) };
                if !node.is_leaf(slot) {
                    let below = node.child_node_index(slot) as usize;
                    assert!(below > at);
                    todo.push((below, own));
                    continue;
                }
                let first = node.primitive_base_idx + u32::from(node.child_meta[slot] & 31);
                let count = (node.child_meta[slot] >> 5).count_ones();
                for item in &wide.items[first as usize..][..count as usize] {
                    let b = &boxes[*item as usize];
                    assert!(b.min.cmpge(own.min).all() && b.max.cmple(own.max).all(), "item {item}");
                    found[*item as usize] += 1;
                }
            }
        }
        assert!(found.iter().all(|n| *n == 1));
    }

    #[test]
    fn parts_are_joined_to_one_hierarchy_that_holds_every_item_once() {
        let mut rng = Rng(7);
        let (part_runs, part_items) = (256, 256 * RUN as usize);
        // the first three counts make one part, the fourth two, and the last so many that the top tree has several nodes
        for count in [1, 5, part_items, part_items + 1, 50 * part_items] {
            let corner = |rng: &mut Rng| Vec3A::new(rng.unit() as f32, rng.unit() as f32, rng.unit() as f32);
            let boxes: Vec<Aabb> = (0..count)
                .map(|k| {
                    let min = corner(&mut rng) * 0.1 + Vec3A::splat(0.8 * k as f32 / count as f32);
                    Aabb { min, max: min + corner(&mut rng) * 0.01 }
                })
                .collect();
            let wide = Wide::in_parts(count as u32, part_runs, |k| boxes[k as usize]);
            assert_whole(&wide, &boxes);
            let root = &wide.nodes[0];
            let nodes_below = (0..8).filter(|slot| root.child_meta[*slot] != 0 && !root.is_leaf(*slot)).count();
            assert!(count != part_items + 1 || nodes_below == 2, "{nodes_below} parts");
        }
    }
}
