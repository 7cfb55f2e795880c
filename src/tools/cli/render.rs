//! `anamorph render`: read, render, write, each a step of its own; then the summary.

use super::args::RenderArgs;
use super::progress::Progress;
use super::say::{note, print};
use crate::camera::Camera;
use crate::engine::Engine;
use crate::engine::left_out::LeftOut;
use crate::geometry::mesh::Missing;
use crate::gpu::device::{GpuOptions, NO_ADAPTER};
use crate::input::{Error, Loading, Result};
use crate::jobs::job::of_compute_only;
use crate::jobs::{Backend, EngineName, RenderJob, Work, load_shape, refuse_missing};
use crate::reference;
use crate::scene::Scene;
use crate::scene::library::Library;
use std::time::Instant;

pub fn run(args: &RenderArgs, started: Instant) -> Result<()> {
    let progress = Progress::start("reading the scene");
    let job = args.job();
    check_combination(args, &job)?;
    if let Some((x, y)) = args.pixel {
        job.check_options()?;
        let (scene, camera) = load_shape(&job.scene, &job.change, &Loading::new(job.limits))?;
        if job.strict {
            refuse_missing(&scene)?;
        }
        return explain_pixel(&scene, &camera, x, y);
    }
    let is_reference = matches!(job.engine, Some(EngineName::Reference));
    let work = Work::read(job, &Library::for_once())?;
    work.check_memory()?;
    progress.now("opening the adapter");
    let options = GpuOptions {
        adapter: args.adapter.clone(),
        no_int64: args.no_int64,
        no_f64: args.no_f64,
        dump_kernels: args.dump_kernels.clone(),
        ..Default::default()
    };
    let mut engine = if is_reference { None } else { Engine::open(&options)? };
    let mut backend = Backend::of(engine.as_mut(), &work.job)?;
    let has_no_adapter = matches!(backend, Backend::Reference) && !is_reference;
    let doing = if has_no_adapter { "rendering on the CPU, as there is no adapter" } else { "rendering" };
    progress.of(doing, work.share.clone());
    let seen = work.render(&mut backend)?;
    let notes = work.notes(&seen);
    let device = Backend::device_of(engine.as_ref(), &work.job);
    let written = work.write(seen, &device, started, |doing| progress.now(doing))?;
    drop(progress);
    // after all that may fail, since an error stands alone
    if has_no_adapter {
        note(format_args!("{NO_ADAPTER}; rendered on the CPU as --engine reference does"));
    }
    notes.iter().for_each(note);
    written.left_out.iter().filter(|left| **left == LeftOut::Style).for_each(note);
    if let Some(line) = Missing::line(work.missing()) {
        note(line);
    }
    if work.loses_channels() {
        note("no EXR is written, which --channels is for; add --exr OUT.exr");
    }
    print(&format!("{}\n", work.summary(&written)))
}

/// Refuses contradicting flags that the parser accepts.
fn check_combination(args: &RenderArgs, job: &RenderJob) -> Result<()> {
    if !matches!(job.engine, Some(EngineName::Reference)) {
        return Ok(());
    }
    let flags = [
        (args.adapter.is_some(), "--adapter"),
        (args.no_int64, "--no-int64"),
        (args.no_f64, "--no-f64"),
        (args.dump_kernels.is_some(), "--dump-kernels"),
    ];
    flags.iter().find(|f| f.0).map_or(Ok(()), |(_, flag)| Err(of_compute_only(flag)))
}

fn explain_pixel(scene: &Scene, camera: &Camera, x: u32, y: u32) -> Result<()> {
    let (width, height) = (camera.width, camera.height);
    if x >= width || y >= height {
        let last = format!("columns go from 0 to {} and rows from 0 to {}", width - 1, height - 1);
        return Err(Error::input(format!("--pixel {x},{y} is outside the image of {width}x{height}; {last}")));
    }
    let text = reference::image::explain(scene, camera, x, y).text;
    print(&format!("{}\n", text.trim_end()))
}
