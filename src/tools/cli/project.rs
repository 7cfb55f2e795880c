//! `anamorph project`: every image of 3-D points, a JSON line a point.
//!
//! Places are always computed in f64 on the CPU, so the lines are the same with or without a GPU. The GPU finds the parts of
//! the image to search, one chunk ahead.

use super::args::ProjectArgs;
use super::progress::Progress;
use super::say::{note, print};
use crate::camera::project::{Images, Projector};
use crate::engine::stage::sift::Sift;
use crate::gpu::Gpu;
use crate::gpu::device::{GpuOptions, NO_ADAPTER, adapters};
use crate::image::{read_points, write_text};
use crate::input::files::noted;
use crate::input::{Error, Result};
use crate::jobs::outputs;
use crate::jobs::{EngineName, load_shape};
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

/// Points per chunk: projected in parallel before their lines are printed.
const CHUNK: usize = 1 << 14;

/// Least number of points for which a hardware GPU is used by default.
const MANY: usize = 1 << 16;

/// One line.
#[derive(Serialize)]
struct Line {
    point: [f64; 3],
    #[serde(flatten)]
    images: Images,
}

pub fn run(args: &ProjectArgs) -> Result<()> {
    if let (Some(EngineName::Reference), Some(_)) = (args.engine, &args.adapter) {
        return Err(Error::input("--adapter needs --engine compute; --engine reference runs on the CPU"));
    }
    let progress = Progress::start("building the camera");
    let read = || Ok::<_, Error>((read_points(&args.points)?, load_shape(&args.scene, &(&args.change).into())?));
    let (read, inputs) = noted(read);
    let (points, (_, camera)) = read?;
    drop(progress);
    if camera.optics.is_some() {
        let kind = camera.kind;
        return Err(Error::input(format!(
            "camera: {kind} reflects or refracts rays; points cannot be projected through it; use another kind"
        )));
    }
    outputs::check(&inputs, args.output.iter().map(|path| (path.as_path(), outputs::IMAGES)))?;
    let gpu = open(args, points.len())?;
    let projector = Projector::new(&camera);
    let mut whole = String::new();
    let mut put = |lines: String| match &args.output {
        Some(_) => {
            whole.push_str(&lines);
            Ok(())
        }
        None => print(&lines),
    };
    match &gpu {
        Some(gpu) => sifted(Sift::new(gpu, &projector)?, &projector, &points, put)?,
        None => {
            for chunk in points.chunks(CHUNK) {
                put(lines(chunk, |_, point| projector.project(point))?)?;
            }
        }
    }
    args.output.as_ref().map_or(Ok(()), |file| write_text(file, &whole))
}

/// The adapter to use, if any: the one asked for; unasked for many points one that is no software.
fn open(args: &ProjectArgs, points: usize) -> Result<Option<Gpu>> {
    let asked = args.adapter.is_some() || matches!(args.engine, Some(EngineName::Compute));
    let hardware = || adapters().first().is_some_and(|a| a.get_info().device_type != wgpu::DeviceType::Cpu);
    if matches!(args.engine, Some(EngineName::Reference)) || (!asked && (points < MANY || !hardware())) {
        return Ok(None);
    }
    let gpu = Gpu::open(&GpuOptions { adapter: args.adapter.clone(), ..Default::default() })?;
    if gpu.is_none() {
        note(format_args!("{NO_ADAPTER}; projecting on the CPU as --engine reference does"));
    }
    Ok(gpu)
}

/// All lines, the GPU a chunk ahead.
fn sifted(
    mut sift: Sift,
    projector: &Projector,
    points: &[DVec3],
    mut put: impl FnMut(String) -> Result<()>,
) -> Result<()> {
    let mut chunks = points.chunks(CHUNK.min(sift.points_most().max(1)));
    let mut ahead = chunks.next().map(|c| Ok::<_, Error>((c, sift.start(c)?))).transpose()?;
    while let Some((chunk, started)) = ahead {
        let found = sift.finish(started)?;
        ahead = chunks.next().map(|c| Ok::<_, Error>((c, sift.start(c)?))).transpose()?;
        put(lines(chunk, |k, point| projector.project_below(point, |layer| found.nodes(layer, k)))?)?;
    }
    Ok(())
}

/// A line for each point, by its number in the chunk.
fn lines(chunk: &[DVec3], images: impl Fn(usize, DVec3) -> Images + Sync) -> Result<String> {
    let line = |(k, point): (usize, &DVec3)| line(*point, images(k, *point));
    Ok(chunk.par_iter().enumerate().map(line).collect::<Result<Vec<String>>>()?.concat())
}

fn line(point: DVec3, images: Images) -> Result<String> {
    let line = Line { point: point.to_array(), images };
    let text = serde_json::to_string(&line).map_err(|e| Error::work(format!("images as JSON: {e}")))?;
    Ok(text + "\n")
}
