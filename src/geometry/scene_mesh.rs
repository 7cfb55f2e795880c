//! The triangles of a scene, as one mesh or as meshes in several places.

use crate::arrays::MapEach;
use crate::geometry::instances::{Instances, Part};
use crate::geometry::mesh::Mesh;
use crate::geometry::place;
use crate::geometry::primitive::Primitive;
use crate::geometry::time_steps::MovingMesh;
use crate::input::{Limits, Result};
use glam::{DAffine3, DVec3};
use std::collections::BTreeSet;
use std::ops::{Deref, DerefMut, Range};
use std::sync::{Arc, OnceLock};

/// The triangles of a scene in the world. Dereferenced it is one mesh: where the scene has [`Instances`], a copy of each mesh at each of its
/// places, made when it is first asked for. [`SceneMesh::check_copies`] says beforehand whether the copies fit the memory.
#[derive(Debug, Clone, Default)]
pub struct SceneMesh {
    mesh: OnceLock<Arc<Mesh>>,
    instances: Option<Arc<Instances>>,
    /// The one mesh as it was before some instances got other places, and the indices of these instances.
    before: Option<(Arc<Mesh>, BTreeSet<usize>)>,
    /// [`Instances::are_invertible`], once it was asked for.
    are_invertible: OnceLock<bool>,
    /// The box around all vertices and spheres, once it was asked for.
    bounds: OnceLock<Option<(DVec3, DVec3)>>,
}

impl SceneMesh {
    /// The meshes of a scene in their places, each stored once if that saves memory.
    ///
    /// # Errors
    /// Those of [`Instances::new`], and of [`Instances::check_copies`] if copies are made at once.
    pub fn of(parts: Vec<Part>, limits: Limits) -> Result<SceneMesh> {
        if parts.iter().all(|part| part.1.is_none()) {
            return Ok(place::merge(parts.into_iter().map(|part| part.0).collect())?.into());
        }
        SceneMesh::of_instances(Instances::new(parts)?, limits)
    }

    fn of_instances(instances: Instances, limits: Limits) -> Result<SceneMesh> {
        if instances.saves_memory() {
            return Ok(Arc::new(instances).into());
        }
        instances.check_copies(limits)?;
        Ok(instances.copies().into())
    }

    /// Appends a mesh, whose triangles come after all others.
    ///
    /// # Errors
    /// As [`SceneMesh::of`]; the scene's mesh is then as before.
    pub fn append(&mut self, part: Part, limits: Limits) -> Result<()> {
        if self.instances.is_none() && part.1.is_none() {
            place::check_counts([&**self, &part.0])?;
            place::append_with_all(self, part.0);
            return Ok(());
        }
        let alone = || Instances::of_runs(self.mesh(), std::iter::empty());
        let mut all = match &self.instances {
            Some(instances) => Instances::clone(instances),
            None => alone().unwrap_or_else(|| unreachable!("all triangles are one run")),
        };
        all.append(part)?;
        *self = SceneMesh::of_instances(all, limits)?;
        Ok(())
    }

    /// A mesh in runs, as [`Instances::of_runs`] makes them: each stands where it is.
    pub fn of_runs(runs: Arc<Instances>) -> SceneMesh {
        SceneMesh { mesh: runs.base.clone().into(), instances: Some(runs), ..SceneMesh::default() }
    }

    /// The meshes and their places, if they are stored so.
    pub fn instances(&self) -> Option<&Arc<Instances>> {
        self.instances.as_ref()
    }

    /// Whether the scene has instances whose matrices let rays be taken to each mesh.
    pub fn has_invertible_instances(&self) -> bool {
        let are_invertible =
            |instances: &Arc<Instances>| *self.are_invertible.get_or_init(|| instances.are_invertible());
        self.instances.as_ref().is_some_and(are_invertible)
    }

    /// The material of each triangle.
    pub fn material_of(&self) -> Vec<u32> {
        let Some(instances) = &self.instances else { return self.material_of.clone() };
        let own = |range: &Range<u32>| &instances.base.material_of[range.start as usize..range.end as usize];
        instances.list.iter().flat_map(|instance| own(&instance.triangles)).copied().collect()
    }

    /// The mesh that has the materials and the attributes of all triangles: the base mesh of the instances, which is not in the world, or else
    /// the one mesh.
    pub fn base(&self) -> &Arc<Mesh> {
        self.instances.as_ref().map_or_else(|| self.mesh(), |instances| &instances.base)
    }

    /// Puts an instance at another place. Does nothing without instances.
    pub fn place(&mut self, instance: usize, matrix: Option<DAffine3>) {
        if let Some(instances) = &mut self.instances {
            Arc::make_mut(instances).list[instance].matrix = matrix;
            (self.are_invertible, self.bounds) = Default::default();
            if let Some(before) = self.mesh.take() {
                self.before = Some((before, BTreeSet::new()));
            }
            if let Some((_, moved)) = &mut self.before {
                moved.insert(instance);
            }
        }
    }

    /// All triangles as one mesh in the world.
    pub fn mesh(&self) -> &Arc<Mesh> {
        self.mesh.get_or_init(|| {
            Arc::new(match (&self.instances, &self.before) {
                (Some(instances), Some((before, moved))) => instances.copies_again(before, moved),
                (Some(instances), None) => instances.copies(),
                (None, _) => Mesh::default(),
            })
        })
    }

    /// Refuses to make the one mesh if it does not fit the free memory.
    ///
    /// # Errors
    /// Those of [`Instances::check_copies`].
    pub fn check_copies(&self, limits: Limits) -> Result<()> {
        match &self.instances {
            Some(instances) if self.mesh.get().is_none() => instances.check_copies(limits),
            _ => Ok(()),
        }
    }

    pub fn triangle_count(&self) -> usize {
        self.instances.as_ref().map_or_else(|| self.triangles.len(), |instances| instances.triangle_count())
    }

    pub fn vertex_count(&self) -> usize {
        self.instances.as_ref().map_or_else(|| self.positions.len(), |instances| instances.vertex_count())
    }

    /// As [`Mesh::unused_vertices`].
    pub fn unused_vertices(&self) -> usize {
        self.instances.as_ref().map_or_else(|| self.mesh().unused_vertices(), |instances| instances.unused_vertices())
    }

    /// As [`Mesh::bounds`].
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let of_instances = |instances: &Arc<Instances>| instances.bounds();
        *self.bounds.get_or_init(|| self.instances.as_ref().map_or_else(|| self.mesh().bounds(), of_instances))
    }

    /// As [`Mesh::drawn_bounds`]; with instances the box around all vertices.
    pub fn drawn_bounds(&self) -> Option<(DVec3, DVec3)> {
        self.instances.as_ref().map_or_else(|| self.mesh().drawn_bounds(), |instances| instances.bounds())
    }

    /// The corners of a triangle in the world, in the order of its file.
    pub fn corners(&self, id: u32) -> [DVec3; 3] {
        match &self.instances {
            Some(instances) => instances.corners(id),
            None => self.triangles[id as usize].map_each(|vertex| self.positions[vertex as usize]),
        }
    }

    /// A triangle, sphere or capsule in the world.
    pub fn primitive(&self, id: u32) -> Primitive {
        Primitive::new(self.corners(id), self.base().radius(self.base_id(id)))
    }

    /// The triangle in [`SceneMesh::base`] that has the surface of this one.
    pub fn base_id(&self, id: u32) -> u32 {
        self.instances.as_ref().map_or(id, |instances| instances.find(id).1)
    }
}

impl From<Mesh> for SceneMesh {
    fn from(mesh: Mesh) -> SceneMesh {
        Arc::new(mesh).into()
    }
}

impl From<Arc<Mesh>> for SceneMesh {
    fn from(mesh: Arc<Mesh>) -> SceneMesh {
        SceneMesh { mesh: mesh.into(), ..SceneMesh::default() }
    }
}

impl From<Arc<Instances>> for SceneMesh {
    fn from(instances: Arc<Instances>) -> SceneMesh {
        SceneMesh { instances: Some(instances), ..SceneMesh::default() }
    }
}

impl From<Mesh> for Arc<SceneMesh> {
    fn from(mesh: Mesh) -> Arc<SceneMesh> {
        Arc::new(mesh.into())
    }
}

impl<'a> From<&'a SceneMesh> for MovingMesh<'a> {
    fn from(mesh: &'a SceneMesh) -> MovingMesh<'a> {
        MovingMesh::from(&**mesh)
    }
}

impl Deref for SceneMesh {
    type Target = Mesh;

    fn deref(&self) -> &Mesh {
        self.mesh()
    }
}

/// A mesh that is changed has no instances any more.
impl DerefMut for SceneMesh {
    fn deref_mut(&mut self) -> &mut Mesh {
        self.mesh();
        (self.instances, self.before, self.bounds) = Default::default();
        match self.mesh.get_mut() {
            Some(mesh) => Arc::make_mut(mesh),
            None => unreachable!("made above"),
        }
    }
}

impl PartialEq for SceneMesh {
    fn eq(&self, other: &SceneMesh) -> bool {
        match (&self.instances, &other.instances) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b) || a == b,
            _ => **self == **other,
        }
    }
}
