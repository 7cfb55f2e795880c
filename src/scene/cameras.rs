//! Compiled cameras, kept while their keys, their files and the parts of the scene that they depend on are unchanged.

use super::Scene;
use super::shelf::Shelf;
use crate::camera::Camera;
use crate::camera::recipe::{SceneUse, Surroundings};
use crate::camera::spec::CameraSpec;
use crate::geometry::scene_mesh::SceneMesh;
use crate::input::{Loading, Result};
use glam::DVec3;
use std::sync::{Arc, Weak};

/// Cameras by their keys and sizes.
#[derive(Debug, Default)]
pub struct Cameras {
    shelf: Shelf<CameraKey, (Arc<Camera>, Around)>,
}

/// A camera, and the size of its image.
pub type CameraKey = (CameraSpec, Option<(u32, u32)>);

/// The scene that a camera was built for.
#[derive(Debug)]
struct Around {
    scene_use: SceneUse,
    /// The mesh; only to recognize it.
    mesh: Weak<SceneMesh>,
    /// The bounds of the mesh, where the camera depends on no more of it.
    bounds: Option<(DVec3, DVec3)>,
    /// The field of [`Surroundings`].
    beside: Option<(DVec3, DVec3)>,
    is_endless: bool,
}

impl Around {
    fn of(scene_use: SceneUse, mesh: &Arc<SceneMesh>, seen: &Surroundings) -> Around {
        let bounds = if scene_use == SceneUse::Bounds { mesh.bounds() } else { None };
        let Surroundings { beside, is_endless, .. } = *seen;
        Around { scene_use, mesh: Arc::downgrade(mesh), bounds, beside, is_endless }
    }

    /// Whether a camera that was built here is the same in another scene.
    fn is_like(&self, mesh: &Arc<SceneMesh>, seen: &Surroundings) -> bool {
        let is_same = (self.beside, self.is_endless) == (seen.beside, seen.is_endless);
        let is_same_mesh = || self.mesh.as_ptr() == Arc::as_ptr(mesh);
        match self.scene_use {
            SceneUse::Nothing => true,
            SceneUse::Bounds => is_same && (is_same_mesh() || self.bounds == mesh.bounds()),
            SceneUse::Mesh => is_same && is_same_mesh(),
        }
    }
}

impl Cameras {
    /// Ages all cameras, and drops old ones.
    pub fn next_scene(&self) {
        self.shelf.next_scene();
    }

    /// The scene's camera for an image of `size`, or of the scene's own.
    ///
    /// # Errors
    /// Those of [`Camera::in_scene`].
    pub fn of_scene(
        &self,
        scene: &Scene,
        size: Option<(u32, u32)>,
        keeps: bool,
        loading: &Loading,
    ) -> Result<Arc<Camera>> {
        let size = size.or(scene.size);
        if !scene.camera_steps.is_empty() {
            return scene.camera_of_size(size, loading).map(Arc::new);
        }
        self.get((scene.camera.clone(), size), &scene.mesh, scene.surroundings(), keeps, loading)
    }

    /// A camera in the scene of `mesh`, which is the mesh of `seen`; kept if it `keeps`.
    ///
    /// # Errors
    /// Those of [`Camera::in_scene`].
    pub fn get(
        &self,
        key: CameraKey,
        mesh: &Arc<SceneMesh>,
        seen: Surroundings,
        keeps: bool,
        loading: &Loading,
    ) -> Result<Arc<Camera>> {
        let suits = |(_, around): &(Arc<Camera>, Around)| around.is_like(mesh, &seen);
        let make = |loading: &Loading| {
            let camera = Camera::in_scene(&key.0, key.1, seen, loading)?;
            let around = Around::of(camera.scene_use, mesh, &seen);
            Ok((Arc::new(camera), around))
        };
        Ok(self.shelf.get(&key, keeps, suits, loading, make)?.0.clone())
    }
}
