//! `anamorph render`: read, render, write, each a step of its own; then the summary.

mod backend;
mod files;
mod judged;
mod points;
mod samples;
mod strips;
mod work;

use super::args::{Change, EngineName, RenderArgs};
use super::progress::Progress;
use super::say::{note, print};
use crate::camera::Camera;
use crate::engine::Engine;
use crate::geometry::mesh::Missing;
use crate::geometry::texture::ImagesRead;
use crate::gpu::device::GpuOptions;
use crate::input::{Error, Result};
use crate::reference;
use crate::scene::file::OutputSpec;
use crate::scene::library::Library;
use crate::scene::{Scene, file};
pub use backend::Backend;
pub use files::CAMERA;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
pub use work::{Seen, Work, Written};

pub fn run(args: &RenderArgs, started: Instant) -> Result<()> {
    let progress = Progress::start("reading the scene");
    if let Some((x, y)) = args.pixel {
        check_combination(args)?;
        let (scene, camera) = load_shape(&args.scene, &args.change)?;
        if args.strict {
            refuse_missing(&scene)?;
        }
        return explain_pixel(&scene, &camera, x, y);
    }
    let work = Work::read(args.clone(), &Library::for_once())?;
    work.check_memory()?;
    progress.now("opening the adapter");
    let is_reference = matches!(args.engine, Some(EngineName::Reference));
    let options = GpuOptions {
        adapter: args.adapter.clone(),
        no_int64: args.no_int64,
        no_f64: args.no_f64,
        dump_kernels: args.dump_kernels.clone(),
        ..Default::default()
    };
    let mut engine = if is_reference { None } else { Engine::open(&options)? };
    let mut backend = Backend::of(engine.as_mut(), args)?;
    if matches!(backend, Backend::Reference) && !is_reference {
        Backend::say_reference();
    }
    progress.now("rendering");
    let seen = work.render(&mut backend)?;
    let device = Backend::device_of(engine.as_ref(), args);
    let written = work.write(seen, &device, started, |doing| progress.now(doing))?;
    drop(progress);
    if let Some(line) = missing_line(work.missing()) {
        note(line);
    }
    print(&format!("{}\n", work.summary(&written)))
}

/// A line that says what mesh files lack; `None` if they lack nothing.
pub(super) fn missing_line(missing: &[Missing]) -> Option<String> {
    let first = missing.first()?;
    let more = match missing.len() {
        1 => String::new(),
        n => format!(", and {} more, listed by --report", n - 1),
    };
    Some(format!("left out: {} ({}){more}; --strict makes this an error", first.what, first.why))
}

/// `--strict`: an error if mesh files lack something.
fn refuse_missing(scene: &Scene) -> Result<()> {
    match &scene.mesh.missing[..] {
        [] => Ok(()),
        [first, rest @ ..] => {
            let more = if rest.is_empty() { String::new() } else { format!(", and {} more", rest.len()) };
            Err(Error::input(format!("{}: {}{more}; render without --strict to leave this out", first.what, first.why)))
        }
    }
}

/// Flags that make no sense together, beyond what the parser knows.
fn check_combination(args: &RenderArgs) -> Result<()> {
    if !matches!(args.engine, Some(EngineName::Reference)) {
        return Ok(());
    }
    let flags = [
        (args.adapter.is_some(), "--adapter"),
        (args.no_int64, "--no-int64"),
        (args.no_f64, "--no-f64"),
        (args.dump_kernels.is_some(), "--dump-kernels"),
        (args.moving, "--moving"),
        (args.no_cull, "--no-cull"),
    ];
    match flags.iter().find(|f| f.0) {
        Some((_, flag)) => Err(Error::input(format!("{flag} is for --engine compute; the reference runs on the CPU"))),
        None => Ok(()),
    }
}

/// The scene, changed, and its camera for an image of the size asked for, or of the scene's own.
pub(super) fn load(path: &Path, change: &Change) -> Result<(Scene, Arc<Camera>)> {
    load_from(&Library::for_once(), path, change, |_| ImagesRead::All)
}

/// As [`load`], without images that only colour triangles.
pub(super) fn load_shape(path: &Path, change: &Change) -> Result<(Scene, Arc<Camera>)> {
    load_from(&Library::for_once(), path, change, |_| ImagesRead::Masks)
}

/// As [`load`], with the meshes and cameras that `library` keeps. `images` says which images are needed, given the scene's own outputs.
pub(super) fn load_from(
    library: &Library,
    path: &Path,
    change: &Change,
    images: impl FnOnce(&OutputSpec) -> ImagesRead,
) -> Result<(Scene, Arc<Camera>)> {
    let file = file::load(path, &change.set, change.frame)?;
    let at = |e: Error| e.at(path.display());
    let read = images(&file.output);
    let scene = library.scene(file, read).map_err(at)?;
    let camera = library.camera(&scene, change.size).map_err(at)?;
    Ok((scene, camera))
}

fn explain_pixel(scene: &Scene, camera: &Camera, x: u32, y: u32) -> Result<()> {
    let (width, height) = (camera.width, camera.height);
    if x >= width || y >= height {
        let last = format!("columns go from 0 to {} and rows from 0 to {}", width - 1, height - 1);
        return Err(Error::input(format!("--pixel {x},{y} is outside the image of {width}x{height}; {last}")));
    }
    let text = reference::image::explain(scene, camera, x, y);
    print(&format!("{}\n", text.trim_end()))
}
