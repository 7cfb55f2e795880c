//! The options of one render.

#[cfg(feature = "cli")]
use super::options::{self, REPEAT_MAX, SAMPLES_MAX};
use super::options::{Gradients, Named};
use crate::camera::Camera;
use crate::engine::rival::{Choice, EngineName};
use crate::engine::{Method, RunOptions};
use crate::geometry::texture::ImagesRead;
use crate::input::{Error, Limits, Loading, Result};
use crate::scene::Scene;
use crate::scene::file::{self, OutputSpec};
use crate::scene::gradients::{Asked, Of, Quantity};
use crate::scene::library::Library;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What a command may ask of a scene beyond its file.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Change {
    /// Size of the image in pixels
    #[cfg_attr(feature = "cli", arg(long, value_name = "WxH", allow_hyphen_values = true, value_parser = options::size))]
    pub size: Option<(u32, u32)>,
    /// Change a value of the scene, as in camera.vfov=40; may be given more than once
    #[cfg_attr(feature = "cli", arg(long, value_name = "KEY=VALUE"))]
    pub set: Vec<String>,
    /// Frame at which keyframed values are evaluated
    #[cfg_attr(feature = "cli", arg(long, value_name = "F", allow_hyphen_values = true, default_value_t = 0.0))]
    #[cfg_attr(feature = "cli", arg(value_parser = options::frame))]
    pub frame: f64,
}

/// One render, as the flags of `anamorph render` say it: a scene file, changes to it, what to compute and what to write.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct RenderJob {
    /// Scene file, .toml or .json
    pub scene: PathBuf,
    /// Colour, 8-bit sRGB
    #[cfg_attr(feature = "cli", arg(id = "output", short = 'o', long = "output", value_name = "OUT.png"))]
    pub color: Option<PathBuf>,
    /// The channels of --channels, 32-bit
    #[cfg_attr(feature = "cli", arg(long, value_name = "OUT.exr"))]
    pub exr: Option<PathBuf>,
    /// Hit points in f64: a PLY with the hits and their triangles, or an N x 3 .npy, a row per pixel, NaN where nothing is hit
    #[cfg_attr(feature = "cli", arg(long, value_name = "OUT.ply|OUT.npy"))]
    pub points: Option<PathBuf>,
    /// Gradients to compute and write, of the triangle and the ray of each pixel: depth, t, position, barycentrics, coverage
    #[cfg_attr(feature = "cli", arg(long, value_name = "LIST", value_delimiter = ',', value_parser = Quantity::named))]
    #[cfg_attr(feature = "cli", arg(requires = "gradients_to"))]
    pub gradients: Option<Vec<Quantity>>,
    /// What the gradients are by: vertices (of the triangle), or numbers of the camera, as in vertices,camera.vfov,camera.eye.0
    #[cfg_attr(feature = "cli", arg(long, value_name = "LIST", value_delimiter = ',', value_parser = Of::named))]
    #[cfg_attr(feature = "cli", arg(requires = "gradients", default_value = "vertices"))]
    pub gradients_of: Vec<Of>,
    /// Write the gradients to this folder: gradient.NAME.npy, and gradient.json, which lists them
    #[cfg_attr(feature = "cli", arg(long, value_name = "FOLDER", requires = "gradients"))]
    pub gradients_to: Option<PathBuf>,
    #[cfg_attr(feature = "cli", command(flatten))]
    pub change: Change,
    /// What renders: compute (GPU), reference (CPU, f64), or a rival to measure against, as in raytrace (GPU)
    #[cfg_attr(feature = "cli", arg(long, value_name = "NAME", value_parser = options::engine))]
    pub engine: Option<EngineName>,
    /// Rays per pixel, averaged in colour and coverage; other channels stay those of the pixel's centre
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", allow_hyphen_values = true, default_value_t = 1))]
    #[cfg_attr(feature = "cli", arg(value_parser = clap::value_parser!(u32).range(1..=i64::from(SAMPLES_MAX))))]
    pub samples: u32,
    /// With --samples N: weight each triangle by its visible area in the pixel, not by the number of samples that see it
    #[cfg_attr(feature = "cli", arg(long))]
    pub analytic: bool,
    /// Channels to compute and write, as in R,G,B,Z; all: every channel of the scene and its camera except certified, mattes and
    /// motion, which can be added, as in all,motion [default with --exr: colour, alpha, depths, ids and
    /// barycentrics]
    #[cfg_attr(feature = "cli", arg(long, value_name = "LIST", value_delimiter = ',', value_parser = options::channels))]
    pub channels: Option<Vec<Named>>,
    /// Refuse a scene whose mesh files refer to images, normals or texture coordinates that do not exist
    #[cfg_attr(feature = "cli", arg(long))]
    pub strict: bool,
    /// Allow the scene's own [output] to name files outside of its folder
    #[cfg_attr(feature = "cli", arg(long))]
    pub outputs_anywhere: bool,
    /// Times and counts as JSON
    #[cfg_attr(feature = "cli", arg(long, value_name = "R.json"))]
    pub report: Option<PathBuf>,
    /// Measure the error against the f64 reference
    #[cfg_attr(feature = "cli", arg(long))]
    pub check: bool,
    /// Time N frames after a warm-up frame
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", allow_hyphen_values = true))]
    #[cfg_attr(feature = "cli", arg(value_parser = clap::value_parser!(u32).range(1..=i64::from(REPEAT_MAX))))]
    pub repeat: Option<u32>,
    /// Move every vertex before each timed frame
    #[cfg_attr(feature = "cli", arg(long, requires = "repeat"))]
    pub moving: bool,
    /// Disable culling: test every triangle in every part of the image
    #[cfg_attr(feature = "cli", arg(long))]
    pub no_cull: bool,
    /// How the triangle of each pixel is found: by raster, by trace (rays through a hierarchy of boxes), or auto, by what costs less; the
    /// picture is the same
    #[cfg_attr(feature = "cli", arg(long, value_name = "NAME", default_value = "auto", value_parser = options::method))]
    pub method: Method,
    /// The limits on the scene that it loads and on the memory of its image.
    #[cfg_attr(feature = "cli", arg(skip))]
    pub limits: Limits,
}

impl RenderJob {
    /// How a single frame of it is rendered.
    pub(crate) fn run_options(&self) -> RunOptions {
        RunOptions { no_cull: self.no_cull, method: self.method, ..RunOptions::default() }
    }

    /// A render of a scene without outputs.
    pub fn of(scene: impl Into<PathBuf>) -> RenderJob {
        RenderJob { scene: scene.into(), samples: 1, ..RenderJob::default() }
    }

    /// The gradients to compute, and where their files go.
    pub fn gradients(&self) -> Option<Gradients> {
        let (quantities, folder) = self.gradients.clone().zip(self.gradients_to.clone())?;
        // the parser lets no empty list pass
        let asked = Asked::new(quantities, self.gradients_of.clone()).ok()?;
        Some(Gradients { asked, folder })
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
