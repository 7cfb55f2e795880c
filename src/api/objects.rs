//! Objects of a scene that move or change their shape.

use super::Scene;
use crate::geometry::instances::{Instance, Instances};
use crate::geometry::mesh::{Mesh, NO_NORMAL};
use crate::geometry::place::{STRETCH_MAX, keeps_spheres, size_of, transformed_normal, world_normal_from_object};
use crate::geometry::scene_mesh::SceneMesh;
use crate::geometry::time_steps::TimeSteps;
use crate::input::{Error, Result};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// An object as it was last added or set, before any move.
#[derive(Debug, Clone)]
pub(super) struct Rest {
    name: String,
    triangles: Range<usize>,
    /// In the scene's positions and normals; no other object has any there.
    vertices: Range<usize>,
    normals: Range<usize>,
    positions: Vec<DVec3>,
    directions: Vec<Vec3>,
}

impl Rest {
    /// In the scene's positions.
    pub fn vertices(&self) -> Range<usize> {
        self.vertices.clone()
    }

    fn of(scene: &crate::scene::Scene, name: &str) -> Result<Rest> {
        let triangles = triangles_of(scene, name)?;
        let Mesh { positions, normals, triangles: corners, corner_normals, .. } = &**scene.mesh;
        // each object's lie together: from the first to the last that it uses
        let own = |corners: &[[u32; 3]]| {
            let used = corners.get(triangles.clone()).unwrap_or_default().iter().flatten().filter(|v| **v != NO_NORMAL);
            let (first, end) = used.fold((usize::MAX, 0), |(lo, hi), v| (lo.min(*v as usize), hi.max(*v as usize + 1)));
            first.min(end)..end
        };
        let (vertices, normal_range) = (own(corners), own(corner_normals));
        Ok(Rest {
            name: name.to_owned(),
            positions: positions[vertices.clone()].to_vec(),
            directions: normals[normal_range.clone()].to_vec(),
            triangles,
            vertices,
            normals: normal_range,
        })
    }
}

/// The triangles of an object.
fn triangles_of(scene: &crate::scene::Scene, name: &str) -> Result<Range<usize>> {
    let mut first = 0;
    let triangles = scene.objects.iter().find_map(|object| {
        let own = first..first + object.triangles;
        first = own.end;
        (object.name == name).then_some(own)
    });
    triangles.ok_or_else(|| {
        let names: Vec<&str> = scene.objects.iter().map(|object| object.name.as_str()).take(20).collect();
        Error::input(format!("the scene has no object {name:?}; it has {}", names.join(", ")))
    })
}

impl Scene {
    /// Places an object: each of its vertices p, as last added or set, comes to lie at M p. `matrix` has the rows of M, which is affine, in world
    /// units; the identity takes the object back. Cameras that depend on the scene, such as `track`, must be created again.
    ///
    /// # Errors
    /// [`Error::Input`] if the scene has no such object, a vertex does not stay finite, a matrix scales or stretches spheres, or the scene has
    /// caustics; the scene is then unchanged.
    pub fn move_object(&mut self, name: &str, matrix: [[f64; 4]; 3]) -> Result<()> {
        let column = |k: usize| DVec3::new(matrix[0][k], matrix[1][k], matrix[2][k]);
        let place = DAffine3::from_mat3_translation(DMat3::from_cols(column(0), column(1), column(2)), column(3));
        if let Some(instance) = self.instance_of(name)? {
            return self.move_instance(name, instance, place);
        }
        let rest = self.rest(name)?;
        let triangles = rest.triangles.clone();
        let is_sphere = |id: usize| self.scene.mesh.radius(id as u32).is_some();
        if triangles.clone().any(is_sphere) && (!keeps_spheres(&place) || (size_of(&place) - 1.0).abs() > STRETCH_MAX) {
            return Err(Error::input(format!(
                "{name}: the matrix scales or stretches spheres; use rotation and translation"
            )));
        }
        let rest = self.rest(name)?;
        let positions = rest.positions.iter().map(|p| place.transform_point3(*p)).collect();
        // a matrix without inverse leaves the normals as they were
        let normals = match world_normal_from_object(place.matrix3) {
            Some(matrix) => rest.directions.iter().map(|n| transformed_normal(matrix, *n)).collect(),
            None => rest.directions.clone(),
        };
        self.put(name, positions, Some(normals))
    }

    /// Gives an object other vertices, in world units, as many as it has. Its normals, which they do not fit, are dropped: it is shaded
    /// flat. Later moves start from these vertices.
    ///
    /// # Errors
    /// As [`Scene::move_object`], and if there are more or fewer vertices.
    pub fn set_vertices(&mut self, name: &str, vertices: &[[f64; 3]]) -> Result<()> {
        let count = self.rest(name)?.positions.len();
        if vertices.len() != count {
            let given = vertices.len();
            return Err(Error::input(format!(
                "{name}: {given} vertices for an object of {count}, from the first to the last that a triangle uses"
            )));
        }
        let positions: Vec<DVec3> = vertices.iter().map(|v| DVec3::from_array(*v)).collect();
        self.put(name, positions.clone(), None)?;
        if let Some(rest) = self.rests.iter_mut().find(|rest| rest.name == name) {
            rest.positions = positions;
            rest.directions = Vec::new();
        }
        Ok(())
    }

    /// The instance that is an object, where objects can move by a matrix alone: no vertex was set or moves while images are taken, and there are
    /// no spheres. From the first such move on the scene is made of instances.
    fn instance_of(&mut self, name: &str) -> Result<Option<usize>> {
        let ids = triangles_of(&self.scene, name)?;
        let has_other_moves = !self.rests.is_empty() || self.scene.steps.is_some();
        if has_other_moves || self.scene.caustics.is_some() || self.scene.mesh.base().has_spheres() {
            return Ok(None);
        }
        if self.at_rest.is_none() {
            let counts = self.scene.objects.iter().map(|object| object.triangles);
            if let Some(instances) = self.scene.mesh.instances() {
                self.at_rest = Some(instances.clone());
            } else if let Some(runs) = Instances::of_runs(self.scene.mesh.mesh(), counts).map(Arc::new) {
                self.scene.mesh = Arc::new(SceneMesh::of_runs(runs.clone()));
                self.at_rest = Some(runs);
            }
        }
        Ok(self.at_rest.as_ref().and_then(|at_rest| at_rest.exactly(&ids)))
    }

    /// Moves an object that is an instance.
    fn move_instance(&mut self, name: &str, instance: usize, place: DAffine3) -> Result<()> {
        let Some(at_rest) = &self.at_rest else { return Ok(()) };
        let Instance { matrix: own, bounds, .. } = &at_rest.list[instance];
        let matrix = match own {
            _ if place == DAffine3::IDENTITY => *own,
            Some(own) => Some(place * *own),
            None => Some(place),
        };
        let (lo, hi) = Instance { matrix, ..at_rest.list[instance].clone() }.placed_box(*bounds);
        if let Some(v) = [lo, hi].into_iter().find(|p| !p.is_finite()) {
            return Err(Error::input(format!("{name}: a vertex would lie at {v}; use finite numbers")));
        }
        Arc::make_mut(&mut self.scene.mesh).place(instance, matrix);
        Ok(())
    }

    /// Turns the instances of the scene into one mesh, with moved objects at their present places, and keeps their earlier vertices in `rests`.
    pub(super) fn copy_places(&mut self) -> Result<()> {
        let Some(at_rest) = &self.at_rest else { return Ok(()) };
        self.scene.mesh.check_copies(self.scene.limits)?;
        let Some(now) = self.scene.mesh.instances().cloned() else { return Ok(()) };
        let mesh = self.scene.mesh.mesh().clone();
        let moved = crate::scene::Scene { mesh: Arc::new(mesh.into()), ..self.scene.clone() };
        let ends = moved.objects.iter().scan(0, |end, object| {
            *end += object.triangles;
            Some((*end - object.triangles..*end, object.name.as_str()))
        });
        let names: HashMap<Range<usize>, &str> = ends.filter(|(ids, _)| !ids.is_empty()).collect();
        let (mut rests, mut first_vertex, mut first_normal) = (Vec::new(), 0, 0);
        for (was, is) in at_rest.list.iter().zip(&now.list) {
            let ids = was.first_id as usize..was.first_id as usize + was.triangles.len();
            if let Some(name) = names.get(&ids).filter(|_| was.matrix != is.matrix) {
                let mut rest = Rest::of(&moved, name)?;
                // the object as it was, where the copies have it now
                let own = |k: usize, first: usize, range: &Range<u32>| k - first + range.start as usize;
                for (k, p) in rest.vertices.clone().zip(&mut rest.positions) {
                    *p = was.placed(at_rest.base.positions[own(k, first_vertex, &was.vertices)]);
                }
                for (k, n) in rest.normals.clone().zip(&mut rest.directions) {
                    *n = was.placed_normal(at_rest.base.normals[own(k, first_normal, &was.normals)]);
                }
                rests.push(rest);
            }
            first_vertex += was.vertices.len();
            first_normal += was.normals.len();
        }
        (self.scene, self.rests, self.at_rest) = (moved, rests, None);
        Ok(())
    }

    /// The object as it was last added or set, kept from its first move on.
    pub(super) fn rest(&mut self, name: &str) -> Result<&Rest> {
        if self.scene.caustics.is_some() {
            return Err(Error::input("a scene with caustics takes its meshes from its file; move them there"));
        }
        self.scene.mesh.check_copies(self.scene.limits)?;
        self.copy_places()?;
        if let Some(known) = self.rests.iter().position(|rest| rest.name == name) {
            return Ok(&self.rests[known]);
        }
        self.rests.push(Rest::of(&self.scene, name)?);
        Ok(&self.rests[self.rests.len() - 1])
    }

    /// Sets an object's vertices, and its normals or none. If it moved while images are taken, it stands still from then on.
    pub(super) fn put(&mut self, name: &str, positions: Vec<DVec3>, normals: Option<Vec<Vec3>>) -> Result<()> {
        if let Some(v) = positions.iter().find(|p| !p.is_finite()) {
            return Err(Error::input(format!("{name}: a vertex would lie at {v}; use finite numbers")));
        }
        let Some(rest) = self.rests.iter().find(|rest| rest.name == name) else { return Ok(()) };
        let mesh = Arc::make_mut(&mut self.scene.mesh);
        mesh.positions[rest.vertices.clone()].copy_from_slice(&positions);
        if let Some(steps) = self.scene.steps.take() {
            let still = TimeSteps::with(Some(&steps), mesh, rest.vertices.clone(), (&[0.0], &[positions]));
            self.scene.steps = still.map(Arc::new);
        }
        match normals {
            // none are left after set_vertices
            Some(normals) if normals.len() == rest.normals.len() => {
                if let Some(steps) = &mut self.scene.steps {
                    Arc::make_mut(steps).set_normals(rest.normals.clone(), &normals);
                }
                mesh.normals[rest.normals.clone()].copy_from_slice(&normals);
            }
            _ => {
                if let Some(corners) = mesh.corner_normals.get_mut(rest.triangles.clone()) {
                    corners.fill([NO_NORMAL; 3]);
                }
            }
        }
        Ok(())
    }
}
