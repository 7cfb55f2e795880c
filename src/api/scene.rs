//! Scenes.

use super::{Camera, Mesh};
use crate::geometry::load::{Object, with_unique_names};
use crate::geometry::place;
use crate::input::{Error, Result};
use crate::scene::file;
use std::path::Path;
use std::sync::Arc;

/// Triangles with materials, lights, and the camera that looks at them: `docs/reference/scene-file.md`.
///
/// World units are the user's; coordinates are f64. Triangle ids count the triangles of all meshes from 0, in the order in which they
/// were added.
#[derive(Debug, Clone)]
pub struct Scene {
    pub(crate) scene: crate::scene::Scene,
}

impl Scene {
    /// Loads a scene file, .toml or .json, and all files that it names. `overrides` change values, as in `camera.vfov=40`; keyframed
    /// values are evaluated at `frame`.
    ///
    /// # Errors
    /// [`Error::Input`], one line with the file, the line and the key.
    pub fn load(path: impl AsRef<Path>, overrides: &[&str], frame: f64) -> Result<Scene> {
        let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
        Ok(Scene { scene: crate::scene::Scene::load(path.as_ref(), &overrides, frame)? })
    }

    /// A scene from the text of a scene file in TOML, whose relative paths start from `folder`. It needs a camera, and may have no mesh.
    ///
    /// # Errors
    /// [`Error::Input`], one line with the line and the key.
    pub fn parse(toml: &str, folder: impl AsRef<Path>) -> Result<Scene> {
        Ok(Scene { scene: crate::scene::Scene::from_file(file::parse_text(toml, folder.as_ref())?)? })
    }

    /// Adds a mesh after the existing ones. Cameras that depend on the scene, such as `track`, must be created again.
    ///
    /// # Errors
    /// [`Error::Input`] if there are too many triangles, or the scene has caustics, which are computed from the meshes of its file; the
    /// scene is then unchanged.
    pub fn add(&mut self, mesh: Mesh) -> Result<()> {
        if self.scene.caustics.is_some() {
            return Err(Error::input("a scene with caustics takes its meshes from its file; add this one there"));
        }
        place::check_counts([&*self.scene.mesh, &mesh.mesh])?;
        let triangles = mesh.mesh.triangles.len();
        place::append_with_all(Arc::make_mut(&mut self.scene.mesh), mesh.mesh);
        let objects = std::mem::take(&mut self.scene.objects);
        let added = Object { name: mesh.name, triangles };
        self.scene.objects = with_unique_names(objects.into_iter().chain([added]));
        Ok(())
    }

    /// The scene's camera for an image of the scene's size.
    ///
    /// # Errors
    /// [`Error::Input`] if the scene has no size, or the camera's values contradict each other.
    pub fn camera(&self) -> Result<Camera> {
        Ok(Camera { camera: Arc::new(self.scene.camera()?) })
    }

    /// The same for an image of `width x height` pixels.
    ///
    /// # Errors
    /// As [`Scene::camera`].
    pub fn camera_of_size(&self, width: u32, height: u32) -> Result<Camera> {
        let size = Some((width, height));
        let camera = crate::camera::Camera::in_scene(&self.scene.camera, size, &self.scene.mesh)?;
        Ok(Camera { camera: Arc::new(camera) })
    }

    /// The number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.scene.mesh.triangles.len()
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
        self.scene.mesh.missing.iter().map(|missing| format!("{}: {}", missing.what, missing.why))
    }
}
