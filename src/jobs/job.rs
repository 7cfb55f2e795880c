//! The options of one render.

use super::options::{Gradients, Named};
use crate::camera::Camera;
use crate::engine::rival::{Choice, EngineName};
use crate::engine::{Method, RunOptions};
use crate::geometry::texture::ImagesRead;
use crate::input::{Error, Limits, Loading, Result};
use crate::scene::Scene;
use crate::scene::file::{self, OutputSpec};
use crate::scene::library::Library;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Options that change a scene.
#[derive(Debug, Clone, Default)]
pub struct Change {
    /// Width and height of the image in pixels; `None`: the scene's own.
    pub size: Option<(u32, u32)>,
    /// Overrides of scene values, as in `camera.vfov=40`.
    pub set: Vec<String>,
    /// The frame at which keyframed values are evaluated.
    pub frame: f64,
}

/// One render: a scene file, changes to it, what to compute and what to write.
#[derive(Debug, Clone)]
pub struct RenderJob {
    /// The scene file, .toml or .json.
    pub scene: PathBuf,
    pub change: Change,
    /// Colour, as 8-bit sRGB PNG.
    pub color: Option<PathBuf>,
    /// The channels, as 32-bit EXR.
    pub exr: Option<PathBuf>,
    /// The hit points, as PLY or NPY.
    pub points: Option<PathBuf>,
    /// Gradients, as arrays of NumPy.
    pub gradients: Option<Gradients>,
    /// Times and counts, as JSON.
    pub report: Option<PathBuf>,
    /// `None`: compute, or reference on a machine without an adapter.
    pub engine: Option<EngineName>,
    /// Rays per pixel; colour, coverage and mattes are averaged.
    pub samples: u32,
    /// Weight triangles by their visible area in the pixel, not by the number of samples that see them.
    pub analytic: bool,
    /// The channels of the EXR; `None`: those of the camera.
    pub channels: Option<Vec<Named>>,
    /// Refuse a scene whose mesh files refer to missing files or attributes.
    pub strict: bool,
    /// Allow the scene's own `[output]` to name files outside of its folder.
    pub outputs_anywhere: bool,
    /// Measure the error against the reference.
    pub check: bool,
    /// Frames to time after the first.
    pub repeat: Option<u32>,
    /// Every vertex moves before each timed frame.
    pub moving: bool,
    /// Disable culling.
    pub no_cull: bool,
    /// How the triangle of each pixel is found.
    pub method: Method,
    /// The limits on the scene that it loads and on the memory of its image.
    pub limits: Limits,
}

impl RenderJob {
    /// How a single frame of it is rendered.
    pub(crate) fn run_options(&self) -> RunOptions {
        RunOptions { no_cull: self.no_cull, method: self.method, ..RunOptions::default() }
    }

    /// A render of a scene without outputs.
    pub fn of(scene: impl Into<PathBuf>) -> RenderJob {
        RenderJob {
            scene: scene.into(),
            change: Change::default(),
            color: None,
            exr: None,
            points: None,
            gradients: None,
            report: None,
            engine: None,
            samples: 1,
            analytic: false,
            channels: None,
            strict: false,
            outputs_anywhere: false,
            check: false,
            repeat: None,
            moving: false,
            no_cull: false,
            method: Method::default(),
            limits: Limits::default(),
        }
    }

    /// Refuses options of the compute engine for the reference.
    ///
    /// # Errors
    /// [`Error::Input`] that names the flag.
    pub fn check_options(&self) -> Result<()> {
        if self.method != Method::Auto && !matches!(self.engine, None | Some(EngineName::Compute)) {
            return Err(Error::input("--method is of --engine compute; leave either out"));
        }
        if !matches!(self.engine, Some(EngineName::Reference)) {
            return Ok(());
        }
        let flags = [(self.moving, "--moving"), (self.no_cull, "--no-cull")];
        flags.iter().find(|f| f.0).map_or(Ok(()), |(_, flag)| Err(of_compute_only(flag)))
    }

    /// The rival, if one is selected.
    pub fn rival(&self) -> Option<Choice> {
        match self.engine {
            Some(EngineName::Rival(choice)) => Some(choice),
            _ => None,
        }
    }
}

/// The error for an option of the compute engine that the reference is given.
pub fn of_compute_only(flag: &str) -> Error {
    Error::input(format!("{flag} needs a GPU engine; --engine reference runs on the CPU"))
}

/// The scene, changed, and its camera for an image of the size asked for, or of the scene's own.
#[cfg(feature = "cli")]
pub fn load(path: &Path, change: &Change, loading: &Loading) -> Result<(Scene, Arc<Camera>)> {
    load_from(&Library::for_once(), path, change, |_| ImagesRead::All, loading)
}

/// As [`load`], without textures that only affect colour.
#[cfg(feature = "cli")]
pub fn load_shape(path: &Path, change: &Change, loading: &Loading) -> Result<(Scene, Arc<Camera>)> {
    load_from(&Library::for_once(), path, change, |_| ImagesRead::Masks, loading)
}

/// As [`load`], with the meshes and cameras cached in `library`. `images` selects the textures to load, given the scene's own outputs.
pub fn load_from(
    library: &Library,
    path: &Path,
    change: &Change,
    images: impl FnOnce(&OutputSpec) -> ImagesRead,
    loading: &Loading,
) -> Result<(Scene, Arc<Camera>)> {
    let file = file::load(path, &change.set, change.frame, loading)?;
    let at = |e: Error| e.at(path.display());
    let read = images(&file.output);
    let scene = library.scene(file, read, loading).map_err(at)?;
    let camera = library.camera(&scene, change.size, loading).map_err(at)?;
    Ok((scene, camera))
}
