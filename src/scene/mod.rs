//! Scenes: the file a user writes, and the triangles, lights and camera it stands for.

pub mod caustics;
pub mod file;
pub mod hash;
pub mod labels;
pub mod library;
pub mod light;
pub mod matrices;
pub mod motion;
pub mod sky;
pub mod style;

use crate::camera::Camera;
use crate::camera::optics::Surface;
use crate::camera::spec::CameraSpec;
use crate::geometry::load::Object;
use crate::geometry::mesh::Mesh;
use crate::geometry::place;
use crate::geometry::texture::ImagesRead;
use crate::image::frame::Channel;
use crate::image::tone::Tone;
use crate::input::{Error, Result};
use crate::scene::caustics::Caustics;
use file::{CameraKeys, SceneFile};
use glam::DVec3;
use library::Library;
use light::{AmbientOcclusion, Light};
use sky::Sky;
use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;
use style::Style;

/// Everything that a frame needs, loaded.
#[derive(Debug, Clone)]
pub struct Scene {
    /// All meshes placed in the world, one after the other.
    pub mesh: Arc<Mesh>,
    /// What the meshes are called, and how many triangles each has, in order.
    pub objects: Vec<Object>,
    /// None: one headlight along each pixel's own ray.
    pub lights: Vec<Light>,
    /// Lines and strokes.
    pub style: Style,
    /// How light from all around, and the headlight, is hidden by what is near.
    pub ambient_occlusion: Option<AmbientOcclusion>,
    /// Light from all around, instead of what comes from everywhere alike.
    pub sky: Option<Arc<Sky>>,
    /// Linear RGB.
    pub background: [f32; 3],
    /// How colours become an 8-bit picture.
    pub tone: Tone,
    /// The image's size in pixels, unless the camera brings its own.
    pub size: Option<(u32, u32)>,
    pub camera: CameraSpec,
    /// The camera's keys as in the scene file; empty if the camera is not from a file.
    pub camera_keys: Arc<CameraKeys>,
    /// Light that comes by way of a mirror or a lens.
    pub caustics: Option<Arc<Caustics>>,
    pub output: file::OutputSpec,
}

impl Scene {
    /// Loads a scene file with every mesh that it names; `overrides` are `key=value` pairs, and `frame` is where values given
    /// as keyframes are taken. See [`file::load`].
    pub fn load(path: &Path, overrides: &[String], frame: f64) -> Result<Scene> {
        Scene::from_file(file::load(path, overrides, frame)?)
    }

    pub fn from_file(file: SceneFile) -> Result<Scene> {
        Library::for_once().scene(file, ImagesRead::All)
    }

    /// The scene's camera for an image of its size.
    pub fn camera(&self) -> Result<Camera> {
        Camera::in_scene(&self.camera, self.size, &self.mesh)
    }

    /// Every channel that pictures of the scene through a camera have, except `certified`, which is requested by name.
    pub fn channels(&self, camera: &Camera) -> Vec<Channel> {
        let is_available = |c: &Channel| match c {
            Channel::Certified => false,
            Channel::TextureU | Channel::TextureV => !self.mesh.corner_uvs.is_empty(),
            _ => true,
        };
        camera.channels().into_iter().chain(Channel::MORE.into_iter().filter(is_available)).collect()
    }

    /// The scene with the facets of the camera's optics as its last triangles; itself where there are none.
    pub fn with_optics(&self, camera: &Camera) -> Cow<'_, Scene> {
        let Some(Surface::Facets { facets, .. }) = camera.optics.as_ref().map(|o| &o.surface) else {
            return Cow::Borrowed(self);
        };
        let base = camera.optics.as_ref().map_or([0.0; 3], |o| o.base);
        let mut scene = self.clone();
        place::append(Arc::make_mut(&mut scene.mesh), facets.mesh(base));
        Cow::Owned(scene)
    }

    /// Something may be in the way of light.
    pub fn has_shadows(&self) -> bool {
        self.ambient_occlusion.is_some() || self.lights.iter().any(|l| l.casts_shadows)
    }

    /// # Errors
    /// [`Error::Input`] where shadows would be of holes.
    pub fn check_shadows(&self) -> Result<()> {
        if self.has_shadows() && self.mesh.has_holes() {
            return Err(Error::input(SHADOWS_AND_HOLES.join("; ")));
        }
        Ok(())
    }

    /// The corners of the box around all vertices; `None` without any.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        self.mesh.bounds()
    }
}

/// Why there are no shadows where images cut holes, and what to do.
pub const SHADOWS_AND_HOLES: [&str; 2] = ["shadows know no holes that images cut into triangles", "leave either out"];
