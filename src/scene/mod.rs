//! Scenes: the file a user writes, and the triangles, lights and camera it stands for.

pub mod clusters;
pub mod file;
pub mod generate;
pub mod gltf;
pub mod heights;
pub mod labels;
pub mod library;
pub mod light;
pub mod mesh;
pub mod obj;
pub mod pattern;
pub mod place;
pub mod places;
pub mod sky;
mod smooth;
pub mod style;
pub mod texture;
pub mod tone;

use crate::camera::Camera;
use crate::caustics::Caustics;
use crate::error::{Error, Result};
use crate::optics::Surface;
use file::{CameraKeys, CameraSpec, MeshSource, MeshSpec, SceneFile, TextureSpec};
use glam::DVec3;
use library::Library;
use light::{AmbientOcclusion, Light};
use mesh::Mesh;
use sky::Sky;
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::Arc;
use style::Style;
use texture::{Images, ImagesRead, Texture};
use tone::Tone;

/// Consecutive triangles that have one name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Object {
    /// Unlike any other's.
    pub name: String,
    pub triangles: usize,
}

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
            return Err(Error::input("shadows know no holes that images cut into triangles; leave either out"));
        }
        Ok(())
    }

    /// The corners of the box around all vertices; `None` without any.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        self.mesh.bounds()
    }
}

/// Gives objects different names: of those with one name, all but the first get the least number that makes it unique, as in `box.2`.
fn named_apart(objects: impl Iterator<Item = Object>) -> Vec<Object> {
    let mut taken = HashSet::new();
    // the last number given to each name: smaller ones are taken
    let mut numbers: HashMap<String, usize> = HashMap::new();
    let mut apart = |name: String| {
        let mut own = name.clone();
        while !taken.insert(own.clone()) {
            let number = numbers.entry(name.clone()).or_insert(1);
            *number += 1;
            own = format!("{name}.{number}");
        }
        own
    };
    objects.map(|object| Object { name: apart(object.name), ..object }).collect()
}

/// The triangles of a mesh in the world; its images come from `images`.
pub(crate) fn load_mesh(spec: &MeshSpec, images: &mut Images) -> Result<Mesh> {
    Ok(placed(load_unplaced(spec, images)?, spec)?.0)
}

/// A mesh in the world, and its objects: one, or one for each copy, named name#0, name#1 and so on.
fn placed(mesh: Mesh, spec: &MeshSpec) -> Result<(Mesh, Vec<Object>)> {
    let (name, triangles) = (spec.called(), mesh.triangles.len());
    let mesh = place::place(mesh, spec.scale, spec.rotate, spec.translate);
    let Some(places) = &spec.places else { return Ok((mesh, vec![Object { name, triangles }])) };
    let places = places.load()?;
    let mesh = place::copies(mesh, &places).map_err(|e| e.at(format_args!("mesh {name}")))?;
    Ok((mesh, (0..places.len()).map(|k| Object { name: format!("{name}#{k}"), triangles }).collect()))
}

/// The triangles of a mesh, before they are placed in the world.
fn load_unplaced(spec: &MeshSpec, images: &mut Images) -> Result<Mesh> {
    let mut none = Images::left_out();
    let files = if spec.outside_files { gltf::Files::Anywhere } else { gltf::Files::Below };
    // what it says itself goes before what its file says
    let of_file = if spec.texture == TextureSpec::OfFile && spec.color.is_none() { &mut *images } else { &mut none };

    let mut mesh = match &spec.source {
        MeshSource::Builtin(builtin) => generate::generate(builtin)?,
        MeshSource::Heights(heights) => heights::load(heights)?,
        MeshSource::File(path) => {
            let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
            match extension.as_str() {
                "obj" => obj::load(path, of_file)?,
                "gltf" | "glb" => gltf::load(path, files, of_file)?,
                _ => {
                    let name = path.display();
                    return Err(Error::input(format!(
                        "{name}: unknown kind of mesh file; use .obj, .gltf or .glb, or .asc, .png or .tif with heights"
                    )));
                }
            }
        }
    };
    if spec.smooth {
        smooth::smooth(&mut mesh);
    }
    for material in &mut mesh.materials {
        material.two_sided = spec.two_sided;
        material.diffuse = spec.color.unwrap_or(material.diffuse);
        spec.gloss.apply(material);
        if let Some(pattern) = spec.pattern {
            material.pattern = Some(pattern);
            material.diffuse = spec.color.unwrap_or([1.0; 3]);
        }
    }
    if let TextureSpec::Image { file, repeat, cutoff } = &spec.texture {
        if mesh.corner_uvs.is_empty() {
            let name = spec.called();
            return Err(Error::input(format!("mesh {name}: has no texture coordinates; leave texture out")));
        }
        let texture = match images.read.reads(cutoff.is_some()) {
            true => Some(Texture { cutoff: *cutoff, ..Texture::new(images.load(file)?) }),
            false => None,
        };
        for material in &mut mesh.materials {
            material.texture.clone_from(&texture);
            material.diffuse = spec.color.unwrap_or([1.0; 3]);
        }
        mesh.repeat_uvs(repeat.as_vec2());
    }
    Ok(mesh)
}
