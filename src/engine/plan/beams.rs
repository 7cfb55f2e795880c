//! A tree of beams in f32, rounded outwards, and points in the same units.

use crate::arrays::MapEach;
use crate::camera::project::tree::{INNER, Node, Tree};
use crate::gpu::layout::{self, NONE};
use glam::DVec3;

/// What `sift` knows of a tree.
pub struct Beams {
    pub nodes: Vec<layout::Beam>,
    /// Ends of t_range in the nodes' units.
    pub t_range: [f32; 2],
    anchor: DVec3,
    /// The length that is 1 in the nodes: a power of 2.
    unit: f64,
}

/// Bytes of a node.
pub const BEAM_BYTES: u64 = size_of::<layout::Beam>() as u64;

/// Smallest nonzero magnitude that is stored, so that no quotient overflows and no value is flushed to 0.
const LEAST: f64 = 1.0 / (1u64 << 60) as f64;

/// Stands for an infinite end of t_range.
const ENDLESS: f64 = (1u64 << 60) as f64;

/// Points farther away than this are not tested: almost all beams would contain them.
const FARTHEST: f64 = (1u64 << 40) as f64;

/// Of t: above every quotient of a point's distance from an end, 2^61, and a direction, 2^-60.
const T_MOST: f64 = ENDLESS * ENDLESS * 32.0;

/// Relative error bound: a point and its distance to an end, rounded to f32 (four times 2^-24), plus the bound of the f64 tree
/// ([`crate::camera::project::beam::ROUNDING`], 2^-34).
const POINT_ERROR: f64 = 1.0 / (1u64 << 22) as f64;

impl Beams {
    /// At most `most` nodes (one at least): what is below the last ones is left to the tree itself.
    pub fn new(tree: &Tree, most: usize) -> Beams {
        let mut below = 1;
        let mut kept = subtrees(&tree.nodes, below);
        while kept.len() > most.max(1) {
            below *= 2;
            kept = subtrees(&tree.nodes, below);
        }
        let size = |ends: fn(&Node) -> [DVec3; 2]| {
            let all = kept.iter().flat_map(|&k| ends(&tree.nodes[k as usize])).filter(|v| v.is_finite());
            all.fold(0.0_f64, |m, v| m.max(v.abs().max_element()))
        };
        let d_unit = power_above(size(|n| n.beam.d));
        let unit = power_above(size(|n| n.beam.p)).max(d_unit);
        let packed = |&k: &u32| {
            let node = &tree.nodes[k as usize];
            let ([p_lo, p_hi], [d_lo, d_hi]) = (node.beam.p, node.beam.d);
            let v = |v: DVec3, round: fn(f64) -> f32| v.to_array().map_each(|v| round(v.clamp(-ENDLESS, ENDLESS)));
            layout::Beam {
                p_lo: v(p_lo / unit, down),
                next: kept.partition_point(|&other| other < node.next) as u32,
                p_hi: v(p_hi / unit, up),
                node: if node.leaf == INNER && node.next - k > below { NONE } else { k },
                d_lo: v(d_lo / d_unit, down),
                pad0: 0,
                d_hi: v(d_hi / d_unit, up),
                pad1: 0,
            }
        };
        let [t0, t1] = tree.t_range.map_each(|t| (t * (d_unit / unit)).clamp(-T_MOST, T_MOST));
        Beams { nodes: kept.iter().map(packed).collect(), t_range: [down(t0), up(t1)], anchor: tree.anchor, unit }
    }

    /// A point in the nodes' units, and its tolerance; a negative one where it is too far away.
    pub fn point(&self, point: DVec3) -> [f32; 4] {
        let x = (point - self.anchor) / self.unit;
        let size = x.abs().max_element();
        if !x.is_finite() || size > FARTHEST {
            return [0.0, 0.0, 0.0, -1.0];
        }
        let [x, y, z] = x.to_array().map_each(|v| v as f32);
        [x, y, z, up(POINT_ERROR * size)]
    }
}

/// Nodes from the top down to those with at most `below` nodes, themselves included, in preorder.
fn subtrees(nodes: &[Node], below: u32) -> Vec<u32> {
    let mut kept = Vec::new();
    let mut k = 0;
    while let Some(node) = nodes.get(k as usize) {
        kept.push(k);
        k = if node.next - k <= below { node.next } else { k + 1 };
    }
    kept
}

/// The least power of 2 that is at least `size`, as far as numbers and their inverses are normal; 1 for 0.
fn power_above(size: f64) -> f64 {
    if size > 0.0 { size.log2().ceil().clamp(-1000.0, 1000.0).exp2() } else { 1.0 }
}

/// An f32 that is not above, next to the nearest; see [`LEAST`].
pub(super) fn down(value: f64) -> f32 {
    if value.abs() < LEAST {
        return if value < 0.0 { -LEAST as f32 } else { 0.0 };
    }
    (value as f32).next_down()
}

pub(super) fn up(value: f64) -> f32 {
    -down(-value)
}
