//! A bounding volume hierarchy over items: nodes of eight boxes in f32, leaves of four items, split where boxes become smallest.
//!
//! Boxes are relative to the middle of all items, scaled to within 1, and rounded outwards: no box that a ray enters is left out.

use crate::arrays::MapEach;
use crate::parallel;
use glam::DVec3;

/// Boxes of a node.
pub const WIDTH: usize = 8;

/// Items of a leaf.
pub const LEAF: usize = 4;

/// The box of all points between two corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    pub lo: DVec3,
    pub hi: DVec3,
}

/// Boxes over numbered items.
#[derive(Debug)]
pub struct Bvh {
    /// The root first.
    nodes: Vec<Node>,
    /// Ids of the items, [`LEAF`] a leaf; [`NONE`] where a leaf has fewer.
    order: Vec<u32>,
    frame: Frame,
}

/// The id of no item.
pub const NONE: u32 = u32::MAX;

/// How world coordinates become those of boxes: `(x - centre) * scale`, the scale a power of two.
#[derive(Debug, Clone, Copy)]
struct Frame {
    centre: DVec3,
    scale: f64,
}

/// Eight boxes, and what is in each. Boxes that are not there are empty.
#[derive(Debug, Clone)]
#[repr(align(32))]
struct Node {
    lo: [[f32; WIDTH]; 3],
    hi: [[f32; WIDTH]; 3],
    /// A node, or with [`IS_LEAF`] a leaf.
    inside: [u32; WIDTH],
}

const IS_LEAF: u32 = 1 << 31;

/// What is in a box that is not there.
const NOTHING: u32 = u32::MAX;

/// Nothing is in it.
const EMPTY: Node =
    Node { lo: [[f32::INFINITY; WIDTH]; 3], hi: [[f32::NEG_INFINITY; WIDTH]; 3], inside: [NOTHING; WIDTH] };

/// By how much a coordinate relative to the centre may be off, against the sizes of both: two differences,
/// doubled.
const FRAME_ROUNDING: f64 = 2.0 * f64::EPSILON;

/// Places along an axis between which items are split.
const BINS: usize = 16;

/// Groups of fewer items are built by one thread.
const TASK: usize = 4096;

impl Aabb {
    pub const EMPTY: Aabb = Aabb { lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY };

    pub fn around(points: &[DVec3]) -> Aabb {
        points.iter().fold(Aabb::EMPTY, |b, p| Aabb { lo: b.lo.min(*p), hi: b.hi.max(*p) })
    }

    fn joined(self, other: Aabb) -> Aabb {
        Aabb { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// The distance from a point to the box; 0 inside.
    fn distance(&self, p: DVec3) -> f64 {
        (p.max(self.lo).min(self.hi) - p).length()
    }
}

/// The largest f32 number up to `x`, and the least from it on.
fn below(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) > x { near.next_down() } else { near }
}

fn above(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x { near.next_up() } else { near }
}

impl Frame {
    fn of(all: &Aabb) -> Frame {
        let centre = all.lo / 2.0 + all.hi / 2.0;
        let reach = (all.hi / 2.0 - all.lo / 2.0).max_element();
        // of a scene of any size a number that is neither 0 nor infinite
        let exponent = reach.log2().ceil().clamp(-900.0, 1000.0);
        Frame { centre, scale: (-exponent).exp2() }
    }

    /// Bounds on a coordinate.
    fn ends(&self, x: DVec3) -> [[f32; 2]; 3] {
        let (near, off) = (x - self.centre, FRAME_ROUNDING * (x.abs() + self.centre.abs()));
        [0, 1, 2].map_each(|k| [below((near[k] - off[k]) * self.scale), above((near[k] + off[k]) * self.scale)])
    }

    fn boxed(&self, id: u32, b: &Aabb) -> Item {
        let (lo, hi) = (self.ends(b.lo), self.ends(b.hi));
        Item { lo: lo.map_each(|ends| ends[0]), hi: hi.map_each(|ends| ends[1]), id }
    }
}

/// An item's box, or that of several.
#[derive(Debug, Clone, Copy)]
struct Item {
    lo: [f32; 3],
    hi: [f32; 3],
    id: u32,
}

impl Item {
    const EMPTY: Item = Item { lo: [f32::INFINITY; 3], hi: [f32::NEG_INFINITY; 3], id: NONE };

    fn around(items: &[Item]) -> Item {
        items.iter().fold(Item::EMPTY, |all, item| all.joined(item))
    }

    fn joined(self, other: &Item) -> Item {
        let (mut lo, mut hi) = (self.lo, self.hi);
        for k in 0..3 {
            (lo[k], hi[k]) = (lo[k].min(other.lo[k]), hi[k].max(other.hi[k]));
        }
        Item { lo, hi, id: NONE }
    }

    /// Twice its middle.
    fn middle(&self, axis: usize) -> f32 {
        self.lo[axis] + self.hi[axis]
    }

    /// Half of its surface; 0 where it is empty.
    fn area(&self) -> f32 {
        let [x, y, z] = [0, 1, 2].map_each(|k| (self.hi[k] - self.lo[k]).max(0.0));
        x * y + y * z + z * x
    }
}

/// What is in a box.
enum Tree {
    Leaf([u32; LEAF]),
    Node(Vec<(Item, Tree)>),
}

/// A leaf, or a node of several groups.
fn tree(items: &mut [Item]) -> Tree {
    if items.len() <= LEAF {
        let mut ids = [NONE; LEAF];
        ids.iter_mut().zip(items).for_each(|(id, item)| *id = item.id);
        return Tree::Leaf(ids);
    }
    let is_large = items.len() > TASK;
    let mut groups = vec![(Item::around(items), items)];
    // the largest is split first
    while groups.len() < WIDTH {
        let open = (0..groups.len()).filter(|k| groups[*k].1.len() > LEAF);
        let Some(k) = open.max_by(|a, b| groups[*a].0.area().total_cmp(&groups[*b].0.area())) else { break };
        let (_, items) = groups.swap_remove(k);
        let at = split(items);
        let (left, right) = items.split_at_mut(at);
        groups.push((Item::around(left), left));
        groups.push((Item::around(right), right));
    }
    let mut below: Vec<(Item, Tree)> = groups.iter().map(|(around, _)| (*around, Tree::Leaf([NONE; LEAF]))).collect();
    let all = groups.into_iter().zip(&mut below);
    let grow = |((_, items), (_, below)): ((Item, &mut [Item]), &mut (Item, Tree))| *below = tree(items);
    if is_large {
        parallel::for_each(all, grow)
    } else {
        all.for_each(grow)
    }
    Tree::Node(below)
}

/// Sorts items into two groups, of which the second begins at the index that is returned: along the axis on which their middles are farthest
/// apart, where the groups' surfaces, each times its count, have the least sum.
fn split(items: &mut [Item]) -> usize {
    let ends = |axis: usize| {
        let each = items.iter().map(|item| item.middle(axis));
        each.fold([f32::INFINITY, f32::NEG_INFINITY], |[lo, hi], x| [lo.min(x), hi.max(x)])
    };
    let ends = [0, 1, 2].map_each(ends);
    let extent = |axis: &usize| ends[*axis][1] - ends[*axis][0];
    let axis = (0..3).max_by(|a, b| extent(a).total_cmp(&extent(b))).unwrap_or(0);
    let scale = BINS as f32 / extent(&axis);
    // NaN where all are in one place becomes 0
    let bin = |item: &Item| (((item.middle(axis) - ends[axis][0]) * scale) as usize).min(BINS - 1);
    let mut bins = [(Item::EMPTY, 0usize); BINS];
    for item in items.iter() {
        let (around, count) = &mut bins[bin(item)];
        (*around, *count) = (around.joined(item), *count + 1);
    }
    let costs = |bins: &mut dyn Iterator<Item = &(Item, usize)>| -> Vec<f32> {
        let (mut around, mut count) = (Item::EMPTY, 0);
        let cost = |(own, n): &(Item, usize)| {
            (around, count) = (around.joined(own), count + n);
            around.area() * count as f32
        };
        bins.map(cost).collect()
    };
    let (left, right) = (costs(&mut bins.iter()), costs(&mut bins.iter().rev()));
    let cost = |k: &usize| left[k - 1] + right[BINS - 1 - k];
    let best = (1..BINS).min_by(|a, b| cost(a).total_cmp(&cost(b))).unwrap_or(1);
    let at = bring_first(items, |item| bin(item) < best);
    if at == 0 || at == items.len() { items.len() / 2 } else { at }
}

/// Divides boxes `0..count` into groups of neighbors, each of at most `most`, and returns their numbers.
pub fn groups(count: u32, most: usize, boxed: impl Fn(u32) -> Aabb + Sync) -> Vec<Vec<u32>> {
    let all = parallel::reduce(0..count, |k| Some(boxed(k)), Aabb::joined).unwrap_or(Aabb::EMPTY);
    let frame = Frame::of(&all);
    let mut items: Vec<Item> = parallel::map(0..count, |k| frame.boxed(k, &boxed(k)));
    let mut todo = vec![items.as_mut_slice()];
    let mut groups = Vec::new();
    while let Some(items) = todo.pop() {
        if items.len() <= most {
            groups.push(items.iter().map(|item| item.id).collect());
            continue;
        }
        let at = split(items);
        let (left, right) = items.split_at_mut(at);
        todo.extend([right, left]);
    }
    groups
}

/// Brings the items that are `first` before the others; how many they are.
fn bring_first(items: &mut [Item], first: impl Fn(&Item) -> bool) -> usize {
    let mut count = 0;
    for k in 0..items.len() {
        if first(&items[k]) {
            items.swap(count, k);
            count += 1;
        }
    }
    count
}

impl Bvh {
    /// A hierarchy over items with these ids and boxes, which are finite.
    pub fn build(items: &[(u32, Aabb)]) -> Bvh {
        let all = parallel::reduce(items, |(_, b)| Some(*b), Aabb::joined).unwrap_or(Aabb::EMPTY);
        let frame = Frame::of(&all);
        let mut items: Vec<Item> = parallel::map(items, |(id, b)| frame.boxed(*id, b));
        let mut bvh = Bvh { nodes: Vec::new(), order: Vec::new(), frame };
        let below = match tree(&mut items) {
            Tree::Node(below) => below,
            Tree::Leaf(_) if items.is_empty() => Vec::new(),
            leaf => vec![(Item::around(&items), leaf)],
        };
        bvh.add(below);
        bvh
    }

    /// Adds a node and all below it; its index.
    fn add(&mut self, below: Vec<(Item, Tree)>) -> u32 {
        let own = self.nodes.len();
        self.nodes.push(EMPTY);
        for (lane, (around, below)) in below.into_iter().enumerate() {
            let inside = match below {
                Tree::Node(below) => self.add(below),
                Tree::Leaf(ids) => {
                    self.order.extend(ids);
                    IS_LEAF | (self.leaf_count() - 1) as u32
                }
            };
            let node = &mut self.nodes[own];
            node.inside[lane] = inside;
            for axis in 0..3 {
                (node.lo[axis][lane], node.hi[axis][lane]) = (around.lo[axis], around.hi[axis]);
            }
        }
        own as u32
    }

    /// How many leaves there are.
    pub fn leaf_count(&self) -> usize {
        self.order.len() / LEAF
    }

    /// The ids of a leaf's items; [`NONE`] where it has fewer.
    pub fn leaf(&self, leaf: usize) -> [u32; LEAF] {
        self.order.as_chunks().0[leaf]
    }

    /// A ray against the boxes.
    pub fn ray(&self, origin: DVec3, direction: DVec3, [from, to]: [f64; 2]) -> BoxRay {
        let size = direction.abs().max_element();
        let inverse = (size / direction).to_array().map_each(|v| v as f32);
        // a component so small that f32 does not hold its inverse bounds nothing; one of 0 does
        let inverse =
            [0, 1, 2].map_each(|k| if inverse[k].is_infinite() && direction[k] != 0.0 { f32::NAN } else { inverse[k] });
        let scale = [self.frame.scale, size];
        let scaled = |t: f64| t * scale[0] * scale[1];
        BoxRay { origin: self.frame.ends(origin), inverse, ends: [below(scaled(from)), above(scaled(to))], scale }
    }

    /// Visits the leaves that any of some rays enters, mostly near to far. The rays have about one direction. `visit` is given a leaf's number
    /// and returns the largest t that still matters.
    pub fn walk_rays<const N: usize>(&self, rays: &[BoxRay; N], mut visit: impl FnMut(usize) -> f64) {
        let [scale, size] = rays[0].scale;
        self.walk(
            |node| {
                let mut near = rays[0].enter(node);
                for ray in &rays[1..] {
                    let other = ray.enter(node);
                    (0..WIDTH).for_each(|k| near[k] = near[k].min(other[k]));
                }
                near
            },
            |leaf| above(visit(leaf) * scale * size),
        );
    }

    /// Visits leaves by the distance of their boxes to a place, mostly near to far. `visit` is given a leaf's number and returns the largest
    /// distance that still matters.
    pub fn walk_from(&self, place: DVec3, mut visit: impl FnMut(usize) -> f64) {
        let Frame { centre, scale } = self.frame;
        let off = FRAME_ROUNDING * (place.abs() + centre.abs()).max_element() * scale;
        let near = |node: &Node| {
            let corner =
                |ends: &[[f32; WIDTH]; 3], k: usize| DVec3::from([0, 1, 2].map_each(|axis| f64::from(ends[axis][k])));
            [0, 1, 2, 3, 4, 5, 6, 7].map(|k| {
                let b = Aabb { lo: corner(&node.lo, k), hi: corner(&node.hi, k) };
                // of an empty box infinite, which is not near
                let distance = b.distance((place - centre) * scale);
                if b.lo.x > b.hi.x { f32::NAN } else { below((distance - 2.0 * off) * (1.0 - 4.0 * f64::EPSILON)) }
            })
        };
        self.walk(near, |leaf| above(visit(leaf) * scale));
    }

    /// `near` gives for each box of a node a lower bound of the distance to what is in it, or NaN for boxes to leave out.
    fn walk(&self, near: impl Fn(&Node) -> [f32; WIDTH], mut visit: impl FnMut(usize) -> f32) {
        let mut limit = f32::INFINITY;
        let mut todo: Vec<(f32, u32)> = Vec::with_capacity(64);
        todo.push((f32::NEG_INFINITY, 0));
        while let Some((distance, inside)) = todo.pop() {
            if distance > limit {
                continue;
            }
            if inside & IS_LEAF != 0 {
                limit = limit.min(visit((inside & !IS_LEAF) as usize));
                continue;
            }
            let node = &self.nodes[inside as usize];
            let mut entered = [(0.0, 0); WIDTH];
            let mut count = 0;
            for (distance, inside) in near(node).into_iter().zip(node.inside) {
                // never of NaN
                if distance <= limit && inside != NOTHING {
                    // the nearest last
                    let mut at = count;
                    while at > 0 && entered[at - 1].0 < distance {
                        entered[at] = entered[at - 1];
                        at -= 1;
                    }
                    entered[at] = (distance, inside);
                    count += 1;
                }
            }
            todo.extend_from_slice(&entered[..count]);
        }
    }
}

/// A ray against boxes, in the boxes' coordinates.
pub struct BoxRay {
    /// Bounds on the origin.
    origin: [[f32; 2]; 3],
    /// 1 over the direction, which is scaled to a largest component of 1: infinite of 0, NaN of nearly 0.
    inverse: [f32; 3],
    /// The range of t, scaled.
    ends: [f32; 2],
    /// The factors of t for these boxes.
    scale: [f64; 2],
}

/// Relative error of a bound of t: of the inverse, a difference, a product and its widening, half a unit of f32 each, and more than half as
/// much again.
const SLAB_ROUNDING: f32 = 3.0 * f32::EPSILON;

impl BoxRay {
    /// For each box of a node a lower bound of the t at which the ray may be in it; NaN: it never is.
    fn enter(&self, node: &Node) -> [f32; WIDTH] {
        let mut near = [self.ends[0]; WIDTH];
        let mut far = [self.ends[1]; WIDTH];
        for axis in 0..3 {
            let ([least, most], inverse) = (self.origin[axis], self.inverse[axis]);
            // where it is infinite, of 0 or -0, both ways bound the same
            let (entry, exit, from, to) = if inverse < 0.0 {
                (&node.hi[axis], &node.lo[axis], least, most)
            } else {
                (&node.lo[axis], &node.hi[axis], most, least)
            };
            for k in 0..WIDTH {
                let (a, b) = ((entry[k] - from) * inverse, (exit[k] - to) * inverse);
                // NaN bounds nothing
                near[k] = if a > near[k] { a } else { near[k] };
                far[k] = if b < far[k] { b } else { far[k] };
            }
        }
        let (less, more) = (1.0 - SLAB_ROUNDING, 1.0 + SLAB_ROUNDING);
        let mut entered = [f32::NAN; WIDTH];
        for k in 0..WIDTH {
            let first = (near[k] * less).min(near[k] * more) - f32::MIN_POSITIVE;
            let last = (far[k] * less).max(far[k] * more) + f32::MIN_POSITIVE;
            entered[k] = if first <= last { first } else { f32::NAN };
        }
        entered
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Rng;

    #[test]
    fn every_item_is_in_one_leaf_and_each_box_is_in_the_one_above() {
        // all in one place, on a line, and at distances that share most codes
        let same = |_: u32| DVec3::ONE;
        let line = |k: u32| DVec3::new(f64::from(k), 0.0, 0.0);
        let steep = |k: u32| DVec3::new(0.5_f64.powi((k % 900) as i32), 0.0, 0.0);
        for place in [&same as &dyn Fn(u32) -> DVec3, &line, &steep] {
            for n in [0, 1, 4, 5, 100, 40_001] {
                let items: Vec<(u32, Aabb)> = (0..n).map(|id| (id, Aabb::around(&[place(id)]))).collect();
                let bvh = Bvh::build(&items);
                let mut ids: Vec<u32> = bvh.order.iter().copied().filter(|id| *id != NONE).collect();
                ids.sort_unstable();
                assert!(ids.into_iter().eq(0..n));
                let mut visited = 0;
                bvh.walk_from(DVec3::ZERO, |_| {
                    visited += 1;
                    f64::INFINITY
                });
                assert_eq!(visited, bvh.leaf_count());
                for node in &bvh.nodes {
                    for lane in (0..WIDTH).filter(|k| node.inside[*k] & IS_LEAF == 0) {
                        let inner = &bvh.nodes[node.inside[lane] as usize];
                        let is_within = |axis: usize, k: usize| {
                            node.lo[axis][lane] <= inner.lo[axis][k] && inner.hi[axis][k] <= node.hi[axis][lane]
                        };
                        let there = |k: &usize| inner.lo[0][*k] <= inner.hi[0][*k];
                        assert!((0..WIDTH).filter(there).all(|k| (0..3).all(|axis| is_within(axis, k))));
                    }
                }
            }
        }
    }

    #[test]
    fn no_box_that_a_ray_touches_is_left_out() {
        // sizes and places of scenes whose coordinates f32 cannot tell apart, and rays along axes and nearly so
        for (size, offset) in [(1.0, 0.0), (1.0, 1e9), (1e-25, 3.0), (1e30, 0.0), (1e-30, 0.0), (1e200, 1e200)] {
            let mut rng = Rng(11);
            let centre = DVec3::new(offset, -offset, 0.5 * offset);
            let mut place = || centre + size * rng.vector();
            let points: Vec<DVec3> = (0..500).map(|_| place()).collect();
            let items: Vec<(u32, Aabb)> = (0..).zip(&points).map(|(id, p)| (id, Aabb::around(&[*p]))).collect();
            let bvh = Bvh::build(&items);
            for (id, p) in (0u32..).zip(&points) {
                for axis in
                    [DVec3::X, DVec3::NEG_Y, DVec3::new(1.0, 1e-50, 0.0), DVec3::new(-1e-20, 3.0, 1e20), place() - *p]
                {
                    if !axis.is_finite() || axis == DVec3::ZERO {
                        continue;
                    }
                    // an origin from which the point is reached without rounding: the point itself
                    let ray = bvh.ray(*p, axis, [0.0, f64::INFINITY]);
                    let mut found = false;
                    bvh.walk_rays(&[ray], |leaf| {
                        found |= bvh.leaf(leaf).contains(&id);
                        f64::INFINITY
                    });
                    assert!(found, "{size} {offset} {p} {axis}");
                }
            }
        }
    }
}
