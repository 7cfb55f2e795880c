//! Proof that triangles which join without gaps leave no miss in the box about a pixel.
//!
//! Count the hits of a set of triangles with the sign of their `E`s. The count changes only where an edge of
//! the set passes the ray, and not where two triangles of the set join at it with opposite directions: then
//! one takes over from the other. So when every edge that may pass within the box joins, the count is one
//! number in the whole box, and if that is not 0 at the centre, some triangle of the set is hit everywhere.

use super::Reference;
use super::beam::Beam;
use super::intersect::{Corners, OPPOSITE, sign_of};
use super::margin::{Depth, MARGIN_PX, Sides};
use crate::arrays::MapEach;
use crate::camera::bundle::Bundle;

/// Neighbours are searched in a box larger by this factor: an edge that may pass within the box, as far as the
/// bounds tell, can belong to a triangle wholly beside it. (In the larger frame of the timing test 479 pixels
/// stay unproven, 134 of them true misses; 2848 with a factor of 1.)
const WIDER: f64 = 2.0;

/// An edge by the bits of its two ends, ascending.
type EdgeKey = [[u64; 3]; 2];

/// A triangle near the box.
struct BoxTriangle {
    id: u32,
    corners: Corners,
    sides: Sides,
    may_hit: bool,
}

/// No ray of the box misses all triangles within the range, as far as this argument proves it.
pub fn is_proven(reference: &Reference, bundle: &Bundle, t_range: [f64; 2]) -> bool {
    let beams = Beam::over(bundle, MARGIN_PX).zip(Beam::over(bundle, MARGIN_PX * WIDER));
    let Some((beam, wide)) = beams else { return false };
    let mut nearby = Vec::new();
    reference.walk_in_range(bundle, &wide, t_range, |id| {
        let Some(corners) = reference.solid_corners(id) else { return f64::INFINITY };
        let sides = Sides::over_box(bundle, &corners, reference.scene_size);
        nearby.push(BoxTriangle { id, corners, sides, may_hit: sides.may_hit() });
        f64::INFINITY
    });
    let (mut sets, mut open) = join(&nearby);
    for (k, n) in nearby.iter().enumerate().filter(|(_, n)| n.may_hit) {
        let mut depth = Depth::over_box(bundle, &beam, &n.corners, reference.scene_size);
        let in_range = depth.take_ends(bundle, &n.corners, t_range, (reference.scene_size, reference.has_layers));
        let set = sets.root(k);
        open[set] |= !in_range || reference.mesh.has_alpha(reference.own(n.id));
    }
    let perturbed = bundle.perturbed(reference.scene_size).0;
    let mut count = vec![0_i32; nearby.len()];
    let mut all_two_sided = vec![true; nearby.len()];
    for (k, n) in nearby.iter().enumerate().filter(|(_, n)| n.may_hit) {
        let set = sets.root(k);
        if !open[set] {
            count[set] += i32::from(sign_of(&perturbed, &n.corners));
            all_two_sided[set] &= reference.two_sided(n.id);
        }
    }
    // A count under 0 has a front among its hits; one over 0 may be of backs alone.
    (0..nearby.len()).any(|s| !open[s] && (count[s] < 0 || (count[s] > 0 && all_two_sided[s])))
}

/// Joins triangles over edges that may pass within the box; marks the sets with an edge that stays open.
fn join(nearby: &[BoxTriangle]) -> (Sets, Vec<bool>) {
    let mut edges: Vec<(EdgeKey, usize, i32, bool)> = Vec::with_capacity(3 * nearby.len());
    for (k, n) in nearby.iter().enumerate() {
        let end = |c: usize| n.corners.v[c].to_array().map_each(|x| (x + 0.0).to_bits());
        for (opposite, (i, j, sense)) in OPPOSITE.into_iter().enumerate() {
            // A triangle that is nowhere hit in the box proves that the edge does not pass there: beside
            // the edge it would be hit.
            if !n.may_hit || n.sides.0[opposite] == 0 {
                edges.push(([end(i), end(j)], k, i32::from(sense * n.corners.parity), n.may_hit));
            }
        }
    }
    edges.sort_unstable();
    let mut sets = Sets((0..nearby.len()).collect());
    let mut open_at = Vec::new();
    for shared in edges.chunk_by(|a, b| a.0 == b.0) {
        let mut hit = shared.iter().filter(|e| e.3);
        let Some(first) = hit.next() else { continue };
        hit.for_each(|e| sets.unite(first.1, e.1));
        let closed = shared.iter().any(|e| !e.3) || shared.iter().map(|e| e.2).sum::<i32>() == 0;
        if !closed {
            open_at.push(first.1);
        }
    }
    let mut open = vec![false; nearby.len()];
    open_at.into_iter().for_each(|k| open[sets.root(k)] = true);
    (sets, open)
}

/// Disjoint sets of indices.
struct Sets(Vec<usize>);

impl Sets {
    fn root(&mut self, mut k: usize) -> usize {
        while self.0[k] != k {
            self.0[k] = self.0[self.0[k]];
            k = self.0[k];
        }
        k
    }

    fn unite(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }
}
