//! `anamorph project`: every image of 3-D points, a JSON line a point.
//!
//! Places are always computed in f64 on the CPU, so the lines are the same with or without a GPU. The GPU proves, one chunk ahead, which parts
//! of the image do not show a point; the host searches the others.

use super::args::{DeviceArgs, ProjectArgs};
use super::progress::Progress;
use super::say::{note, print};
use crate::camera::Camera;
use crate::camera::project::{Images, Projector};
use crate::engine::stage::solve::Solve;
use crate::gpu::Gpu;
use crate::gpu::device::{GpuOptions, NO_ADAPTER, adapters};
use crate::image::{read_points, write_text};
use crate::input::{Error, Loading, Result};
use crate::jobs::outputs;
use crate::jobs::project::each_solved;
use crate::jobs::{EngineName, load_shape};
use crate::parallel;
use glam::DVec3;
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
    args.device.check()?;
    let progress = Progress::start("building the camera");
    let loading = Loading::new(args.caps.limits());
    let points = read_points(&args.points, &loading)?;
    let (_, camera) = load_shape(&args.scene, &args.change, &loading)?;
    drop(progress);
    refuse_optics(&camera)?;
    outputs::check(&loading.into_inputs(), args.output.iter().map(|path| (path.as_path(), outputs::IMAGES)))?;
    let gpu = args.device.open(points.len())?;
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
        Some(gpu) => each_solved(&mut Solve::new(gpu, &projector)?, &points, CHUNK, |_, chunk, solved| {
            put(lines(chunk, |k, point| projector.project_below(point, |layer| solved.nodes(layer, k)))?)
        })?,
        None => {
            for chunk in points.chunks(CHUNK) {
                put(lines(chunk, |_, point| projector.project(point))?)?;
            }
        }
    }
    args.output.as_ref().map_or(Ok(()), |file| write_text(file, &whole))
}

/// Refuses a camera behind whose image rays are bent.
pub(super) fn refuse_optics(camera: &Camera) -> Result<()> {
    if camera.optics.is_none() {
        return Ok(());
    }
    let kind = camera.kind;
    Err(Error::input(format!(
        "camera: {kind} reflects or refracts rays; points cannot be projected through it; use another kind"
    )))
}

impl DeviceArgs {
    /// Refuses an adapter for the reference.
    pub(super) fn check(&self) -> Result<()> {
        match (self.engine, &self.adapter) {
            (Some(EngineName::Reference), Some(_)) => {
                Err(Error::input("--adapter needs --engine compute; --engine reference runs on the CPU"))
            }
            _ => Ok(()),
        }
    }

    /// The adapter to use, if any: the one asked for; unasked for many points one that is no software.
    pub(super) fn open(&self, points: usize) -> Result<Option<Gpu>> {
        let asked = self.adapter.is_some() || matches!(self.engine, Some(EngineName::Compute));
        let hardware = || adapters().first().is_some_and(|a| a.get_info().device_type != wgpu::DeviceType::Cpu);
        if matches!(self.engine, Some(EngineName::Reference)) || (!asked && (points < MANY || !hardware())) {
            return Ok(None);
        }
        let gpu = Gpu::open(&GpuOptions { adapter: self.adapter.clone(), ..Default::default() })?;
        if gpu.is_none() {
            note(format_args!("{NO_ADAPTER}; projecting on the CPU as --engine reference does"));
        }
        Ok(gpu)
    }
}

/// A line for each point, by its number in the chunk.
fn lines(chunk: &[DVec3], images: impl Fn(usize, DVec3) -> Images + Sync) -> Result<String> {
    let line = |k: usize| {
        let line = Line { point: chunk[k].to_array(), images: images(k, chunk[k]) };
        let text = serde_json::to_string(&line).map_err(|e| Error::work(format!("images as JSON: {e}")))?;
        Ok(text + "\n")
    };
    Ok(parallel::try_map(0..chunk.len(), line)?.concat())
}
