//! A hierarchy that follows the triangles of a chunk when they move: boxes above moved triangles are fitted to them.

use super::wide::Wide;
use super::{NODE_ROWS, Place, TRIANGLE_ROWS, TracedBvh, boxed, primitive, scale_of};
use crate::engine::clusters::Chunk;
use crate::gpu::layout::CLUSTER;
use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::cwbvh::node::CwBvhNode;
use std::ops::Range;

/// The hierarchy as it is on the device, and the exact boxes of its nodes.
pub struct MovingBvh {
    pub traced: TracedBvh,
    place: Place,
    /// The slot of each triangle in `traced`.
    slots: Vec<u32>,
    boxes: Vec<Aabb>,
    /// Sum of the nodes' surfaces when it was built.
    built_area: f32,
}

/// Rows of both tables that changed.
pub struct ChangedRows {
    pub nodes: Vec<Range<usize>>,
    pub triangles: Vec<Range<usize>>,
}

/// Beyond this growth of its boxes' surfaces, a hierarchy is built again.
const GROWN_MAX: f32 = 1.5;

impl MovingBvh {
    /// As [`TracedBvh::new`], for a chunk whose triangles stand still during a frame.
    pub fn new(chunk: &Chunk, offset: DVec3) -> Option<MovingBvh> {
        let place = Place { offset, scale: scale_of(chunk, offset) };
        if chunk.triangles.is_empty() {
            let (slots, boxes) = (Vec::new(), Vec::new());
            return Some(MovingBvh { traced: TracedBvh::default(), place, slots, boxes, built_area: 0.0 });
        }
        let Wide { nodes, items } = Wide::build(chunk.triangles.len() as u32, |slot| boxed(chunk, slot, place));
        let traced = TracedBvh::of(chunk, place, &nodes, &items)?;
        let boxes = vec![Aabb::empty(); nodes.len()];
        let mut own = MovingBvh { traced, place, slots: items, boxes, built_area: 0.0 };
        own.fit(chunk, &|_| true);
        own.built_area = own.area();
        Some(own)
    }

    /// Refits the hierarchy to the triangles in the slots `changed`. Returns `None` if it must be rebuilt: the offset or the scale has changed,
    /// or the surface area of its boxes has grown by more than half.
    pub fn refit(&mut self, chunk: &Chunk, offset: DVec3, changed: &[Range<usize>]) -> Option<ChangedRows> {
        if offset != self.place.offset || scale_of(chunk, offset) != self.place.scale {
            return None;
        }
        // ranges are of whole clusters
        let mut is_changed = vec![false; chunk.triangles.len().div_ceil(CLUSTER as usize)];
        for range in changed {
            is_changed[range.start / CLUSTER as usize..range.end.div_ceil(CLUSTER as usize)].fill(true);
        }
        let has_moved = |slot: u32| is_changed[(slot / CLUSTER) as usize];
        let nodes = self.fit(chunk, &has_moved);
        let mut triangles = Vec::new();
        for (k, slot) in self.slots.iter().enumerate().filter(|(_, slot)| has_moved(**slot)) {
            let rows = k * TRIANGLE_ROWS..(k + 1) * TRIANGLE_ROWS;
            self.traced.triangles[rows.clone()].copy_from_slice(&primitive(chunk, *slot, 0, self.place).rows(*slot));
            add(&mut triangles, rows);
        }
        (self.area() <= GROWN_MAX * self.built_area).then_some(ChangedRows { nodes, triangles })
    }

    /// Fits the nodes above triangles that have moved; returns the rows of these nodes.
    fn fit(&mut self, chunk: &Chunk, has_moved: &dyn Fn(u32) -> bool) -> Vec<Range<usize>> {
        let mut is_dirty = vec![false; self.boxes.len()];
        let mut rows = Vec::new();
        // nodes lie behind the nodes above them
        for k in (0..self.boxes.len()).rev() {
            let own_rows = 1 + k * NODE_ROWS..1 + (k + 1) * NODE_ROWS;
            let mut node: CwBvhNode = bytemuck::cast(
                <[[u32; 4]; NODE_ROWS]>::try_from(&self.traced.nodes[own_rows.clone()]).unwrap_or_default(),
            );
            let slots = |child: usize| {
                let first = (node.primitive_base_idx + u32::from(node.child_meta[child] & 31)) as usize;
                &self.slots[first..first + (node.child_meta[child] >> 5).count_ones() as usize]
            };
            let is_there = |child: &usize| node.child_meta[*child] != 0;
            let changes = |child: usize| match node.is_leaf(child) {
                true => slots(child).iter().any(|slot| has_moved(*slot)),
                false => is_dirty[node.child_node_index(child) as usize],
            };
            if !(0..8).filter(is_there).any(changes) {
                continue;
            }
            let child_box = |child: usize| match node.is_leaf(child) {
                true => {
                    slots(child).iter().fold(Aabb::empty(), |all, slot| all.union(&boxed(chunk, *slot, self.place)))
                }
                false => self.boxes[node.child_node_index(child) as usize],
            };
            let children = [0, 1, 2, 3, 4, 5, 6, 7].map(|child| is_there(&child).then(|| child_box(child)));
            let own = children.iter().flatten().fold(Aabb::empty(), |all, child| all.union(child));
            pack(&mut node, &own, &children);
            (self.boxes[k], is_dirty[k]) = (own, true);
            let packed: [[u32; 4]; NODE_ROWS] = bytemuck::cast(node);
            self.traced.nodes[own_rows.clone()].copy_from_slice(&packed);
            rows.push(own_rows);
        }
        rows.reverse();
        let mut joined = Vec::new();
        rows.into_iter().for_each(|range| add(&mut joined, range));
        joined
    }

    fn area(&self) -> f32 {
        self.boxes.iter().map(Aabb::half_area).sum()
    }
}

/// Appends a range to a list; extends the last range if the new one begins at its end.
fn add(ranges: &mut Vec<Range<usize>>, range: Range<usize>) {
    match ranges.last_mut() {
        Some(last) if last.end == range.start => last.end = range.end,
        _ => ranges.push(range),
    }
}

/// Steps of the grid of a node along an axis.
const STEPS: f32 = 255.0;

/// The smallest size of a node's grid.
const SIZE_MIN: f32 = 1e-20;

/// Puts the boxes of a node's children on its grid, rounded outwards.
fn pack(node: &mut CwBvhNode, own: &Aabb, children: &[Option<Aabb>; 8]) {
    node.p = own.min.into();
    let size = (own.max - own.min).max(Vec3A::splat(SIZE_MIN));
    let step = (size / STEPS).log2().ceil().exp2();
    let too_small = (size / step).ceil().cmpgt(Vec3A::splat(STEPS));
    let step = Vec3A::select(too_small, 2.0 * step, step);
    node.e = step.to_array().map(|step| (step.to_bits() >> 23) as u8);
    for (k, child) in children.iter().enumerate() {
        let Some(child) = child else { continue };
        let lo = ((child.min - own.min) / step).floor().clamp(Vec3A::ZERO, Vec3A::splat(STEPS));
        let hi = ((child.max - own.min) / step).ceil().clamp(Vec3A::ZERO, Vec3A::splat(STEPS));
        (node.child_min_x[k], node.child_max_x[k]) = (lo.x as u8, hi.x as u8);
        (node.child_min_y[k], node.child_max_y[k]) = (lo.y as u8, hi.y as u8);
        (node.child_min_z[k], node.child_max_z[k]) = (lo.z as u8, hi.z as u8);
    }
}

#[cfg(test)]
mod tests {
    use super::super::wide::tests::assert_whole;
    use super::*;
    use crate::engine::clusters::cluster;
    use crate::geometry::generate::soup;
    use crate::geometry::mesh::Mesh;
    use crate::gpu::kernels::SurfaceKind;

    /// The hierarchy holds each triangle where it is.
    fn assert_holds(bvh: &MovingBvh, chunk: &Chunk) {
        let nodes =
            bvh.traced.nodes[1..].as_chunks().0.iter().map(|rows: &[[u32; 4]; NODE_ROWS]| bytemuck::cast(*rows));
        let boxes: Vec<Aabb> = (0..chunk.triangles.len() as u32).map(|slot| boxed(chunk, slot, bvh.place)).collect();
        assert_whole(&Wide { nodes: nodes.collect(), items: bvh.slots.clone() }, &boxes);
        for (slot, rows) in bvh.slots.iter().zip(bvh.traced.triangles.as_chunks().0) {
            assert_eq!(*rows, primitive(chunk, *slot, 0, bvh.place).rows(*slot));
        }
    }

    #[test]
    fn boxes_follow_triangles_that_move_and_only_they_change() {
        let mesh = soup(3, 40_000);
        let moved = |by: f64| Mesh {
            positions: mesh.positions.iter().map(|p| if p.x > 0.5 { *p - DVec3::Y * by } else { *p }).collect(),
            ..mesh.clone()
        };
        let before = cluster(&mesh, DVec3::ZERO, SurfaceKind::Plain, 1 << 27).with_vertices(&mesh);
        let offset = DVec3::new(0.25, 0.0, -0.5);
        let mut bvh = MovingBvh::new(&before.chunks[0], offset).unwrap();
        assert_holds(&bvh, &before.chunks[0]);
        let after = before.moved(&mesh, &moved(0.05)).unwrap().with_vertices(&moved(0.05));
        let slots = after.moved.as_ref().unwrap().chunks[0].slots();
        let old = bvh.traced.clone();
        let changed = bvh.refit(&after.chunks[0], offset, &slots).unwrap();
        assert_holds(&bvh, &after.chunks[0]);
        for (new, old, ranges) in [
            (&bvh.traced.nodes, &old.nodes, &changed.nodes),
            (&bvh.traced.triangles, &old.triangles, &changed.triangles),
        ] {
            let is_changed = |k: usize| ranges.iter().any(|range| range.contains(&k));
            assert!((0..new.len()).all(|k| is_changed(k) || new[k] == old[k]));
            assert!(ranges.iter().map(ExactSizeIterator::len).sum::<usize>() < new.len());
        }
        // another place, another size
        assert!(bvh.refit(&after.chunks[0], DVec3::ZERO, &slots).is_none());
        let away = cluster(&moved(100.0), DVec3::ZERO, SurfaceKind::Plain, 1 << 27).with_vertices(&moved(100.0));
        assert!(bvh.refit(&away.chunks[0], offset, &slots).is_none());
    }
}
