//! A hierarchy that follows the triangles of a chunk when they move: boxes above moved triangles are fitted to them.

use super::wide::Wide;
use super::{NODE_ROWS, Place, TRIANGLE_ROWS, TracedBvh, boxed, depths, primitive, scale_of};
use crate::engine::clusters::Chunk;
use crate::gpu::layout::CLUSTER;
use crate::parallel;
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
    /// The nodes by their depth, the root first. Those of one depth are fitted in parallel.
    levels: Vec<Vec<u32>>,
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
            let traced = TracedBvh::default();
            let (slots, boxes, levels) = Default::default();
            return Some(MovingBvh { traced, place, slots, boxes, levels, built_area: 0.0 });
        }
        let Wide { nodes, items } = Wide::build(chunk.triangles.len() as u32, |slot| boxed(chunk, slot, place));
        let traced = TracedBvh::of(chunk, place, &nodes, &items)?;
        let boxes = vec![Aabb::empty(); nodes.len()];
        let mut levels: Vec<Vec<u32>> = Vec::new();
        for (k, depth) in (0..).zip(depths(&nodes)) {
            levels.resize_with(levels.len().max(depth), Vec::new);
            levels[depth - 1].push(k);
        }
        let mut own = MovingBvh { traced, place, slots: items, boxes, levels, built_area: 0.0 };
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
        let moved = |k: usize| {
            let slot = self.slots[k];
            has_moved(slot).then(|| (k, primitive(chunk, slot, 0, self.place).rows(slot)))
        };
        let mut triangles = Vec::new();
        for (k, rows) in parallel::flat_map(0..self.slots.len(), moved) {
            let own = k * TRIANGLE_ROWS..(k + 1) * TRIANGLE_ROWS;
            self.traced.triangles[own.clone()].copy_from_slice(&rows);
            add(&mut triangles, own);
        }
        (self.area() <= GROWN_MAX * self.built_area).then_some(ChangedRows { nodes, triangles })
    }

    /// Fits the nodes above triangles that have moved; returns the rows of these nodes.
    fn fit(&mut self, chunk: &Chunk, has_moved: &(dyn Fn(u32) -> bool + Sync)) -> Vec<Range<usize>> {
        let mut is_dirty = vec![false; self.boxes.len()];
        for level in (0..self.levels.len()).rev() {
            let fitted = |k: &u32| {
                let (node, own) = self.fitted(*k as usize, chunk, has_moved, &is_dirty)?;
                Some((*k as usize, node, own))
            };
            for (k, node, own) in parallel::flat_map(&self.levels[level], fitted) {
                let packed: [[u32; 4]; NODE_ROWS] = bytemuck::cast(node);
                self.traced.nodes[rows_of(k)].copy_from_slice(&packed);
                (self.boxes[k], is_dirty[k]) = (own, true);
            }
        }
        let mut rows = Vec::new();
        (0..is_dirty.len()).filter(|k| is_dirty[*k]).for_each(|k| add(&mut rows, rows_of(k)));
        rows
    }

    /// A node, and its box, fitted to what is below it; `None` if nothing of that has moved.
    fn fitted(
        &self,
        k: usize,
        chunk: &Chunk,
        has_moved: &(dyn Fn(u32) -> bool + Sync),
        is_dirty: &[bool],
    ) -> Option<(CwBvhNode, Aabb)> {
        let rows: [[u32; 4]; NODE_ROWS] = self.traced.nodes[rows_of(k)].try_into().unwrap_or_default();
        let mut node: CwBvhNode = bytemuck::cast(rows);
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
            return None;
        }
        let child_box = |child: usize| match node.is_leaf(child) {
            true => slots(child).iter().fold(Aabb::empty(), |all, slot| all.union(&boxed(chunk, *slot, self.place))),
            false => self.boxes[node.child_node_index(child) as usize],
        };
        let children = [0, 1, 2, 3, 4, 5, 6, 7].map(|child| is_there(&child).then(|| child_box(child)));
        let own = children.iter().flatten().fold(Aabb::empty(), |all, child| all.union(child));
        pack(&mut node, &own, &children);
        Some((node, own))
    }

    fn area(&self) -> f32 {
        self.boxes.iter().map(Aabb::half_area).sum()
    }
}

/// The rows of a node.
fn rows_of(k: usize) -> Range<usize> {
    1 + k * NODE_ROWS..1 + (k + 1) * NODE_ROWS
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
