//! One render from a scene file to files.

use super::Renderer;
use crate::input::{Error, Limits, Result};
use crate::jobs::batch::Shard;
use crate::jobs::{Backend, RenderJob, Work, options};
use crate::scene::library::Library;
use std::path::PathBuf;
use std::time::Instant;

/// One render from a scene file to files, as `anamorph render` does it, large images strip by strip.
///
/// ```no_run
/// use anamorph::{Job, Renderer};
///
/// # fn main() -> anamorph::Result<()> {
/// let line = Job::new("fisheye.toml")
///     .size(8000, 6000)
///     .set("camera.fov=200")
///     .samples(16)
///     .channels("R,G,B,Z,crypto.object")?
///     .exr("fisheye.exr")
///     .run(&mut Renderer::new()?)?;
/// println!("{line}");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Job {
    job: RenderJob,
}

impl Job {
    /// A render of a scene file. It needs an output: its own, or one in the scene's `[output]`.
    pub fn new(scene: impl Into<PathBuf>) -> Job {
        Job { job: RenderJob::of(scene) }
    }

    /// Changes a value of the scene, as in `camera.vfov=40`.
    pub fn set(mut self, change: impl Into<String>) -> Job {
        self.job.change.set.push(change.into());
        self
    }

    /// The frame at which keyframed values are evaluated.
    pub fn frame(mut self, frame: f64) -> Job {
        self.job.change.frame = frame;
        self
    }

    /// Image size in pixels; replaces the scene's.
    pub fn size(mut self, width: u32, height: u32) -> Job {
        self.job.change.size = Some((width, height));
        self
    }

    /// Writes colour as an 8-bit sRGB PNG.
    pub fn color(mut self, path: impl Into<PathBuf>) -> Job {
        self.job.color = Some(path.into());
        self
    }

    /// Writes the channels as a 32-bit EXR.
    pub fn exr(mut self, path: impl Into<PathBuf>) -> Job {
        self.job.exr = Some(path.into());
        self
    }

    /// Writes the hit points in f64, as .ply or .npy.
    pub fn points(mut self, path: impl Into<PathBuf>) -> Job {
        self.job.points = Some(path.into());
        self
    }

    /// Writes times and counts as JSON: `docs/reference/commands.md`, Reports.
    pub fn report(mut self, path: impl Into<PathBuf>) -> Job {
        self.job.report = Some(path.into());
        self
    }

    /// Names of channels, as in `R,G,B,Z,crypto.object`; `all` for all of the scene and its camera.
    ///
    /// # Errors
    /// [`Error::Input`] for an unknown name.
    pub fn channels(mut self, names: &str) -> Result<Job> {
        let names = names.split(',').map(options::channels).collect::<std::result::Result<_, _>>();
        self.job.channels = Some(names.map_err(Error::Input)?);
        Ok(self)
    }

    /// Rays per pixel, 1 to 64. Colour, coverage and mattes are averaged; other channels use the pixel centre.
    pub fn samples(mut self, samples: u32) -> Job {
        self.job.samples = samples;
        self
    }

    /// Weights triangles by their visible area in the pixel, not by the number of samples that see them.
    pub fn analytic(mut self) -> Job {
        self.job.analytic = true;
        self
    }

    /// Measures the error against the reference, for the report.
    pub fn check(mut self) -> Job {
        self.job.check = true;
        self
    }

    /// The engine: `compute`, `reference`, or a rival such as `raytrace`.
    ///
    /// # Errors
    /// [`Error::Input`] for an unknown name.
    pub fn engine(mut self, name: &str) -> Result<Job> {
        self.job.engine = Some(options::engine(name).map_err(Error::Input)?);
        Ok(self)
    }

    /// The limits on the scene and the image.
    pub fn limits(mut self, limits: Limits) -> Job {
        self.job.limits = limits;
        self
    }

    /// Reads, renders and writes; returns the summary line.
    ///
    /// # Errors
    /// [`Error::Input`] if the scene or the job is wrong, [`Error::Work`] if memory does not suffice, the device fails or a file cannot be
    /// written.
    pub fn run(&self, renderer: &mut Renderer) -> Result<String> {
        let started = Instant::now();
        options::samples(&self.job.samples.to_string()).map_err(Error::Input)?;
        let work = Work::read(self.job.clone(), &Library::for_once())?;
        work.check_memory()?;
        renderer.recover()?;
        let seen = work.render(&mut renderer.backend(&work.job)?)?;
        let device = Backend::device_of(renderer.engine.as_ref(), &work.job);
        let written = work.write(seen, &device, started, |_| ())?;
        Ok(work.summary(&written))
    }
}

impl Shard {
    /// Part `number` of `count`, from 1.
    ///
    /// # Errors
    /// [`Error::Input`] if there is no such part.
    pub fn new(number: u32, count: u32) -> Result<Shard> {
        options::shard(&format!("{number}/{count}")).map_err(Error::Input)
    }
}
