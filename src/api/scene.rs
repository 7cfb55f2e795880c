//! Scenes.

use super::objects::Rest;
use super::{Camera, Mesh};
use crate::geometry::instances::{Instances, Part, infinite_vertex};
use crate::geometry::load::{Object, load_dressed, load_unplaced, placed, with_unique_names};
use crate::geometry::spec::MeshSpec;
use crate::geometry::texture::{Images, ImagesRead};
use crate::input::{Error, Limits, Loading, Result};
use crate::scene::cameras::Cameras;
use crate::scene::file;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Triangles with materials, lights, and the camera that looks at them: `docs/reference/scene-file.md`.
///
/// World units are the user's; coordinates are f64. Triangle ids count the triangles of all meshes from 0, in the order in which they
/// were added.
#[derive(Debug, Clone)]
pub struct Scene {
    pub(crate) scene: crate::scene::Scene,
    has_camera: bool,
    /// Objects that were moved.
    pub(super) rests: Vec<Rest>,
    /// The scene before objects moved, while each moves by a matrix alone.
    pub(super) at_rest: Option<Arc<Instances>>,
    /// The last cameras that were compiled for it and its clones.
    pub(super) cameras: Arc<Cameras>,
}

/// Triangles in the world, to be added to a scene: [`Scene::add_placed`].
#[derive(Debug, Clone)]
pub struct Placed {
    part: Part,
    objects: Vec<Object>,
}

impl Placed {
    /// A mesh with the keys of a scene file's `[[mesh]]` that say where it is and what it looks like, such as `translate` and `color`: a table
    /// in TOML, or in JSON where it begins with a brace. Relative paths in it start from `folder`.
    ///
    /// # Errors
    /// [`Error::Input`] for a wrong key or value, [`Error::Missing`] or [`Error::Read`] for a file that cannot be read.
    pub fn of_mesh(mesh: Mesh, table: &str, folder: impl AsRef<Path>) -> Result<Placed> {
        Placed::of_mesh_within(mesh, table, folder, Limits::default())
    }

    /// [`Placed::of_mesh`] within other limits.
    ///
    /// # Errors
    /// As [`Placed::of_mesh`].
    pub fn of_mesh_within(mesh: Mesh, table: &str, folder: impl AsRef<Path>, limits: Limits) -> Result<Placed> {
        let (loading, mut images) = (Loading::new(limits), Images::of(ImagesRead::All));
        let spec = file::look_of(table, folder.as_ref(), &loading)?;
        let own = MeshSpec { name: spec.name.clone().or(Some(mesh.name)), ..spec };
        Placed::of(load_dressed(&own, mesh.mesh, &mut images, &loading)?, &own, &loading)
    }

    /// The mesh of a scene file's `[[mesh]]`, given as in [`Placed::of_mesh`].
    ///
    /// # Errors
    /// As [`Placed::of_mesh`].
    pub fn of_table(table: &str, folder: impl AsRef<Path>) -> Result<Placed> {
        Placed::of_table_within(table, folder, Limits::default())
    }

    /// [`Placed::of_table`] within other limits.
    ///
    /// # Errors
    /// As [`Placed::of_mesh`].
    pub fn of_table_within(table: &str, folder: impl AsRef<Path>, limits: Limits) -> Result<Placed> {
        let (loading, mut images) = (Loading::new(limits), Images::of(ImagesRead::All));
        let spec = file::mesh_of(table, folder.as_ref(), &loading)?;
        Placed::of(load_unplaced(&spec, &mut images, &loading)?, &spec, &loading)
    }

    fn of(mesh: crate::geometry::mesh::Mesh, spec: &MeshSpec, loading: &Loading) -> Result<Placed> {
        let (part, objects) = placed(mesh, spec, loading)?;
        Ok(Placed { part, objects })
    }
}

impl Default for Scene {
    fn default() -> Scene {
        Scene::new()
    }
}

impl Scene {
    /// A scene without triangles, in the light of a headlight along each pixel's ray, and without a camera.
    pub fn new() -> Scene {
        Scene::of(crate::scene::Scene::empty(), false)
    }

    fn of(scene: crate::scene::Scene, has_camera: bool) -> Scene {
        Scene { scene, has_camera, rests: Vec::new(), at_rest: None, cameras: Arc::default() }
    }

    /// Loads a scene file, .toml or .json, and all files that it names. `overrides` change values, as in `camera.vfov=40`; keyframed
    /// values are evaluated at `frame`.
    ///
    /// # Errors
    /// [`Error::Input`], one line with the file, the line and the key; [`Error::Missing`] or [`Error::Read`] for a file that cannot be read.
    pub fn load(path: impl AsRef<Path>, overrides: &[&str], frame: f64) -> Result<Scene> {
        Scene::load_within(path, overrides, frame, Limits::default())
    }

    /// [`Scene::load`] within other limits, which the scene keeps: see [`Scene::set_limits`].
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn load_within(path: impl AsRef<Path>, overrides: &[&str], frame: f64, limits: Limits) -> Result<Scene> {
        let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
        let scene = crate::scene::Scene::load(path.as_ref(), &overrides, frame, &Loading::new(limits))?;
        Ok(Scene::of(scene, true))
    }

    /// A scene from the text of a scene file in TOML, whose relative paths start from `folder`. It needs a camera, and may have no mesh.
    ///
    /// # Errors
    /// [`Error::Input`], one line with the line and the key; [`Error::Missing`] or [`Error::Read`] for a file that cannot be read.
    pub fn parse(toml: &str, folder: impl AsRef<Path>) -> Result<Scene> {
        Scene::parse_within(toml, folder, Limits::default())
    }

    /// [`Scene::parse`] within other limits, which the scene keeps: see [`Scene::set_limits`].
    ///
    /// # Errors
    /// As [`Scene::parse`].
    pub fn parse_within(toml: &str, folder: impl AsRef<Path>, limits: Limits) -> Result<Scene> {
        let loading = Loading::new(limits);
        let file = file::of_text(toml, &folder.as_ref().join("scene"), 0.0, &loading)?;
        Ok(Scene::of(crate::scene::Scene::from_file(file, &loading)?, true))
    }

    /// Sets the limits on what is read for the scene and computed from it from now on: its cameras, volumes, pictures, spheres and gradients.
    /// The limits on images are in [`RenderOptions`](super::RenderOptions).
    pub fn set_limits(&mut self, limits: Limits) {
        self.scene.limits = limits;
        // another limit may refuse a kept camera
        self.cameras = Arc::default();
    }

    /// Adds a mesh after the existing ones. Cameras that depend on the scene, such as `track`, must be created again.
    ///
    /// # Errors
    /// [`Error::Input`] if there are too many triangles, or the scene has caustics, which are computed from the meshes of its file; the
    /// scene is then unchanged.
    pub fn add(&mut self, mesh: Mesh) -> Result<()> {
        let added = Object { name: mesh.name, triangles: mesh.mesh.triangles.len() };
        self.append((mesh.mesh, None), vec![added])
    }

    /// Adds spheres after the existing meshes: centres and radii, world units, and a colour for each, linear RGB in [0, 1], if some are given.
    ///
    /// # Errors
    /// Those of [`Mesh::spheres`], [`Mesh::with_colors`] and [`Scene::add`].
    pub fn add_spheres(&mut self, centers: &[[f64; 3]], radii: &[f64], colors: Option<&[[f32; 3]]>) -> Result<()> {
        let spheres = Mesh::spheres_within(centers, radii, self.scene.limits)?;
        self.add(match colors {
            Some(colors) => spheres.with_colors(colors.to_vec())?,
            None => spheres,
        })
    }

    /// Adds capsules after the existing meshes: the ends of their segments and their radii, world units, and a colour for each capsule, linear RGB
    /// in [0, 1], if some are given.
    ///
    /// # Errors
    /// The errors of [`Mesh::capsules`], [`Mesh::with_colors`] and [`Scene::add`].
    pub fn add_capsules(&mut self, ends: &[[[f64; 3]; 2]], radii: &[f64], colors: Option<&[[f32; 3]]>) -> Result<()> {
        let capsules = Mesh::capsules_within(ends, radii, self.scene.limits)?;
        self.add(match colors {
            Some(colors) => capsules.with_colors(colors.iter().flat_map(|color| [*color; 2]).collect())?,
            None => capsules,
        })
    }

    /// Adds triangles, spheres or capsules that have been placed.
    ///
    /// # Errors
    /// As [`Scene::add`].
    pub fn add_placed(&mut self, placed: Placed) -> Result<()> {
        self.append(placed.part, placed.objects)
    }

    fn append(&mut self, part: Part, added: Vec<Object>) -> Result<()> {
        if self.scene.caustics.is_some() {
            return Err(Error::input("a scene with caustics takes its meshes from its file; add this one there"));
        }
        if let Some(v) = infinite_vertex(&part) {
            return Err(Error::input(format!("mesh: a vertex lies at {v} after its transform; use finite numbers")));
        }
        self.copy_places()?;
        Arc::make_mut(&mut self.scene.mesh).append(part, self.scene.limits)?;
        let objects = std::mem::take(&mut self.scene.objects);
        self.scene.objects = with_unique_names(objects.into_iter().chain(added));
        Ok(())
    }

    /// Whether it comes from a scene file, which has a camera.
    pub fn has_camera(&self) -> bool {
        self.has_camera
    }

    /// The scene's camera for an image of the scene's size.
    ///
    /// # Errors
    /// [`Error::Input`] if the scene has no camera or no size, or the camera's values contradict each other.
    pub fn camera(&self) -> Result<Camera> {
        self.camera_of(None)
    }

    /// The same for an image of `width x height` pixels.
    ///
    /// # Errors
    /// As [`Scene::camera`].
    pub fn camera_of_size(&self, width: u32, height: u32) -> Result<Camera> {
        self.camera_of(Some((width, height)))
    }

    fn camera_of(&self, size: Option<(u32, u32)>) -> Result<Camera> {
        if !self.has_camera {
            return Err(Error::input("the scene has no camera; give one"));
        }
        let started = Instant::now();
        self.cameras.next_scene();
        let camera = self.cameras.of_scene(&self.scene, size, true, &Loading::new(self.scene.limits))?;
        Ok(Camera::compiled(camera, self.scene.camera_keys.clone(), started))
    }

    /// The number of triangles and spheres.
    pub fn triangle_count(&self) -> usize {
        self.scene.mesh.triangle_count()
    }

    /// Least and greatest corner of the bounding box of all vertices, world units; `None` without vertices.
    pub fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        self.scene.bounds().map(|(lo, hi)| [lo.to_array(), hi.to_array()])
    }

    /// Name and triangle count of each object, in id order.
    pub fn objects(&self) -> impl Iterator<Item = (&str, usize)> {
        self.scene.objects.iter().map(|object| (object.name.as_str(), object.triangles))
    }

    /// Missing files and attributes that mesh files refer to, one line each. The scene was loaded without them.
    pub fn missing(&self) -> impl Iterator<Item = String> {
        self.scene.mesh.base().missing.iter().map(|missing| format!("{}: {}", missing.what, missing.why))
    }
}
