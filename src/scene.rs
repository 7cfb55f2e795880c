//! Scenes: loading a scene file into triangles, lights and a camera.

pub mod cameras;
pub mod caustics;
pub mod composition;
pub mod file;
pub mod gradients;
pub mod hash;
#[cfg(any(feature = "cli", feature = "view"))]
pub mod keys;
pub mod labels;
pub mod library;
pub mod light;
pub mod matrices;
pub mod motion;
mod poses;
pub mod projector_light;
mod shelf;
pub mod sky;
pub mod style;
pub mod volume;

use crate::arrays::MapEach;
use crate::camera::Camera;
use crate::camera::exposure::Exposure;
use crate::camera::kinds::pinhole::Pinhole;
use crate::camera::moving::Moving;
use crate::camera::optics::Surface;
use crate::camera::recipe::{Surroundings, Triangles};
use crate::camera::spec::{CameraKind, CameraSpec};
use crate::geometry::load::Object;
use crate::geometry::mesh::joined;
use crate::geometry::place;
use crate::geometry::primitive::Primitive;
use crate::geometry::scene_mesh::SceneMesh;
use crate::geometry::texture::ImagesRead;
use crate::geometry::time_steps::{Moment, MovingMesh, TimeSteps};
use crate::image::frame::Channel;
use crate::image::tone::Tone;
use crate::input::{Error, Limits, Loading, Result};
use crate::parallel;
use crate::scene::caustics::Caustics;
use file::{CameraKeys, SceneFile};
use glam::DVec3;
use library::Library;
use light::{AmbientOcclusion, Light};
use projector_light::ProjectorLight;
use sky::Sky;
use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;
use style::Style;
use volume::Volume;

/// A loaded scene: everything that a frame needs.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The triangles of all meshes in the world, one mesh after the other.
    pub mesh: Arc<SceneMesh>,
    /// Name and triangle count of each object, in id order.
    pub objects: Vec<Object>,
    /// If empty, a headlight shines along each pixel's ray.
    pub lights: Vec<Light>,
    /// Pictures that are thrown onto surfaces. Those that are lights are among the scene's.
    pub projector_lights: Vec<Arc<ProjectorLight>>,
    /// Lines and strokes.
    pub style: Style,
    /// Ambient occlusion, for ambient light and the headlight.
    pub ambient_occlusion: Option<AmbientOcclusion>,
    /// Environment light; replaces the constant ambient light.
    pub sky: Option<Arc<Sky>>,
    /// What rays pass through.
    pub volume: Option<Volume>,
    /// Linear RGB.
    pub background: [f32; 3],
    /// Tone mapping of 8-bit images.
    pub tone: Tone,
    /// Near and far of the channels of normalised depth, world units.
    pub depth_range: Option<[f64; 2]>,
    /// The image's size in pixels, unless the camera brings its own.
    pub size: Option<(u32, u32)>,
    pub camera: CameraSpec,
    /// The camera's keys as in the scene file; empty if the camera is not from a file.
    pub camera_keys: Arc<CameraKeys>,
    /// Caustics of a mirror or lens.
    pub caustics: Option<Arc<Caustics>>,
    /// When the camera's pixels are exposed.
    pub exposure: Exposure,
    /// Where the mesh is at the times of a frame, if it moves; [`Scene::mesh`] is at the frame's own time, 0.
    pub steps: Option<Arc<TimeSteps>>,
    /// What casts shadows and hides light, if that is not [`Scene::mesh`]: the same triangles with those that a camera does not see.
    pub casters: Option<Arc<SceneMesh>>,
    /// The camera at the times of a frame, if it moves.
    pub camera_steps: Vec<(f64, CameraSpec)>,
    pub output: file::OutputSpec,
    /// The limits that the scene was loaded within. They also hold for everything that is made of it later.
    pub limits: Limits,
}

impl Scene {
    /// Loads a scene file with every mesh that it names; `overrides` are `key=value` pairs; keyframed values
    /// are evaluated at `frame`. See [`file::load`].
    pub fn load(path: &Path, overrides: &[String], frame: f64, loading: &Loading) -> Result<Scene> {
        Scene::from_file(file::load(path, overrides, frame, loading)?, loading)
    }

    /// Without triangles and lights; its camera is of no use.
    pub fn empty() -> Scene {
        Scene {
            mesh: Arc::default(),
            objects: Vec::new(),
            lights: Vec::new(),
            projector_lights: Vec::new(),
            style: Style::default(),
            ambient_occlusion: None,
            sky: None,
            volume: None,
            background: [0.0; 3],
            tone: Tone::default(),
            depth_range: None,
            size: None,
            camera: CameraSpec {
                kind: CameraKind::new(
                    "pinhole",
                    Pinhole { eye: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y, vfov: 40.0 },
                ),
                t_range: [0.0, f64::INFINITY],
            },
            camera_keys: Arc::default(),
            caustics: None,
            exposure: Exposure::default(),
            steps: None,
            casters: None,
            camera_steps: Vec::new(),
            output: file::OutputSpec::default(),
            limits: Limits::default(),
        }
    }

    pub fn from_file(file: SceneFile, loading: &Loading) -> Result<Scene> {
        Library::for_once().scene(file, ImagesRead::All, loading)
    }

    /// The scene's camera for an image of its size, within its limits.
    #[cfg(any(test, feature = "cli", feature = "internals"))]
    pub fn camera(&self) -> Result<Camera> {
        self.camera_of_size(self.size, &Loading::new(self.limits))
    }

    /// The scene's camera for an image of `size`.
    pub fn camera_of_size(&self, size: Option<(u32, u32)>, loading: &Loading) -> Result<Camera> {
        let compiled = |spec: &CameraSpec| Camera::in_scene(spec, size, self.surroundings(), loading);
        if self.camera_steps.is_empty() {
            return compiled(&self.camera);
        }
        let times = self.camera_steps.iter().map(|(time, _)| *time).collect();
        let cameras = self.camera_steps.iter().map(|(_, spec)| compiled(spec)).collect::<Result<_>>()?;
        Moving::new(self.exposure.clone(), times, cameras)?.camera(None)
    }

    /// All channels of the scene and a camera, except `certified`, which is requested by name.
    pub fn channels(&self, camera: &Camera) -> Vec<Channel> {
        let is_available = |c: &Channel| match c {
            Channel::Certified => false,
            Channel::TextureU | Channel::TextureV => !self.mesh.base().corner_uvs.is_empty(),
            Channel::DepthLinear | Channel::DepthPerspective => self.depth_range.is_some(),
            _ => true,
        };
        camera.channels().into_iter().chain(Channel::MORE.into_iter().filter(is_available)).collect()
    }

    /// The scene with the facets of the camera's optics as its last triangles; the scene itself if there are none.
    pub fn with_optics(&self, camera: &Camera) -> Cow<'_, Scene> {
        let Some(Surface::Facets { facets, .. }) = camera.optics.as_ref().map(|o| &o.surface) else {
            return Cow::Borrowed(self);
        };
        let base = camera.optics.as_ref().map_or([0.0; 3], |o| o.base);
        let mut scene = self.clone();
        let all: &mut SceneMesh = Arc::make_mut(&mut scene.mesh);
        place::append(all, facets.mesh(base));
        Cow::Owned(scene)
    }

    /// Whether any light or ambient occlusion needs shadow rays.
    pub fn has_shadows(&self) -> bool {
        self.ambient_occlusion.is_some() || self.lights.iter().any(|l| l.casts_shadows) || self.hides_pictures()
    }

    /// Whether surfaces hide those behind them from pictures that are thrown onto them.
    pub fn hides_pictures(&self) -> bool {
        self.projector_lights.iter().any(|p| p.throw.occlusion)
    }

    /// Whether nothing but a headlight lights it.
    pub fn has_headlight(&self) -> bool {
        self.lights.is_empty() && self.sky.is_none() && !self.projector_lights.iter().any(|p| p.is_light())
    }

    /// # Errors
    /// [`Error::Input`] for channels of normalised depth if the scene says no near and far.
    pub fn check_depth(&self, channels: &[Channel]) -> Result<()> {
        match channels.iter().find(|c| c.is_of_z()).filter(|_| self.depth_range.is_none()) {
            Some(channel) => {
                let name = channel.name();
                Err(Error::input(format!("{name} needs near and far; add depth_range = [near, far] to [image]")))
            }
            None => Ok(()),
        }
    }

    /// # Errors
    /// [`Error::Input`] for a volume together with a mirror or lens.
    pub fn check_volume(&self, camera: &Camera) -> Result<()> {
        if self.volume.is_some() && camera.optics.is_some() {
            return Err(Error::input(VOLUME_AND_OPTICS.join("; ").replace("{camera}", camera.kind)));
        }
        Ok(())
    }

    /// Least and greatest corner of the bounding box of all vertices and spheres at all times of the frame, world units; `None` without vertices.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        match &self.steps {
            Some(steps) => steps.bounds(&self.mesh),
            None => self.mesh.bounds(),
        }
    }

    /// What its cameras look at.
    pub fn surroundings(&self) -> Surroundings<'_> {
        let of_steps = self.steps.as_ref().and_then(|_| self.bounds());
        let beside = of_steps.into_iter().chain(self.volume.as_ref().map(|v| v.grid.bounds())).reduce(joined);
        let is_endless = self.sky.as_ref().is_some_and(|sky| sky.is_seen);
        Surroundings { triangles: Triangles::OfScene(&self.mesh), beside, is_endless }
    }

    /// The mesh with its time steps.
    pub fn moving_mesh(&self) -> MovingMesh<'_> {
        MovingMesh { mesh: &self.mesh, steps: self.steps.as_deref() }
    }

    /// Time steps of each vertex; 1 if nothing moves during a frame.
    pub fn step_count(&self) -> u32 {
        self.steps.as_ref().map_or(1, |steps| steps.count())
    }

    /// When a pixel of the camera sees the mesh. If that stands still, any moment is the same.
    pub fn moment(&self, camera: &Camera, pixel: (u32, u32)) -> Moment {
        let size = (camera.width, camera.height);
        let time = || self.exposure.time(camera.image_pixel(pixel), size, camera.sample);
        self.steps.as_ref().map_or(Moment::default(), |steps| steps.moment(time()))
    }

    /// The same for all pixels, row by row; `None` if the mesh stands still.
    pub fn moments(&self, camera: &Camera) -> Option<Vec<Moment>> {
        let (w, h) = (camera.width, camera.height);
        self.steps.as_ref().map(|_| {
            let pixel = |k: u64| ((k % u64::from(w)) as u32, (k / u64::from(w)) as u32);
            parallel::map(0..u64::from(w) * u64::from(h), |k| self.moment(camera, pixel(k)))
        })
    }

    /// The corners of a triangle at a moment, in the order of its file.
    pub fn corners_at(&self, id: u32, moment: Moment) -> [DVec3; 3] {
        match &self.steps {
            Some(steps) => self.mesh.triangles[id as usize].map_each(|v| steps.position_at(&self.mesh, v, moment)),
            None => self.mesh.corners(id),
        }
    }

    /// A triangle, sphere or capsule as it is at a moment.
    pub fn primitive_at(&self, id: u32, moment: Moment) -> Primitive {
        Primitive::new(self.corners_at(id, moment), self.mesh.base().radius(self.mesh.base_id(id)))
    }
}

/// Why there is no volume with a mirror or lens, and what to do instead; `{camera}` stands for the camera's kind.
pub const VOLUME_AND_OPTICS: [&str; 2] = [
    "{camera} reflects or refracts rays, which are not followed through a volume",
    "remove [volume] or use another camera",
];
