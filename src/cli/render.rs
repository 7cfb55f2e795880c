//! `anamorph render`: scene, camera, outputs, engine, frame, files, summary, in this order.

mod backend;
mod files;
mod judged;
mod points;
mod samples;

use super::args::{Change, EngineName, Named, RenderArgs};
use super::progress::Progress;
use super::{memory, print};
use crate::camera::{Camera, Rays};
use crate::engine::RunOptions;
use crate::error::{Error, Result};
use crate::frame::Channel;
use crate::motion;
use crate::output::cryptomatte::{Apart, Matte};
use crate::plan::Wanted;
use crate::plan::samples::at_once;
use crate::reference;
use crate::report::{FrameMs, Report};
use crate::scene::{Scene, file};
use backend::Backend;
use files::Files;
use std::path::Path;
use std::time::Instant;

pub fn run(args: &RenderArgs, started: Instant) -> Result<()> {
    check_combination(args)?;
    let progress = Progress::start("reading the scene");
    let (scene, camera) = load(&args.scene, &args.change)?;
    if let Some((x, y)) = args.pixel {
        return explain_pixel(&scene, &camera, x, y);
    }
    if args.moving && scene.caustics.is_some() {
        let what = "the scene has caustics, whose light is followed once for all frames";
        return Err(Error::input(format!("--moving: {what}; use --repeat alone")));
    }
    let files = Files::new(args, &scene)?;
    let asked = asked(args, &files, &camera);
    let mut mattes: Vec<Matte> = apart(args).map(|apart| Matte::new(apart, &scene, &camera)).collect();
    if !mattes.is_empty() && files.exr.is_none() {
        return Err(Error::input("--channels: cryptomattes are layers of an EXR; add --exr OUT.exr"));
    }
    if args.moving && asks_for_motion(args) {
        return Err(Error::input("--moving: motion is to the next frame of the scene file; use --frame alone"));
    }
    let next = if asks_for_motion(args) { Some(next_frame(args, &files)?) } else { None };
    let mut wanted = wanted(&asked, &files, mattes.is_empty() && next.is_none());
    if next.is_some() {
        wanted.channels.extend(motion::NEEDED);
        wanted.channels.sort_unstable();
        wanted.channels.dedup();
    }
    points::check(&files, &camera)?;
    let is_compute = matches!(args.engine, None | Some(EngineName::Compute));
    let samples = if is_compute && at_once(&scene, &camera, args.samples) { args.samples } else { 1 };
    wanted.analytic = args.analytic;
    if args.analytic && samples == 1 {
        let what = if args.samples == 1 { "one sees one triangle; add --samples N" } else { "here each takes a frame" };
        return Err(Error::input(format!("--analytic is of what several samples of a pixel see in a frame; {what}")));
    }
    let more = sample_bytes(&camera, samples, !mattes.is_empty());
    memory::check(camera.width, camera.height, wanted.channels.len() + 3, more)?;

    progress.now("opening the adapter");
    let mut backend = Backend::open(args)?;
    backend.check_size(&camera, &Wanted { samples, ..wanted.clone() })?;

    progress.now("rendering");
    let (repeat, moving, no_cull) = (args.repeat.unwrap_or(0), args.moving, args.no_cull);
    let run = RunOptions { repeat, moving, no_cull, ..Default::default() };
    let mut rendered = samples::render(&mut backend, &scene, &camera, &wanted, args.samples, &run, &mut mattes)?;
    let extra = judged::render(args, &mut backend, &scene, &camera)?;
    if args.check {
        progress.now("checking against the reference");
    }
    let error = match &extra {
        Some(extra) if args.check => Some(judged::judge(&scene, &camera, &rendered, extra, args.samples)?),
        _ => None,
    };

    let mut more = Vec::new();
    if let Some((next_scene, next_camera)) = &next {
        progress.now("finding where all of it is in the next frame");
        let planes = motion::motion((&scene, &camera), (next_scene, next_camera), &rendered.frame)?;
        more.extend(motion::NAMES.map(String::from).into_iter().zip(planes));
    }

    progress.now("writing");
    files.write(&scene, &camera, &rendered, &asked, (mattes, more))?;
    let device = backend.device();
    let frame_ms = FrameMs::of(&rendered.frame_ms);
    if let Some(path) = &files.report {
        if extra.is_some() {
            rendered.left_out.retain(|l| l.what != "fragment counters");
        }
        let counts = extra.filter(|_| device.engine == "compute").map(|e| e.counts);
        let mut report = Report::new(device.clone(), &scene, &camera, &rendered, counts);
        report.samples = args.samples;
        report.error = error.clone();
        report.total_ms = started.elapsed().as_secs_f64() * 1e3;
        files::write_report(path, &report)?;
    }
    drop(progress);
    let check = error.map(|e| format!(" | check: {}, {} not near", e.comparison, e.not_near)).unwrap_or_default();
    let (names, counted) = (files.names(), counted(&scene, &camera));
    let (width, height, ms, adapter) = (camera.width, camera.height, milliseconds(frame_ms.median), device.adapter);
    print(&format!("{names}{width}x{height} | {counted} | frame {ms} | {adapter}{check}\n"))
}

/// Bytes a pixel that several samples of it take: by what their rays differ, here and on the device, and the ids that mattes count, in
/// a read-back row and by themselves. The rows of pixels that hold an edge are few.
fn sample_bytes(camera: &Camera, samples: u32, has_mattes: bool) -> u64 {
    let is_field = camera.layers.iter().any(|l| matches!(l, Rays::Field(_)));
    let each = if is_field { 2 * 24 } else { 0 } + if has_mattes { 8 + 4 } else { 0 };
    if samples > 1 { each * u64::from(samples) } else { 0 }
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
        (args.moving, "--moving"),
        (args.no_cull, "--no-cull"),
    ];
    match flags.iter().find(|f| f.0) {
        Some((_, flag)) => Err(Error::input(format!("{flag} is for --engine compute; the reference runs on the CPU"))),
        None => Ok(()),
    }
}

/// The scene, changed, and its camera for an image of the size asked for, or of the scene's own.
pub(super) fn load(path: &Path, change: &Change) -> Result<(Scene, Camera)> {
    let file = file::load(path, &change.set, change.frame)?;
    let at = |e: Error| e.at(path.display());
    let scene = Scene::from_file(file).map_err(at)?;
    let camera = Camera::in_scene(&scene.camera, change.size.or(scene.size), &scene.mesh).map_err(at)?;
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

/// The channels that are written.
fn asked(args: &RenderArgs, files: &Files, camera: &Camera) -> Vec<Channel> {
    match &args.channels {
        Some(list) => list.iter().flat_map(Named::channels).copied().collect(),
        None if files.exr.is_some() => Channel::of(camera),
        None => Vec::new(),
    }
}

fn asks_for_motion(args: &RenderArgs) -> bool {
    args.channels.iter().flatten().any(|named| matches!(named, Named::Motion))
}

/// The scene and its camera one frame later.
fn next_frame(args: &RenderArgs, files: &Files) -> Result<(Scene, Camera)> {
    if files.exr.is_none() {
        return Err(Error::input("--channels: motion is two channels of an EXR; add --exr OUT.exr"));
    }
    load(&args.scene, &Change { frame: args.change.frame + 1.0, ..args.change.clone() })
}

/// What cryptomattes tell apart.
fn apart(args: &RenderArgs) -> impl Iterator<Item = Apart> {
    [Apart::Objects, Apart::Materials].into_iter().filter(|own| {
        let is_own = |named: &Named| matches!(named, Named::Matte(apart) if apart == own);
        args.channels.iter().flatten().any(is_own)
    })
}

/// What the outputs need: the picture unless only channels or mattes are asked for; points come from triangles.
fn wanted(asked: &[Channel], files: &Files, has_no_matte: bool) -> Wanted {
    let ids = files.points.is_some().then_some(Channel::TriangleId);
    let mut channels: Vec<Channel> = asked.iter().copied().chain(ids).collect();
    channels.sort_unstable();
    channels.dedup();
    let srgb8 = files.color.is_some() || (channels.is_empty() && has_no_matte);
    Wanted { srgb8, ..Wanted::of(channels) }
}

fn counted(scene: &Scene, camera: &Camera) -> String {
    let of = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    let triangles = of(scene.mesh.triangles.len(), "triangle");
    match camera.piece_count() {
        0 if camera.is_curved() => format!("{triangles}, a curve a pixel"),
        0 => format!("{triangles}, a ray a pixel"),
        n => format!("{triangles}, {}", of(n, "piece")),
    }
}

fn milliseconds(ms: f64) -> String {
    if ms < 1000.0 { format!("{ms:.1} ms") } else { format!("{:.2} s", ms / 1e3) }
}
