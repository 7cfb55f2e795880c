//! Hierarchies of meshes that stand in several places: one of each mesh, and one of the places. `wgsl/vertices/placed/vertex.wgsl` has the rows
//! of a place.

use super::wide::Wide;
use super::{NODE_ROWS, Place, TracedBvh, WAITING_MAX, boxed, depth, node_rows, primitive};
use crate::arrays::MapEach;
use crate::engine::clusters::instances::{MeshSlots, PlacedMeshes};
use crate::engine::clusters::{Clustered, morton_key};
use crate::geometry::instances::largest_row_sum;
use crate::geometry::mesh::joined;
use crate::gpu::layout::split2;
use crate::parallel;
use glam::{DAffine3, DMat3, DVec3};
use obvhs::aabb::Aabb;
use std::ops::Range;

/// Hierarchies of meshes and of their places.
pub struct PlacedBvh {
    /// The nodes of all meshes, then those of the places; the first row has the scale and the root of the latter.
    pub traced: TracedBvh,
    /// The root of each mesh, and the scale of its coordinates.
    meshes: Vec<(u32, f64)>,
    /// Rows of `traced.nodes` before those of the places.
    top_first: usize,
    /// The scale of the hierarchy of places, and the origin of its coordinates, world units.
    top: (f64, DVec3),
    /// The instance in each leaf of the hierarchy of places.
    leaves: Vec<u32>,
}

/// Rows of a place.
const INSTANCE_ROWS: usize = 12;

/// The bit beside the root of a mesh that says that the matrix of the place mirrors the mesh.
const MIRRORED: u32 = 1 << 31;

/// The roundings of a vertex in the world, and of the inverse that takes it back: fewer than 32, each 2^-53 of the numbers that are added up.
const ROUNDING: f64 = 32.0 * f64::EPSILON / 2.0;

impl PlacedBvh {
    /// Hierarchies over the meshes of `clustered` and over their places, whose coordinates are relative to `origin`. Returns `None` if one is
    /// deeper than the kernel can follow, or if a matrix is too close to a singular one for it.
    pub fn new(clustered: &Clustered, placed: &PlacedMeshes, origin: DVec3) -> Option<PlacedBvh> {
        let mut chunk = clustered.chunks.first()?.clone();
        chunk.vertices = placed.vertices();
        let chunk = &chunk;
        let (mut nodes, mut triangles, mut meshes) = (vec![[0; 4]], Vec::new(), Vec::new());
        for MeshSlots { slots, vertices, .. } in placed.meshes.iter() {
            let first_node = (nodes.len() - 1) / NODE_ROWS;
            let own = &chunk.vertices[vertices.start as usize..vertices.end as usize];
            let size = parallel::reduce(own, |v| Some(v.position().abs().max_element()), f64::max).unwrap_or(0.0);
            let place = Place { offset: DVec3::ZERO, scale: scale_of(size) };
            meshes.push((first_node as u32, place.scale));
            if slots.is_empty() {
                nodes.extend([[0; 4]; NODE_ROWS]);
                continue;
            }
            let mut tree = Wide::build(slots.len() as u32, |k| boxed(chunk, slots.start + k, place));
            if depth(&tree.nodes) > WAITING_MAX {
                return None;
            }
            let first_triangle = triangles.len() / super::TRIANGLE_ROWS;
            for node in &mut tree.nodes {
                node.child_base_idx += first_node as u32;
                node.primitive_base_idx += first_triangle as u32;
            }
            nodes.extend(tree.nodes.iter().flat_map(node_rows));
            let rows = |k: &u32| primitive(chunk, slots.start + k, 0, place).rows(slots.start + k);
            triangles.extend(parallel::map(&tree.items, rows).into_flattened());
        }
        let top_first = nodes.len();
        let traced = TracedBvh { nodes, triangles };
        let mut own = PlacedBvh { traced, meshes, top_first, top: (1.0, origin), leaves: Vec::new() };
        own.place(placed, origin).then_some(own)
    }

    /// Builds the hierarchy of the places, where they are now. Returns `false` if it is deeper than the kernel can follow.
    pub fn place(&mut self, placed: &PlacedMeshes, origin: DVec3) -> bool {
        let boxes = placed.instances.boxes();
        let has_triangles = |k: &u32| {
            let mesh = &placed.meshes[placed.of_instance[*k as usize].0];
            !mesh.slots.is_empty() && !placed.instances.list[*k as usize].is_point()
        };
        let mut there: Vec<u32> = (0..boxes.len() as u32).filter(has_triangles).collect();
        // neighbors in order, as the hierarchy is built of parts
        let whole = there.iter().map(|k| boxes[*k as usize]).reduce(joined).unwrap_or_default();
        there.sort_by_cached_key(|k| {
            morton_key(boxes[*k as usize].0 + boxes[*k as usize].1, (2.0 * whole.0, 2.0 * whole.1))
        });
        let size = |(lo, hi): &(DVec3, DVec3)| (*lo - origin).abs().max((*hi - origin).abs()).max_element();
        let scale = scale_of(there.iter().map(|k| size(&boxes[*k as usize])).fold(0.0, f64::max));
        let small = |v: DVec3| ((v - origin) * scale).as_vec3().into();
        let boxed = |k: u32| {
            let (lo, hi) = boxes[there[k as usize] as usize];
            Aabb::from_points(&[small(lo), small(hi)])
        };
        self.traced.nodes.truncate(self.top_first);
        let first_node = ((self.top_first - 1) / NODE_ROWS) as u32;
        self.traced.nodes[0] = [(scale as f32).to_bits(), first_node, 0, 0];
        (self.top, self.leaves) = ((scale, origin), Vec::new());
        // n places have at most n nodes: each node has two boxes or more, or is the only node
        let whole = self.top_first + NODE_ROWS * boxes.len().max(1);
        if there.is_empty() {
            self.traced.nodes.resize(whole, [0; 4]);
            return true;
        }
        let mut tree = Wide::build(there.len() as u32, boxed);
        tree.nodes.iter_mut().for_each(|node| node.child_base_idx += first_node);
        self.traced.nodes.extend(tree.nodes.iter().flat_map(node_rows));
        self.traced.nodes.resize(whole.max(self.traced.nodes.len()), [0; 4]);
        self.leaves = tree.items.iter().map(|k| there[*k as usize]).collect();
        depth_from(&tree, first_node) <= WAITING_MAX
    }

    /// The rows of `traced.nodes` that [`PlacedBvh::place`] changes.
    pub fn top_rows(&self) -> [Range<usize>; 2] {
        [0..1, self.top_first..self.traced.nodes.len()]
    }

    /// The rows of all places, for vertices relative to `anchor`. Returns `None` if a matrix is too close to a singular one.
    pub fn rows(&self, placed: &PlacedMeshes, anchor: DVec3) -> Option<Vec<[u32; 4]>> {
        let list = &placed.instances.list;
        let (top_scale, origin) = self.top;
        let mut rows = Vec::with_capacity(INSTANCE_ROWS * list.len());
        for (k, (instance, (mesh, first_slot))) in list.iter().zip(placed.of_instance.iter()).enumerate() {
            let MeshSlots { slots, origin: centre, .. } = &placed.meshes[*mesh];
            let (root, scale) = self.meshes[*mesh];
            let leaf = self.leaves.get(k).copied().unwrap_or(0);
            let count = if k == 0 { list.len() as u32 } else { 0 };
            rows.push([
                *first_slot,
                first_slot.wrapping_sub(slots.start),
                instance.first_id.wrapping_sub(instance.triangles.start),
                root | if instance.is_mirrored() { MIRRORED } else { 0 },
            ]);
            if slots.is_empty() || instance.is_point() {
                // no leaf has it
                rows.extend([[0; 4]; 3]);
                rows.push([0, instance.first_id, leaf, count]);
                rows.extend([[0; 4]; INSTANCE_ROWS - 5]);
                continue;
            }
            let matrix = instance.matrix.unwrap_or(DAffine3::IDENTITY);
            let (inverse, condition) = instance.inverse()?;
            let middle = matrix.transform_point3(*centre);
            // from the hierarchy of places to that of the mesh
            let turn = inverse * (scale / top_scale);
            let shift = (inverse * (origin - middle)) * scale;
            let (lo, hi) = instance.bounds;
            let reach = abs(matrix.matrix3) * lo.abs().max(hi.abs()) + matrix.translation.abs();
            let world = (reach + origin.abs()).max_element();
            let error = ROUNDING
                * (scale * largest_row_sum(inverse) * world + condition * condition * shift.abs().max_element());
            let size = largest_row_sum(turn);
            if !(size.is_finite() && shift.is_finite() && error.is_finite() && (SIZE_MIN..SIZE_MAX).contains(&size)) {
                return None;
            }
            rows.extend(
                [0, 1, 2].map_each(|i| turn.row(i).extend(shift[i]).as_vec4().to_array().map_each(f32::to_bits)),
            );
            rows.push([upward(size).to_bits(), instance.first_id, leaf, count]);
            let at = middle - anchor;
            let pairs = [0, 1, 2].map_each(|i| matrix.matrix3.row(i).extend(at[i]).to_array().map_each(split2));
            rows.extend(
                [0, 1].into_iter().flat_map(|part| pairs.map_each(|row| row.map_each(|pair| pair[part].to_bits()))),
            );
            rows.push([upward(error).to_bits(), 0, 0, 0]);
        }
        if rows.is_empty() {
            rows = vec![[0; 4]; INSTANCE_ROWS];
        }
        Some(rows)
    }
}

/// The sizes of numbers that f32 arithmetic can take to a mesh's hierarchy.
const SIZE_MIN: f64 = 1e-20;
const SIZE_MAX: f64 = 1e20;

/// A power of two that brings all coordinates up to this size under 1.
fn scale_of(size: f64) -> f64 {
    size.max(f64::from(f32::MIN_POSITIVE)).log2().ceil().exp2().recip()
}

/// As [`depth`], of nodes whose indices begin at `first`.
fn depth_from(tree: &Wide, first: u32) -> usize {
    let nodes = tree.nodes.iter().map(|node| {
        let mut node = *node;
        node.child_base_idx -= first;
        node
    });
    depth(&nodes.collect::<Vec<_>>())
}

/// As f32, not below the number.
fn upward(number: f64) -> f32 {
    (number * (1.0 + 4.0 * f64::from(f32::EPSILON))) as f32
}

fn abs(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}
