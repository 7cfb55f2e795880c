//! Objects of a scene that move or change their shape.

use super::Scene;
use crate::geometry::instances::{Instance, Instances};
use crate::geometry::mesh::{Mesh, NO_NORMAL};
use crate::geometry::place::{STRETCH_MAX, keeps_spheres, size_of, transformed_normal, world_normal_from_object};
use crate::geometry::scene_mesh::SceneMesh;
use crate::geometry::time_steps::TimeSteps;
use crate::input::{Error, Result};
use glam::{DAffine3, DMat3, DVec3, Vec3};
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
        if let Some(instances) = self.instances_of(name)? {
            return self.move_instances(name, instances, place);
        }
        self.or_unchanged(|scene| scene.move_vertices(name, place))
    }

    /// Moves an object's vertices and normals.
    fn move_vertices(&mut self, name: &str, place: DAffine3) -> Result<()> {
        let mut triangles = self.rest(name)?.triangles.clone();
        let is_sphere = |id: usize| self.scene.mesh.radius(id as u32).is_some();
        if triangles.any(is_sphere) && (!keeps_spheres(&place) || (size_of(&place) - 1.0).abs() > STRETCH_MAX) {
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
        self.or_unchanged(|scene| {
            let count = scene.rest(name)?.positions.len();
            if vertices.len() != count {
                let given = vertices.len();
                return Err(Error::input(format!(
                    "{name}: {given} vertices for an object of {count}, from the first to the last that a triangle uses"
                )));
            }
            let positions: Vec<DVec3> = vertices.iter().map(|v| DVec3::from_array(*v)).collect();
            scene.put(name, positions.clone(), None)?;
            if let Some(rest) = scene.rests.iter_mut().find(|rest| rest.name == name) {
                rest.positions = positions;
                rest.directions = Vec::new();
            }
            Ok(())
        })
    }

    /// Runs a change of vertices. If it fails, the scene's instances and the objects that have moved are as before.
    pub(super) fn or_unchanged(&mut self, change: impl FnOnce(&mut Scene) -> Result<()>) -> Result<()> {
        let instances = self.at_rest.clone().map(|at_rest| (self.scene.clone(), at_rest));
        let known = self.rests.len();
        let done = change(self);
        if done.is_err() {
            self.rests.truncate(known);
            if let Some((scene, at_rest)) = instances {
                (self.scene, self.at_rest) = (scene, Some(at_rest));
            }
        }
        done
    }

    /// The instances that are an object, where objects can move by matrices alone: no vertex was set or moves while images are taken, and there are
    /// no spheres. From the first such move on the scene is made of instances.
    fn instances_of(&mut self, name: &str) -> Result<Option<Range<usize>>> {
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

    /// Moves an object that is some instances.
    fn move_instances(&mut self, name: &str, instances: Range<usize>, place: DAffine3) -> Result<()> {
        let Some(at_rest) = &self.at_rest else { return Ok(()) };
        let moved = |own: &Instance| {
            let matrix = match own.matrix {
                _ if place == DAffine3::IDENTITY => own.matrix,
                Some(own) => Some(place * own),
                None => Some(place),
            };
            Instance { matrix, ..own.clone() }
        };
        let moved: Vec<Instance> = at_rest.list[instances.clone()].iter().map(moved).collect();
        let corners = moved.iter().filter(|own| !own.vertices.is_empty()).map(|own| own.placed_box(own.bounds));
        if let Some(v) = corners.flat_map(|(lo, hi)| [lo, hi]).find(|p| !p.is_finite()) {
            return Err(Error::input(format!("{name}: a vertex would lie at {v}; use finite numbers")));
        }
        let mesh = Arc::make_mut(&mut self.scene.mesh);
        instances.zip(moved).for_each(|(k, own)| mesh.place(k, own.matrix));
        Ok(())
    }

    /// Turns the instances of the scene into one mesh, with moved objects at their present places, and keeps their earlier vertices in `rests`.
    pub(super) fn copy_places(&mut self) -> Result<()> {
        let Some(at_rest) = &self.at_rest else { return Ok(()) };
        self.scene.mesh.check_copies(self.scene.limits)?;
        let Some(now) = self.scene.mesh.instances().cloned() else { return Ok(()) };
        let mesh = self.scene.mesh.mesh().clone();
        let moved = crate::scene::Scene { mesh: Arc::new(mesh.into()), ..self.scene.clone() };
        // where the copies of each instance's vertices and normals begin
        let starts = at_rest.list.iter().scan((0, 0), |(vertex, normal), instance| {
            let own = (*vertex, *normal);
            (*vertex, *normal) = (*vertex + instance.vertices.len(), *normal + instance.normals.len());
            Some(own)
        });
        let starts: Vec<(usize, usize)> = starts.collect();
        let (mut rests, mut first_id) = (Vec::new(), 0);
        for object in &moved.objects {
            let ids = first_id..first_id + object.triangles;
            first_id = ids.end;
            let Some(own) = at_rest.exactly(&ids) else { continue };
            if own.clone().all(|k| at_rest.list[k].matrix == now.list[k].matrix) {
                continue;
            }
            // the object as it was, where the copies have it now
            let mut rest = Rest::of(&moved, &object.name)?;
            for k in own {
                let (was, (first_vertex, first_normal)) = (&at_rest.list[k], starts[k]);
                for v in was.vertices.clone() {
                    let copy = first_vertex + (v - was.vertices.start) as usize;
                    if rest.vertices.contains(&copy) {
                        rest.positions[copy - rest.vertices.start] = was.placed(at_rest.base.positions[v as usize]);
                    }
                }
                for n in was.normals.clone() {
                    let copy = first_normal + (n - was.normals.start) as usize;
                    if rest.normals.contains(&copy) {
                        rest.directions[copy - rest.normals.start] =
                            was.placed_normal(at_rest.base.normals[n as usize]);
                    }
                }
            }
            rests.push(rest);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::generate::soup;
    use crate::geometry::instances::at_places;
    use crate::geometry::load::Object;

    /// An object of 80 instances, as a glTF file of many nodes, before an object of one.
    #[test]
    fn an_object_of_several_instances_moves_as_one() {
        let part = |seed: u64, places: u32| {
            at_places(soup(seed, 1000), (0..places).map(|k| DAffine3::from_translation(3.0 * f64::from(k) * DVec3::X)))
        };
        let object = |name: &str, triangles: usize| Object { name: name.into(), triangles };
        let mut scene = Scene::new();
        let instances = Instances::new(vec![part(1, 80), part(2, 1)]).unwrap();
        scene.scene.mesh = Arc::new(Arc::new(instances).into());
        scene.scene.objects = vec![object("many", 80_000), object("one", 1000)];
        let at_rest = scene.scene.mesh.instances().unwrap().copies();
        let up = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 5.0], [0.0, 0.0, 1.0, 0.0]];
        scene.move_object("many", up).unwrap();
        let count = 80 * soup(1, 1000).positions.len();
        let moved = |scene: &Scene| -> Vec<DVec3> {
            let positions = &scene.scene.mesh.positions;
            positions.iter().zip(&at_rest.positions).map(|(now, was)| *now - *was).collect()
        };
        let is_up = |offsets: &[DVec3]| offsets.iter().all(|v| (*v - 5.0 * DVec3::Y).length() < 1e-12);
        let offsets = moved(&scene);
        assert!(is_up(&offsets[..count]) && offsets[count..].iter().all(|v| *v == DVec3::ZERO));
        assert!(scene.scene.mesh.instances().is_some());
        // a refused change leaves a scene of instances as it was
        assert!(scene.set_vertices("one", &[[0.0; 3]; 2]).is_err() && scene.set_vertices("none", &[]).is_err());
        assert!(scene.set_vertices("one", &vec![[f64::NAN; 3]; at_rest.positions.len() - count]).is_err());
        assert!(scene.scene.mesh.instances().is_some() && scene.rests.is_empty() && is_up(&moved(&scene)[..count]));
        // other vertices of another object copy all instances; the first object can still go back
        let vertices: Vec<[f64; 3]> = at_rest.positions[count..].iter().map(|p| p.to_array()).collect();
        scene.set_vertices("one", &vertices).unwrap();
        assert!(scene.scene.mesh.instances().is_none() && is_up(&moved(&scene)[..count]));
        scene.move_object("many", [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]).unwrap();
        assert!(scene.scene.mesh.positions == at_rest.positions);
        let far = [[1.0, 0.0, 0.0, f64::INFINITY], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        assert!(scene.move_object("many", far).is_err());
    }
}
