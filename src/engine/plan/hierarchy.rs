//! Bounding volume hierarchies over triangles and spheres: of two boxes a node for shadow rays and a rival, of eight for trace. Built by a library; the
//! first kind can be refitted.

mod crowd;
pub mod moving;
pub mod placed;
mod wide;

use crate::arrays::MapEach;
use crate::engine::clusters::Chunk;
use crate::geometry::mesh::Mesh;
use crate::geometry::primitive::{Capsule, Primitive};
use crate::gpu::layout::{BvhNode, CAPSULE, LeafTriangle, ROUND, Vertex};
use crate::input::{Error, Result};
use crate::parallel;
use crate::scene::Scene;
use bytemuck::Zeroable;
use glam::{DVec3, Vec3};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::cwbvh::node::CwBvhNode;
use wide::Wide;

/// Nodes that wait in the kernel at most.
const DEPTH_MAX: usize = 96;

/// The hierarchy over the triangles of a scene.
pub struct Hierarchy {
    tree: Bvh2,
    anchor: DVec3,
    /// Triangles, the mesh's first ones.
    count: usize,
    /// By which all numbers of the tree are multiplied: a power of two, so that areas and volumes of a scene of any size are numbers.
    scale: f32,
}

impl Hierarchy {
    /// Of the first `count` triangles.
    ///
    /// # Errors
    /// [`Error::Work`] where it is deeper than the kernel can follow.
    pub fn build(scene: &Scene, anchor: DVec3, count: usize) -> Result<Hierarchy> {
        let scale = scale(scene, anchor);
        let tree = crowd::build(&boxes(scene, anchor, count, scale), BvhBuildParams::medium_build());
        check_depth(&tree, count)?;
        Ok(Hierarchy { tree, anchor, count, scale })
    }

    /// Fits the boxes to triangles that moved.
    pub fn refit(&mut self, scene: &Scene) {
        if self.count == 0 {
            return;
        }
        crowd::fit(&mut self.tree, &boxes(scene, self.anchor, self.count, self.scale));
    }

    /// Those of all triangles that light may meet, from both sides, nodes and triangles as vec4s.
    pub fn packed(&self, scene: &Scene) -> PackedBvh {
        let (nodes, mut leaves) = self.scaled_nodes_and_leaves(scene, self.scale);
        leaves.iter_mut().for_each(|leaf| leaf.one_sided = 0);
        let [nodes, leaves] = [bytemuck::cast_slice(&nodes).to_vec(), bytemuck::cast_slice(&leaves).to_vec()];
        PackedBvh { nodes, leaves, masks: Vec::new(), scale: self.scale }
    }

    /// The nodes, the root first, and the triangles in the order of the leaves; without triangles, one node that nothing meets.
    #[cfg(feature = "internals")]
    pub fn nodes_and_leaves(&self, scene: &Scene) -> (Vec<BvhNode>, Vec<LeafTriangle>) {
        self.scaled_nodes_and_leaves(scene, 1.0)
    }

    fn scaled_nodes_and_leaves(&self, scene: &Scene, scale: f32) -> (Vec<BvhNode>, Vec<LeafTriangle>) {
        if self.count == 0 {
            return (vec![BvhNode { lo: [0.0; 3], first: 0, hi: [0.0; 3], count: 1 }], vec![LeafTriangle::zeroed()]);
        }
        let node = |n: &obvhs::bvh2::node::Bvh2Node| {
            let around = n.aabb();
            let [lo, hi] =
                [around.min, around.max].map_each(|corner| corner.to_array().map_each(|v| v / self.scale * scale));
            BvhNode { lo, first: n.first_index, hi, count: n.prim_count }
        };
        let leaf = |id: &u32| {
            let leaf = leaf_triangle(scene, self.anchor, *id);
            let [v0, v1, v2] = [leaf.v0, leaf.v1, leaf.v2].map_each(|corner| corner.map_each(|v| v * scale));
            LeafTriangle { v0, v1, v2, ..leaf }
        };
        (parallel::map(&self.tree.nodes, node), parallel::map(&self.tree.primitive_indices, leaf))
    }
}

impl PackedBvh {
    /// Hierarchies over the first `count` triangles of a scene that moves, one for the time from each time step to the next:
    /// `wgsl/shading/casters/timed.wgsl`.
    ///
    /// # Errors
    /// As [`Hierarchy::build`].
    pub fn of_moving(scene: &Scene, anchor: DVec3, count: usize) -> Result<PackedBvh> {
        let (all, scale) = (scene.moving_mesh(), scale(scene, anchor));
        let (mut roots, mut nodes, mut leaves) = (Vec::new(), Vec::new(), Vec::new());
        for way in 0..all.count() - 1 {
            let small = |v: DVec3| (v - anchor).as_vec3() * scale;
            let ends = |id: u32| {
                [way, way + 1].map_each(|step| match all.primitive(id, step) {
                    Primitive::Triangle(corners) => corners.map_each(small),
                    Primitive::Round(Capsule { ends: [a, b], radius }) => {
                        [small(a), Vec3::X * radius as f32 * scale, small(b)]
                    }
                })
            };
            let boxed = |id: u32| {
                let points = [way, way + 1].map_each(|step| all.primitive(id, step).extremes().map_each(small));
                Aabb::from_points(points.map_each(|end| end.map_each(Into::into)).as_flattened())
            };
            let boxes: Vec<Aabb> = parallel::map(0..count as u32, boxed);
            let tree = crowd::build(&boxes, BvhBuildParams::medium_build());
            check_depth(&tree, count)?;
            let (first_node, first_leaf) = (nodes.len() as u32 / 2, leaves.len() as u32 / 6);
            roots.push([f32::from_bits(first_node), 0.0, 0.0, 0.0]);
            for node in &tree.nodes {
                let first = node.first_index + if node.is_leaf() { first_leaf } else { first_node };
                let ([x, y, z], [u, v, w]) = (node.aabb().min.to_array(), node.aabb().max.to_array());
                nodes.extend([[x, y, z, f32::from_bits(first)], [u, v, w, f32::from_bits(node.prim_count)]]);
            }
            for id in &tree.primitive_indices {
                let is_round = f32::from_bits(all.mesh.is_round(*id).into());
                let last = [f32::from_bits(*id), 0.0, is_round, 0.0, 0.0, 0.0];
                leaves.extend(ends(*id).as_flattened().iter().zip(last).map(|(v, last)| v.extend(last).to_array()));
            }
        }
        if count == 0 {
            // nothing meets them
            nodes.extend([[0.0; 4], [0.0, 0.0, 0.0, f32::from_bits(1)]]);
            leaves.extend([[0.0; 4]; 6]);
        }
        Ok(PackedBvh { nodes: [roots, nodes].concat(), leaves, masks: Vec::new(), scale })
    }

    /// Adds the alpha masks of the first `count` triangles of a mesh: `wgsl/masks/masked/leaf.wgsl`.
    pub fn with_masks(mut self, mesh: &Mesh, count: usize) -> PackedBvh {
        self.masks = parallel::flat_map(0..count as u32, |id| {
            let is_solid = mesh.is_round(id) || !mesh.has_alpha(id);
            let number = if is_solid { 0 } else { mesh.material_of[id as usize] + 1 };
            let uvs = mesh.uvs_of(id as usize);
            let [a, b, c] = uvs.unwrap_or_default();
            let has_uvs = if uvs.is_some() { 1.0 } else { 0.0 };
            // v downwards
            [[a.x, 1.0 - a.y, b.x, 1.0 - b.y], [c.x, 1.0 - c.y, f32::from_bits(number), has_uvs]]
        });
        self
    }
}

fn check_depth(tree: &Bvh2, count: usize) -> Result<()> {
    let depth = if count == 0 { 0 } else { tree.depth(0) };
    if depth < DEPTH_MAX {
        return Ok(());
    }
    Err(Error::work(format!("the hierarchy is {depth} boxes deep; the kernel follows {DEPTH_MAX}")))
}

/// A hierarchy over the triangles of a chunk, as trace follows it: `wgsl/hierarchy/nodes.wgsl`.
#[derive(Debug, Clone)]
pub struct TracedBvh {
    pub nodes: Vec<[u32; 4]>,
    pub triangles: Vec<[u32; 4]>,
}

/// Of no triangles.
impl Default for TracedBvh {
    fn default() -> TracedBvh {
        TracedBvh {
            nodes: [vec![[1f32.to_bits(), 0, 0, 0]], vec![[0; 4]; NODE_ROWS]].concat(),
            triangles: vec![[0; 4]; 3],
        }
    }
}

/// Rows of a node.
const NODE_ROWS: usize = 5;

/// Groups of boxes that wait in the kernel at most.
const WAITING_MAX: usize = 32;

impl TracedBvh {
    /// Of the triangles of a chunk, relative to a point from which its anchor lies at `offset`; `None` where it is deeper than the kernel can
    /// follow.
    pub fn new(chunk: &Chunk, offset: DVec3) -> Option<TracedBvh> {
        if chunk.triangles.is_empty() {
            return Some(TracedBvh::default());
        }
        if chunk.steps > 1 {
            return TracedBvh::of_moving(chunk, offset);
        }
        let place = Place { offset, scale: scale_of(chunk, offset) };
        let Wide { nodes, items } = Wide::build(chunk.triangles.len() as u32, |slot| boxed(chunk, slot, place));
        TracedBvh::of(chunk, place, &nodes, &items)
    }

    /// The tables of a tree over the slots of a chunk; `None` where it is deeper than the kernel can follow.
    fn of(chunk: &Chunk, place: Place, tree: &[CwBvhNode], slots: &[u32]) -> Option<TracedBvh> {
        if depth(tree) > WAITING_MAX {
            return None;
        }
        let mut nodes = vec![[(place.scale as f32).to_bits(), 0, 0, 0]];
        nodes.extend(tree.iter().flat_map(node_rows));
        let rows = |slot: &u32| primitive(chunk, *slot, 0, place).rows(*slot);
        let triangles = parallel::map(slots, rows).into_flattened();
        Some(TracedBvh { nodes, triangles })
    }

    /// One hierarchy for the way from each time step to the next, in boxes that hold both ends of it: `wgsl/vertices/timed/traced.wgsl`.
    fn of_moving(chunk: &Chunk, offset: DVec3) -> Option<TracedBvh> {
        let place = Place { offset, scale: scale_of(chunk, offset) };
        let ways = chunk.steps - 1;
        // the roots of all take the rows of so many nodes, beside the first row
        let header_nodes = (ways as usize - 1).div_ceil(NODE_ROWS);
        let mut nodes = vec![[(place.scale as f32).to_bits(), 0, 0, 0]; 1 + NODE_ROWS * header_nodes];
        let mut triangles = Vec::new();
        for way in 0..ways {
            let ends = |slot: u32| [way, way + 1].map_each(|step| primitive(chunk, slot, step, place));
            let boxed = |slot: u32| {
                let all = ends(slot).map_each(|end| end.extremes().map_each(|v| v.as_vec3().into()));
                Aabb::from_points(all.as_flattened())
            };
            let mut tree = Wide::build(chunk.triangles.len() as u32, boxed);
            if depth(&tree.nodes) > WAITING_MAX {
                return None;
            }
            let (first_node, first_triangle) = ((nodes.len() - 1) / NODE_ROWS, triangles.len() / (2 * TRIANGLE_ROWS));
            nodes[way as usize][1] = first_node as u32;
            for node in &mut tree.nodes {
                node.child_base_idx += first_node as u32;
                node.primitive_base_idx += first_triangle as u32;
            }
            nodes.extend(tree.nodes.iter().flat_map(node_rows));
            let rows = |slot: &u32| ends(*slot).map_each(|end| end.rows(*slot));
            let all = parallel::map(&tree.items, rows);
            triangles.extend_from_slice(all.as_flattened().as_flattened());
        }
        Some(TracedBvh { nodes, triangles })
    }
}

/// Where a hierarchy has its coordinates: those relative to the anchor, plus an offset, times a scale.
#[derive(Clone, Copy)]
struct Place {
    offset: DVec3,
    scale: f64,
}

/// A power of two that brings all coordinates of a chunk under 1.
fn scale_of(chunk: &Chunk, offset: DVec3) -> f64 {
    let size = |v: &Vertex| (v.position() + offset).abs().max_element();
    let of_vertices = parallel::reduce(&chunk.vertices, |v| Some(size(v)), f64::max);
    let far = |t: &[u32; 4]| {
        let of_step = |step: u32| size(&chunk.vertices[(t[0] * chunk.steps + step) as usize]);
        radius_of(*t).map_or(0.0, |radius| radius + (0..chunk.steps).map(of_step).fold(0.0, f64::max))
    };
    let of_spheres = parallel::reduce(chunk.triangles.as_slice(), |t| Some(far(t)), f64::max);
    let largest = of_vertices.into_iter().chain(of_spheres).fold(f64::from(f32::MIN_POSITIVE), f64::max);
    largest.log2().ceil().exp2().recip()
}

/// The box of what is in a slot, scaled.
fn boxed(chunk: &Chunk, slot: u32, place: Place) -> Aabb {
    Aabb::from_points(&primitive(chunk, slot, 0, place).extremes().map_each(|v| v.as_vec3().into()))
}

/// A primitive at a time step, scaled.
struct Placed {
    primitive: Primitive,
    /// The last word of its packed form.
    word: u32,
}

fn primitive(chunk: &Chunk, slot: u32, step: u32, Place { offset, scale }: Place) -> Placed {
    let packed @ [a, b, c, word] = chunk.triangles[slot as usize];
    let radius = radius_of(packed);
    let corners = match radius {
        None => [a, b, c],
        // the vertex of a capsule's other end is the next one
        Some(_) if word & ROUND == CAPSULE => [a, a + 1, a + 1],
        Some(_) => [a; 3],
    };
    let place = |v: u32| (chunk.vertices[(v * chunk.steps + step) as usize].position() + offset) * scale;
    Placed { primitive: Primitive::new(corners.map_each(place), radius.map(|radius| radius * scale)), word }
}

/// The radius of a packed sphere or capsule; `None` of a triangle.
fn radius_of([_, hi, lo, word]: [u32; 4]) -> Option<f64> {
    (word & ROUND >= CAPSULE).then(|| f64::from(f32::from_bits(hi)) + f64::from(f32::from_bits(lo)))
}

impl Placed {
    fn extremes(&self) -> [DVec3; 3] {
        self.primitive.extremes()
    }

    fn rows(&self, slot: u32) -> [[u32; 4]; TRIANGLE_ROWS] {
        let row = |v: DVec3, last: u32| {
            let [x, y, z] = v.as_vec3().to_array().map_each(f32::to_bits);
            [x, y, z, last]
        };
        match self.primitive {
            Primitive::Triangle([a, b, c]) => [row(a, slot), row(b - a, self.word), row(a - c, 0)],
            Primitive::Round(Capsule { ends: [a, b], radius }) => {
                [row(a, slot), row(DVec3::X * radius, self.word), row(b - a, 0)]
            }
        }
    }
}

fn node_rows(node: &CwBvhNode) -> [[u32; 4]; NODE_ROWS] {
    bytemuck::cast(*node)
}

/// Rows of a triangle at one time.
const TRIANGLE_ROWS: usize = 3;

/// Nodes from the root to the lowest.
fn depth(nodes: &[CwBvhNode]) -> usize {
    depths(nodes).into_iter().max().unwrap_or(0)
}

/// How many nodes lie on the way from the root to each node, itself included: those below one come after it.
fn depths(nodes: &[CwBvhNode]) -> Vec<usize> {
    let mut depths = vec![1; nodes.len()];
    for (k, node) in nodes.iter().enumerate() {
        for child in (0..8).filter(|child| !node.is_leaf(*child)) {
            depths[node.child_node_index(child) as usize] = depths[k] + 1;
        }
    }
    depths
}

/// A hierarchy as the kernels that light follow it in.
#[derive(Debug, Clone)]
pub struct PackedBvh {
    pub nodes: Vec<[f32; 4]>,
    pub leaves: Vec<[f32; 4]>,
    /// Alpha masks, where there are some.
    pub masks: Vec<[f32; 4]>,
    pub scale: f32,
}

/// A triangle, or a sphere or capsule by its ends and its radius, as kernels read it.
pub fn leaf_triangle(scene: &Scene, anchor: DVec3, id: u32) -> LeafTriangle {
    let mesh = &scene.mesh;
    let near = |p: DVec3| (p - anchor).as_vec3().to_array();
    let one_sided = u32::from(!mesh.materials[mesh.material_of[id as usize] as usize].two_sided);
    match mesh.primitive(id) {
        Primitive::Triangle(corners) => {
            let [v0, v1, v2] = corners.map_each(near);
            LeafTriangle { v0, id, v1, one_sided, v2, is_round: 0 }
        }
        Primitive::Round(Capsule { ends, radius }) => {
            let ([v0, v2], v1) = (ends.map_each(near), [radius as f32, 0.0, 0.0]);
            LeafTriangle { v0, id, v1, one_sided, v2, is_round: 1 }
        }
    }
}

/// About the inverse of the largest number of a scene.
fn scale(scene: &Scene, anchor: DVec3) -> f32 {
    let (lo, hi) = scene.bounds().unwrap_or((anchor, anchor));
    let largest = (lo - anchor).abs().max((hi - anchor).abs()).max_element();
    largest.max(f64::from(f32::MIN_POSITIVE)).log2().ceil().exp2().recip() as f32
}

/// Boxes of the first `count` primitives.
fn boxes(scene: &Scene, anchor: DVec3, count: usize, scale: f32) -> Vec<Aabb> {
    let mesh = &scene.mesh;
    let small = |v: DVec3| ((v - anchor).as_vec3() * scale).into();
    parallel::map(0..count, |id| Aabb::from_points(&mesh.primitive(id as u32).extremes().map_each(small)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::kinds::orthographic::Orthographic;
    use crate::geometry::generate;
    use std::sync::Arc;

    #[test]
    fn of_no_triangles_there_is_one_that_nothing_meets() {
        let scene = scene();
        let mut tree = Hierarchy::build(&scene, DVec3::ZERO, 0).unwrap();
        tree.refit(&scene);
        let packed = tree.packed(&scene);
        assert_eq!((packed.nodes.len(), packed.leaves.len()), (2, 3));
    }

    #[test]
    fn volumes_of_scenes_of_any_size_are_numbers() {
        for size in [1e-12, 1.0, 3.7, 1e30] {
            let mut scene = scene();
            Arc::make_mut(&mut scene.mesh).positions.iter_mut().for_each(|p| *p *= size);
            let packed = Hierarchy::build(&scene, DVec3::ZERO, 20).unwrap().packed(&scene);
            let largest = packed.leaves.iter().flat_map(|r| &r[..3]).fold(0.0, |most: f32, v| most.max(v.abs()));
            assert!(largest > 0.25 && largest <= 1.0, "{size}: {largest}");
        }
    }

    fn scene() -> Scene {
        let mesh = generate::icosphere(3);
        Scene {
            mesh: mesh.into(),
            objects: Vec::new(),
            lights: Vec::new(),
            projector_lights: Vec::new(),
            volume: None,
            ambient_occlusion: None,
            style: Default::default(),
            sky: None,
            background: [0.0; 3],
            tone: Default::default(),
            depth_range: None,
            size: None,
            camera_keys: Arc::default(),
            camera: crate::camera::spec::CameraSpec {
                kind: crate::camera::spec::CameraKind::new(
                    "orthographic",
                    Orthographic { eye: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y, height: 1.0 },
                ),
                t_range: [0.0, 1.0],
            },
            caustics: None,
            exposure: Default::default(),
            steps: None,
            casters: None,
            camera_steps: Vec::new(),
            output: Default::default(),
            limits: Default::default(),
        }
    }

    /// Every triangle lies once below the root, in every box above it.
    fn assert_whole(nodes: &[BvhNode], leaves: &[LeafTriangle]) {
        let mut seen = vec![0; leaves.len()];
        let mut todo = vec![(0u32, [f32::NEG_INFINITY; 3], [f32::INFINITY; 3])];
        while let Some((k, lo, hi)) = todo.pop() {
            let node = &nodes[k as usize];
            assert!((0..3).all(|a| node.lo[a] >= lo[a] && node.hi[a] <= hi[a]), "node {k} leaves its parent");
            if node.count == 0 {
                todo.extend([(node.first, node.lo, node.hi), (node.first + 1, node.lo, node.hi)]);
            }
            for t in &leaves[node.first as usize..][..node.count as usize] {
                let inside = |v: [f32; 3]| (0..3).all(|a| node.lo[a] <= v[a] && v[a] <= node.hi[a]);
                assert!([t.v0, t.v1, t.v2].into_iter().all(inside), "triangle {} leaves its leaf", t.id);
                seen[t.id as usize] += 1;
            }
        }
        assert!(seen.iter().all(|n| *n == 1));
    }

    #[test]
    fn boxes_hold_what_is_below_them_also_after_it_moved() {
        let mut scene = scene();
        let mut tree = Hierarchy::build(&scene, DVec3::splat(0.25), scene.mesh.triangles.len()).unwrap();
        let (nodes, leaves) = tree.nodes_and_leaves(&scene);
        assert_whole(&nodes, &leaves);
        Arc::make_mut(&mut scene.mesh).positions.iter_mut().for_each(|p| *p = DVec3::new(p.y + 1.0, 2.0 * p.z, p.x));
        tree.refit(&scene);
        let (nodes, leaves) = tree.nodes_and_leaves(&scene);
        assert_whole(&nodes, &leaves);
    }
}
