//! Beams over ever larger parts of an image: finds the parts that may see a point.
//!
//! Nodes lie in preorder, each with the place of the next one beside or above it, so a walk is one loop without a stack:
//! on to the next node, or past all that is below.

use super::beam::{Beam, ROUNDING};
use glam::{DVec2, DVec3};

/// A part that is not divided.
#[derive(Debug, Clone, Copy)]
pub struct Leaf {
    /// Leaves near each other have keys near each other, as [`place_key`] makes them: two bits a level.
    pub key: u64,
    /// By which the layer knows it.
    pub number: u32,
    /// World units.
    pub beam: Beam,
}

#[derive(Debug, Clone, Copy)]
pub struct Node {
    pub beam: Beam,
    /// The first node after those below this one.
    pub next: u32,
    /// The number of a leaf; [`INNER`]: there are nodes below.
    pub leaf: u32,
}

/// No leaf's number.
pub const INNER: u32 = u32::MAX;

/// All leaves of a layer, and squares of squares of them.
pub struct Tree {
    /// Beams are about the anchor.
    pub nodes: Vec<Node>,
    /// In the midst of the rays' origins, world units.
    pub anchor: DVec3,
    /// Of t, with a margin for rounding at the ends.
    pub t_range: [f64; 2],
}

/// Where the walk of a whole tree starts.
pub const WHOLE: &[u32] = &[0];

impl Tree {
    /// Over leaves in any order; rays count at t in `t_range`.
    pub fn new(mut leaves: Vec<Leaf>, t_range: [f64; 2]) -> Tree {
        let anchor = middle(&leaves);
        leaves.iter_mut().for_each(|l| l.beam = l.beam.rebased(anchor));
        leaves.sort_by_key(|l| l.key);
        let mut nodes = Vec::with_capacity(leaves.len() + leaves.len() / 2);
        if !leaves.is_empty() {
            push(&mut nodes, &leaves, u64::BITS);
        }
        // about 0 the beams have it
        let error = |t: f64| if t.is_finite() { ROUNDING * t.abs() } else { 0.0 };
        let [t0, t1] = t_range;
        Tree { nodes, anchor, t_range: [t0 - error(t0), t1 + error(t1)] }
    }

    /// Calls `visit` with the number of each leaf at and below the nodes `from`, ascending, that may see the point.
    pub fn walk(&self, point: DVec3, from: &[u32], mut visit: impl FnMut(u32)) {
        let x = point - self.anchor;
        for &start in from {
            let Some(end) = self.nodes.get(start as usize).map(|n| n.next) else { continue };
            let mut k = start;
            while k < end {
                let node = &self.nodes[k as usize];
                let met = node.beam.may_meet(x, self.t_range);
                if met && node.leaf != INNER {
                    visit(node.leaf);
                }
                k = if met { k + 1 } else { node.next };
            }
        }
    }
}

/// The middle of the box around all finite origins.
fn middle(leaves: &[Leaf]) -> DVec3 {
    let all = leaves.iter().map(|l| l.beam.p).filter(|p| p[0].is_finite() && p[1].is_finite());
    let around = all.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    around.map_or(DVec3::ZERO, |[lo, hi]| 0.5 * lo + 0.5 * hi)
}

/// Appends the node over `leaves` (at least one) whose keys agree above the lowest `bits`, and all below it.
fn push(nodes: &mut Vec<Node>, leaves: &[Leaf], bits: u32) -> Beam {
    let at = nodes.len();
    if let [leaf] = leaves {
        nodes.push(Node { beam: leaf.beam, next: at as u32 + 1, leaf: leaf.number });
        return leaf.beam;
    }
    let (first, last) = (leaves[0].key, leaves[leaves.len() - 1].key);
    // the highest two bits in which keys differ part the leaves
    let bits = bits.min(u64::BITS - (first ^ last).leading_zeros()).next_multiple_of(2);
    nodes.push(Node { beam: Beam::NONE, next: 0, leaf: INNER });
    let mut beam = Beam::NONE;
    let mut rest = leaves;
    while let Some(first) = rest.first() {
        let same = |l: &Leaf| bits > 0 && l.key >> (bits - 2) == first.key >> (bits - 2);
        // leaves of one key are distinguished no more
        let (part, after) = rest.split_at(rest.partition_point(same).max(1));
        beam = beam.joined(&push(nodes, part, bits.saturating_sub(2)));
        rest = after;
    }
    nodes[at].beam = beam;
    nodes[at].next = nodes.len() as u32;
    beam
}

/// The key of a place in an image of `size`, both in px: [`morton`] of its column and row.
pub fn place_key(place: DVec2, size: DVec2) -> u64 {
    let steps = f64::from(1u32 << KEY_BITS);
    let along = |share: f64| (share * steps).clamp(0.0, steps - 1.0) as u64;
    morton(along(place.x / size.x.max(size.y)), along(place.y / size.x.max(size.y)))
}

/// The lowest bits of a column and a row interleaved (Morton 1966).
pub fn morton(x: u64, y: u64) -> u64 {
    (0..KEY_BITS).fold(0, |key, k| key | (x >> k & 1) << (2 * k) | (y >> k & 1) << (2 * k + 1))
}

/// Bits of a column or row in a key: an image has 2^16 a side at most.
pub const KEY_BITS: u32 = 16;
