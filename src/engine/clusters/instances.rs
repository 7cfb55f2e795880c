//! Meshes that stand in several places. Each mesh is put on the device once, relative to an origin of its own.

use super::{Chunk, Clustered, VERTEX_BYTES, morton_order, side};
use crate::geometry::instances::Instances;
use crate::geometry::mesh::Mesh;
use crate::gpu::kernels::SurfaceKind;
use crate::gpu::layout::{NONE, Vertex};
use crate::parallel;
use glam::DVec3;
use std::ops::Range;
use std::sync::Arc;

/// Instances of meshes, and where the triangles of these meshes are. Slots count the triangles of all instances, one instance after the other.
#[derive(Debug, Clone)]
pub struct PlacedMeshes {
    pub instances: Arc<Instances>,
    /// Each mesh that has an instance.
    pub meshes: Arc<[MeshSlots]>,
    /// The mesh of each instance, and its first slot.
    pub of_instance: Arc<[(usize, u32)]>,
}

/// A mesh in the tables.
#[derive(Debug, Clone)]
pub struct MeshSlots {
    /// The slots of its triangles in the tables.
    pub slots: Range<u32>,
    pub vertices: Range<u32>,
    /// The origin of its stored positions, in the coordinates of the mesh.
    pub origin: DVec3,
}

/// Bytes of a place in the larger of its two tables.
const PLACE_BYTES: u64 = 192;

impl PlacedMeshes {
    /// Whether the tables of all meshes fit one chunk.
    pub fn fit(instances: &Instances, surfaces: SurfaceKind, table_limit: u64) -> bool {
        let Mesh { triangles, positions, .. } = &*instances.base;
        let triangle_bytes = super::bytes_a_triangle(surfaces);
        let bytes = [
            triangles.len() as u64 * triangle_bytes,
            positions.len() as u64 * VERTEX_BYTES,
            instances.list.len() as u64 * PLACE_BYTES,
        ];
        bytes.into_iter().all(|bytes| bytes <= table_limit)
    }

    /// Clusters the triangles of each mesh, whose tables [`PlacedMeshes::fit`].
    pub fn clustered(instances: &Arc<Instances>, anchor: DVec3, surfaces: SurfaceKind) -> Clustered {
        let base = &*instances.base;
        let (mut meshes, mut of_instance): (Vec<MeshSlots>, Vec<(usize, u32)>) = Default::default();
        let mut order: Vec<u32> = Vec::new();
        let (firsts, mesh_of) = instances.meshes();
        for first in firsts {
            let own = morton_order(base.into(), first.triangles.clone());
            let slots = order.len() as u32..(order.len() + own.len()) as u32;
            order.extend(own);
            let (lo, hi) = first.bounds;
            let origin = if lo.cmple(hi).all() { (lo + hi) / 2.0 } else { DVec3::ZERO };
            meshes.push(MeshSlots { slots, vertices: first.vertices.clone(), origin });
        }
        let mut first_slot = 0;
        for mesh in mesh_of {
            of_instance.push((mesh, first_slot));
            first_slot += meshes[mesh].slots.len() as u32;
        }
        let mut slot_of_id = vec![NONE; base.triangles.len()];
        (0..).zip(&order).for_each(|(slot, id)| slot_of_id[*id as usize] = slot);
        let mut chunk = Chunk {
            id_count: instances.triangle_count() as u32,
            steps: 1,
            slot_of_id: Arc::new(slot_of_id),
            triangles: Arc::new(parallel::map(&order, |&id| [0, 0, 0, id | side(base, id)])),
            ..Chunk::default()
        };
        chunk.place(base.into(), |_| true);
        let without_area = instances.triangle_count() - first_slot as usize;
        let placed =
            PlacedMeshes { instances: instances.clone(), meshes: meshes.into(), of_instance: of_instance.into() };
        let [places, slots] = Default::default();
        let placed = Some(Arc::new(placed));
        Clustered { chunks: vec![chunk], anchor, places, slots, moved: None, surfaces, without_area, placed }
    }

    /// The vertices of all meshes, each relative to the origin of its mesh.
    pub fn vertices(&self) -> Vec<Vertex> {
        let positions = &self.instances.base.positions;
        let mut origins = vec![DVec3::ZERO; positions.len()];
        for mesh in self.meshes.iter() {
            origins[mesh.vertices.start as usize..mesh.vertices.end as usize].fill(mesh.origin);
        }
        parallel::map(0..positions.len(), |k| Vertex::new(positions[k] - origins[k]))
    }

    /// Returns these meshes at the places of `instances`; `None` if `instances` are of other meshes.
    pub fn moved(&self, instances: &Arc<Instances>) -> Option<PlacedMeshes> {
        let own =
            |all: &Instances, k: usize| all.list.get(k).map(|i| (i.first_id, i.triangles.clone(), i.vertices.clone()));
        let is_same = Arc::ptr_eq(&self.instances.base, &instances.base)
            && self.instances.list.len() == instances.list.len()
            && (0..instances.list.len()).all(|k| own(&self.instances, k) == own(instances, k));
        is_same.then(|| PlacedMeshes { instances: instances.clone(), ..self.clone() })
    }
}
