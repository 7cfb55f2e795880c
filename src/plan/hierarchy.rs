//! A bounding volume hierarchy over triangles, for straight ways: the light's, and a rival's rays. Built by a library for it, or
//! fitted anew.

use crate::error::{Error, Result};
use crate::gpu::rows::{BvhNode, LeafTriangle};
use crate::scene::Scene;
use bytemuck::Zeroable;
use glam::DVec3;
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::triangle::Triangle;
use rayon::prelude::*;
use std::time::Duration;

/// Nodes that wait in the kernel at most.
const DEPTH_MAX: usize = 96;

/// The hierarchy over the triangles of a scene.
pub struct Hierarchy {
    tree: Bvh2,
    anchor: DVec3,
    /// Triangles, the mesh's first ones.
    count: usize,
}

impl Hierarchy {
    /// Of the first `count` triangles.
    ///
    /// # Errors
    /// [`Error::Work`] where it is deeper than the kernel can follow.
    pub fn build(scene: &Scene, anchor: DVec3, count: usize) -> Result<Hierarchy> {
        let triangles = triangles(scene, anchor, count);
        let tree = build_bvh2_from_tris(&triangles, BvhBuildParams::medium_build(), &mut Duration::default());
        let depth = tree.depth(0);
        if depth >= DEPTH_MAX {
            return Err(Error::work(format!("the hierarchy is {depth} boxes deep; the kernel follows {DEPTH_MAX}")));
        }
        Ok(Hierarchy { tree, anchor, count })
    }

    /// Fits the boxes to triangles that moved.
    pub fn refit(&mut self, scene: &Scene) {
        let triangles = triangles(scene, self.anchor, self.count);
        let order = &self.tree.primitive_indices;
        self.tree.nodes.par_iter_mut().filter(|n| n.is_leaf()).for_each(|node| {
            let own = &order[node.first_index as usize..][..node.prim_count as usize];
            let boxes = own.iter().map(|k| triangles[*k as usize].aabb());
            if let Some(around) = boxes.reduce(|a, b| a.union(&b)) {
                node.set_aabb(around);
            }
        });
        self.tree.refit_all();
    }

    /// Those of all triangles that light may meet, from both sides, nodes and triangles as rows of four words each; of none, one that
    /// nothing meets.
    pub fn words(&self, scene: &Scene) -> [Vec<[f32; 4]>; 2] {
        let (mut nodes, mut leaves) = self.rows(scene);
        if leaves.is_empty() {
            nodes = vec![BvhNode { lo: [0.0; 3], first: 0, hi: [0.0; 3], count: 1 }];
            leaves = vec![LeafTriangle::zeroed()];
        }
        leaves.iter_mut().for_each(|leaf| leaf.one_sided = 0);
        [bytemuck::cast_slice(&nodes).to_vec(), bytemuck::cast_slice(&leaves).to_vec()]
    }

    /// The rows of the nodes, the root first, and of the triangles in the order of the leaves.
    pub fn rows(&self, scene: &Scene) -> (Vec<BvhNode>, Vec<LeafTriangle>) {
        let node = |n: &obvhs::bvh2::node::Bvh2Node| {
            let around = n.aabb();
            BvhNode { lo: around.min.to_array(), first: n.first_index, hi: around.max.to_array(), count: n.prim_count }
        };
        let nodes = self.tree.nodes.par_iter().map(node).collect();
        (nodes, self.tree.primitive_indices.par_iter().map(|id| row(scene, self.anchor, *id)).collect())
    }
}

/// A triangle's row.
pub fn row(scene: &Scene, anchor: DVec3, id: u32) -> LeafTriangle {
    let mesh = &scene.mesh;
    let [v0, v1, v2] = mesh.triangles[id as usize].map(|v| (mesh.positions[v as usize] - anchor).as_vec3().to_array());
    let one_sided = u32::from(!mesh.materials[mesh.material_of[id as usize] as usize].two_sided);
    LeafTriangle { v0, id, v1, one_sided, v2, pad0: 0 }
}

fn triangles(scene: &Scene, anchor: DVec3, count: usize) -> Vec<Triangle> {
    let mesh = &scene.mesh;
    let corner = |v: u32| (mesh.positions[v as usize] - anchor).as_vec3().into();
    let all = mesh.triangles[..count].par_iter();
    all.map(|t| Triangle { v0: corner(t[0]), v1: corner(t[1]), v2: corner(t[2]) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::generate;

    fn scene() -> Scene {
        let mesh = generate::icosphere(3);
        Scene {
            mesh,
            objects: Vec::new(),
            lights: Vec::new(),
            ambient_occlusion: None,
            style: Default::default(),
            sky: None,
            background: [0.0; 3],
            tone: Default::default(),
            size: None,
            camera: crate::scene::file::CameraSpec {
                kind: crate::scene::file::CameraKind::Orthographic {
                    eye: DVec3::Z,
                    target: DVec3::ZERO,
                    up: DVec3::Y,
                    height: 1.0,
                },
                t_range: [0.0, 1.0],
            },
            caustics: None,
            output: Default::default(),
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
        let (nodes, leaves) = tree.rows(&scene);
        assert_whole(&nodes, &leaves);
        scene.mesh.positions.iter_mut().for_each(|p| *p = DVec3::new(p.y + 1.0, 2.0 * p.z, p.x));
        tree.refit(&scene);
        let (nodes, leaves) = tree.rows(&scene);
        assert_whole(&nodes, &leaves);
    }
}
