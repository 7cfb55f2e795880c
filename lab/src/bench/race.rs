//! Running a case: the arms alternate, A B A B, in reversed order every other round, with an empty kernel as a control; each
//! frame is compared with one reference image.

use super::case::{Arm, Case, Samples};
use super::row::{Certified, Counted, Drawn, Error, Moving, Row};
use super::times::{Ratio, Times};
use super::whole;
use super::yardstick::Yardstick;
use anamorph::internals::camera::Camera;
use anamorph::internals::camera::exposure::Sample;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::plan::samples::sample_offsets;
use anamorph::internals::engine::{Arithmetic, Engine, Frames, Method, Rendered, RunOptions};
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::buffers::wait;
use anamorph::internals::gpu::device::{GpuOptions, NO_ADAPTER};
use anamorph::internals::gpu::recorder::Recorder;
use anamorph::internals::image::compare::compare;
use anamorph::internals::image::frame::{Channel, Frame, NO_ID, Plane};
use anamorph::internals::input::{Loading, Result};
use anamorph::internals::reference::image::{Judgement, judge_rows, rows_of_image};
use anamorph::internals::scene::Scene;
use std::path::PathBuf;
use std::time::Instant;

/// This engine on two devices of an adapter: software adapters misplace the passes of a device in time once it has drawn.
pub struct Engines {
    /// Of compute kernels alone.
    pub computing: Engine,
    /// Of rivals that draw.
    pub drawing: Engine,
}

impl Engines {
    /// # Errors
    /// [`anamorph::internals::input::Error::Work`] if there is no adapter.
    pub fn open(options: &GpuOptions) -> Result<Engines> {
        let engine =
            || Ok(Engine::new(Gpu::open(options)?.ok_or_else(|| anamorph::internals::input::Error::work(NO_ADAPTER))?));
        Ok(Engines { computing: engine()?, drawing: engine()? })
    }

    /// The one that an arm runs on.
    fn of(&mut self, arm: &Arm) -> &mut Engine {
        let draws = arm.choice().ok().flatten().is_some_and(|c| c.technique.draws);
        if draws { &mut self.drawing } else { &mut self.computing }
    }
}

/// How cases are run.
#[derive(Debug, Clone)]
pub struct Rules {
    /// Timed frames of each arm, at least and at most: between them those of an arm end once their interval is close.
    pub runs: [u32; 2],
    /// No round begins later than this after the first, s, once each arm has its least frames.
    pub seconds_max: f64,
    /// A program that runs beside all arms of cases that it can show.
    pub yardstick: Option<PathBuf>,
    /// What this engine does is counted in all cases: they hold for every adapter.
    pub counts: bool,
    /// Triangles that a technique may draw a frame.
    pub draws_max: Option<u64>,
    /// How long a technique's first frame may take, ms, to be repeated, where it is not within twice this engine's. Otherwise it is its time.
    pub first_ms_max: f64,
    /// How long each arm renders before its first timed frame, and before each, ms: a GPU that has nothing to do slows its clock down, and
    /// does not raise it at once.
    pub warm_ms: [f64; 2],
}

impl Rules {
    /// Of a full run, or of a `quick` one. A software adapter draws some hundred thousand triangles a second, an NVIDIA H200 some 36 million:
    /// nothing is drawn for longer than some minutes.
    pub fn new(quick: bool, is_software: bool) -> Rules {
        Rules {
            runs: match (quick, is_software) {
                (true, _) => [3, 3],
                (false, true) => [7, 50],
                (false, false) => [9, 50],
            },
            seconds_max: if is_software { 30.0 } else { 1.5 },
            yardstick: None,
            counts: is_software && !quick,
            draws_max: Some(match (quick, is_software) {
                (true, _) => 500_000,
                (false, true) => 50_000_000,
                (false, false) => 400_000_000,
            }),
            first_ms_max: if quick { 1500.0 } else { 10_000.0 },
            warm_ms: if is_software { [0.0; 2] } else { [200.0, 20.0] },
        }
    }
}

/// Pixels of a frame that are compared with the reference, and samples of its filtered pixels, some minutes' worth: of what has more each
/// second row is, or each third, and so on.
const JUDGED_MAX: u64 = 1 << 19;
const FILTERED_MAX: u64 = 1 << 22;

/// Each how many-th row of a camera's frame is compared, of so many samples a pixel.
fn row_step(camera: &Camera, samples: u32) -> u32 {
    let all = u64::from(camera.width) * u64::from(camera.height) * u64::from(samples);
    all.div_ceil(if samples > 1 { FILTERED_MAX } else { JUDGED_MAX }) as u32
}

/// The running state of an arm.
enum Runner {
    Frames(Box<Frames>),
    /// One frame per sample; their colours are averaged.
    Separate(Vec<Frames>),
    Yardstick(Yardstick),
}

/// The scenes of a case.
struct Scenes<'a> {
    case: &'a Case,
    path: PathBuf,
}

impl Scenes<'_> {
    /// With `more` KEY=VALUE, at a frame.
    fn load(&self, more: &[String], frame: u32) -> Result<Scene> {
        Scene::load(&self.path, &[&self.case.set[..], more].concat(), f64::from(frame), &Loading::default())
    }

    fn with_camera(&self, more: &[String]) -> Result<(Scene, Camera)> {
        let scene = self.load(more, 0)?;
        let camera = scene.camera()?;
        Ok((scene, camera))
    }
}

/// Runs all arms of a case; an arm that cannot render the case becomes a row with the reason.
///
/// # Errors
/// [`anamorph::internals::input::Error`] where the case's scene or the device fails.
pub fn race(engines: &mut Engines, suite: &str, case: &Case, rules: &Rules) -> Result<Vec<Row>> {
    let folder = tempfile::tempdir()
        .map_err(|e| anamorph::internals::input::Error::work(format!("no temporary folder: {e}")))?;
    let all = Scenes { case, path: case.write(folder.path())? };
    let truth = all.with_camera(&case.truth)?;
    let program = rules.yardstick.as_deref();
    let yardstick = program.map(|p| Yardstick::new(p, &truth.0, &truth.1, case.moving)).transpose()?.flatten();
    // what it finds is asked of this engine too
    let bare = yardstick.as_ref().and(case.arms.first()).map(|ours| beside(case, ours));
    let arms: Vec<&Arm> = case.arms.iter().chain(&bare).collect();
    let scenes: Vec<Result<(Scene, Camera)>> = arms.iter().map(|arm| all.with_camera(&arm.set)).collect();
    let moved = arms.iter().zip(&scenes).map(|(arm, scene)| cameras_separately(arm, scene));
    let moved: Vec<Vec<Camera>> = moved.collect::<Result<_>>()?;
    let mut entries: Vec<Entry> = Vec::new();
    for ((&arm, scene), moved) in arms.iter().zip(&scenes).zip(&moved) {
        let mut entry =
            Entry { row: Row::new(suite, case, arm), arm: Some(arm), runner: None, rounds: Vec::new(), once_ms: None };
        let with_culling = |e: &&Entry| arm.no_cull && e.row.technique == entry.row.technique;
        // without culling it takes tens of times as long
        let refused = |e: &Entry| match e.runner.as_ref().map(Runner::first_ms) {
            Some(ms) if ms > rules.first_ms_max / 2.0 => Some(format!("with culling, a frame took {ms:.0} ms")),
            Some(_) => None,
            None => e.row.refused.as_ref().map(|why| format!("with culling, {why}")),
        };
        match (entries.iter().find(with_culling).and_then(refused), scene) {
            (Some(refused), _) => entry.row.refused = Some(refused),
            (None, Ok((scene, camera))) => {
                let ours = entries.iter().find(|e| e.row.is_ours()).and_then(|e| e.runner.as_ref());
                let first_ms_max = rules.first_ms_max.max(2.0 * ours.map_or(0.0, Runner::first_ms));
                entry.prepare(
                    engines.of(arm),
                    scene,
                    (camera, moved),
                    &wanted(case, arm),
                    &options(case, arm, rules),
                    first_ms_max,
                );
            }
            (None, Err(e)) => entry.row.refused = Some(e.to_string()),
        }
        entries.push(entry);
    }
    if let Some((program, yardstick)) = program.zip(yardstick) {
        let mut row = Row::of_yardstick(suite, case, bare.as_ref(), program);
        row.describe(&truth.0, &truth.1);
        entries.push(Entry {
            row,
            arm: None,
            runner: Some(Runner::Yardstick(yardstick)),
            rounds: Vec::new(),
            once_ms: None,
        });
    }
    // the arm for the program stands behind those of the case, and the program behind it
    let bare_at = bare.as_ref().map(|_| case.arms.len());
    let baselines: Vec<usize> = entries.iter().position(|e| e.row.is_ours()).into_iter().chain(bare_at).collect();
    let control_ms = time(&engines.computing, &all, &mut entries, &baselines, rules)?;
    let rounds: Vec<Vec<Option<f64>>> = entries.iter().map(Entry::rounds).collect();

    let mut judge = Judge { scene: &truth.0, camera: &truth.1, judgement: None, each: case.stiffness.is_some() };
    let filtered = case.filtered.map(|samples| Filtered::new(&truth.0, &truth.1, samples)).transpose()?;
    let mut rows = Vec::new();
    for (at, mut entry) in entries.into_iter().enumerate() {
        entry.row.control_ms = control_ms;
        let scene = scenes.get(at).and_then(|s| s.as_ref().ok());
        let repeats = entry.once_ms.is_none();
        if let Some(frame) = entry.finish(scene.map(|s| &s.1)) {
            entry.row.error = Some(match &filtered {
                Some(truth) if has_colors(&frame) => truth.error(&frame)?,
                // t and ids have no mean over a pixel
                _ => judge.error(&frame)?,
            });
            if let (Some((scene, camera)), Some(arm), true) = (scene, entry.arm, repeats) {
                let draws = arm.choice()?.is_some_and(|c| c.technique.draws);
                let options = options(case, arm, rules)?;
                let separate: Vec<&Camera> = moved.get(at).into_iter().flatten().collect();
                let cameras = if separate.is_empty() { vec![camera] } else { separate };
                // what has no memory for a second copy of its buffers has no time of a call
                entry.row.calls = whole::calls(engines.of(arm), scene, &cameras, &wanted(case, arm), &options).ok();
                if draws && arm.samples == Samples::AtOnce(1) {
                    entry.row.drawn = drawn(&mut engines.drawing, scene, camera, &options, &frame)?;
                }
            }
            if let (Some((scene, camera)), Some(arm), true) = (scene, entry.arm, entry.row.is_ours()) {
                let options = options(case, arm, rules)?;
                let is_plain = !arm.bare && arm.method.is_none() && !matches!(arm.samples, Samples::Separate(_));
                if (case.counted || rules.counts) && is_plain {
                    let counted = counted(&mut engines.computing, scene, camera, &options, &frame)?;
                    // of frames that trace nothing is counted
                    entry.row.counted = Some(counted).filter(|c| c.pairs_tested > 0);
                }
                let is_provable = camera.optics.is_none() && arm.arithmetic == Arithmetic::Rechecked;
                if let (true, true, Some(truth)) = (case.stiffness.is_some(), is_provable, judge.truth()) {
                    entry.row.certified = Some(certified(&mut engines.computing, scene, camera, &options, truth)?);
                }
            }
        }
        rows.push(entry.row);
    }
    for (at, row) in rows.iter_mut().enumerate() {
        let baseline = if bare_at.is_some_and(|bare| at > bare) { bare_at } else { baselines.first().copied() };
        row.to_ours = baseline.filter(|_| row.times.is_some()).and_then(|b| Ratio::of(&rounds[at], &rounds[b]));
    }
    Ok(rows)
}

/// The arm that is asked for no more than the program beside: t and ids of one ray per pixel.
fn beside(case: &Case, ours: &Arm) -> Arm {
    let bare = ours.clone().bare();
    if case.filtered.is_some() { bare.samples(Samples::AtOnce(1)) } else { bare }
}

/// Times all arms, alternating, and in the rounds after the least those that are not settled beside the `baselines`; returns the median
/// time of an empty kernel between them, ms.
fn time(engine: &Engine, scenes: &Scenes, entries: &mut [Entry], baselines: &[usize], rules: &Rules) -> Result<f64> {
    let mut control = Vec::new();
    let [first_ms, each_ms] = rules.warm_ms;
    entries.iter_mut().for_each(|entry| entry.warm(scenes, 0, first_ms));
    let [least, most] = rules.runs;
    let started = Instant::now();
    for k in 0..most {
        let is_open: Vec<bool> = entries.iter().map(|e| k < least || !e.is_settled()).collect();
        let is_late = k >= least && started.elapsed().as_secs_f64() > rules.seconds_max;
        if is_late || !is_open.contains(&true) {
            break;
        }
        let mut order: Vec<usize> = (0..entries.len()).collect();
        if k % 2 == 1 {
            order.reverse();
        }
        control.push(empty_frame(&engine.gpu)?);
        for at in order {
            let runs = is_open[at] || baselines.contains(&at);
            if runs {
                entries[at].warm(scenes, k + 1, each_ms);
            }
            let ms = if runs { entries[at].time(scenes, k + 1) } else { None };
            entries[at].rounds.push(ms);
        }
    }
    Ok(Times::of(&control).median)
}

/// An arm, or the program beside all, while it runs.
struct Entry<'a> {
    row: Row,
    /// `None`: it is the program.
    arm: Option<&'a Arm>,
    runner: Option<Runner>,
    /// The time of its frame in each round, ms.
    rounds: Vec<Option<f64>>,
    /// The time of its only frame, ms, where that took too long for more.
    once_ms: Option<f64>,
}

impl<'a> Entry<'a> {
    /// Puts everything that the arm needs on the device, and runs a first frame.
    fn prepare(
        &mut self,
        engine: &mut Engine,
        scene: &'a Scene,
        (camera, moved): (&'a Camera, &'a [Camera]),
        wanted: &Wanted,
        options: &Result<RunOptions>,
        first_ms_max: f64,
    ) {
        self.row.describe(scene, camera);
        let options = options.as_ref().map_err(Clone::clone);
        if !moved.is_empty() {
            let each = |camera| options.clone().and_then(|options| engine.prepare(scene, camera, wanted, options));
            match moved.iter().map(each).collect() {
                Ok(frames) => self.runner = Some(Runner::Separate(frames)),
                Err(e) => self.row.refused = Some(e.to_string()),
            }
            return;
        }
        match options.and_then(|options| engine.prepare(scene, camera, wanted, options)) {
            Ok(frames) => {
                let first_ms = frames.first_ms();
                if first_ms > first_ms_max && !self.row.is_ours() {
                    self.once_ms = Some(first_ms);
                }
                self.runner = Some(Runner::Frames(Box::new(frames)));
            }
            Err(e) => self.row.refused = Some(e.to_string()),
        }
    }

    /// Frames that are not timed, for so long.
    fn warm(&mut self, scenes: &Scenes, k: u32, ms: f64) {
        let started = Instant::now();
        while started.elapsed().as_secs_f64() * 1e3 < ms && self.time(scenes, k).is_some() {}
    }

    /// One more frame, ms; `None` if it is not repeated or fails.
    fn time(&mut self, scenes: &Scenes, k: u32) -> Option<f64> {
        let runner = self.runner.as_mut().filter(|_| self.once_ms.is_none())?;
        let set = self.arm.map_or(&[][..], |arm| &arm.set);
        match runner.frame(scenes, set, k) {
            Ok(ms) => Some(ms),
            Err(e) => {
                self.row.refused = Some(e.to_string());
                self.runner = None;
                None
            }
        }
    }

    /// Its times by round; its only frame counts as of the first.
    fn rounds(&self) -> Vec<Option<f64>> {
        if self.once_ms.is_some() { vec![self.once_ms] } else { self.rounds.clone() }
    }

    fn times(&self) -> Times {
        Times::of(&self.rounds().into_iter().flatten().collect::<Vec<f64>>())
    }

    /// More frames would tell nothing, or there are none.
    fn is_settled(&self) -> bool {
        self.runner.is_none() || self.once_ms.is_some() || self.times().is_settled()
    }

    /// The frame by the camera of the first frame; the times of all frames go to the row.
    fn finish(&mut self, first: Option<&Camera>) -> Option<Frame> {
        let runner = self.runner.take()?;
        if self.row.refused.is_none() {
            self.row.times = Some(self.times());
        }
        match runner.finish(first, &mut self.row) {
            Ok(frame) => Some(frame),
            Err(e) => {
                self.row.refused = Some(e.to_string());
                None
            }
        }
    }
}

/// Compares frames with one reference image, which is rendered for the first.
struct Judge<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    judgement: Option<Judgement>,
    /// Every frame is compared with the candidates near each pixel, not only the first frame.
    each: bool,
}

impl Judge<'_> {
    fn error(&mut self, frame: &Frame) -> Result<Error> {
        if self.each {
            self.judgement = None;
        }
        let row_step = row_step(self.camera, 1);
        let truth = self.judgement.get_or_insert_with(|| judge_rows(self.scene, self.camera, frame, row_step));
        let error =
            Error::of(&compare(&every_row(frame, row_step), &truth.truth, Some(&truth.safe), Some(&truth.scales))?);
        Ok(Error { wrong_not_near: self.each.then_some(truth.not_near), row_step, ..error })
    }

    /// The reference's frame, once a frame has been compared with it.
    fn truth(&self) -> Option<&Frame> {
        self.judgement.as_ref().map(|j| &j.truth)
    }
}

/// The cameras of an arm's samples, where each takes a frame.
fn cameras_separately(arm: &Arm, scene: &Result<(Scene, Camera)>) -> Result<Vec<Camera>> {
    match (arm.samples, scene) {
        (Samples::Separate(n), Ok((_, camera))) => cameras_of_samples(camera, n),
        _ => Ok(Vec::new()),
    }
}

/// The camera at the place and the time of each of so many samples.
fn cameras_of_samples(camera: &Camera, count: u32) -> Result<Vec<Camera>> {
    let samples = (0..count).zip(sample_offsets(count));
    samples.map(|(number, place)| camera.of_sample(place.into(), Sample { number, count })).collect()
}

pub(super) const COLOURS: [Channel; 3] = [Channel::R, Channel::G, Channel::B];

fn has_colors(frame: &Frame) -> bool {
    COLOURS.iter().all(|channel| frame.f32(*channel).is_some())
}

/// The colours of the reference, with so many samples per pixel, in the rows that are compared.
struct Filtered {
    truth: Frame,
    row_step: u32,
}

impl Filtered {
    fn new(scene: &Scene, camera: &Camera, samples: u32) -> Result<Filtered> {
        let row_step = row_step(camera, samples);
        let cameras = cameras_of_samples(camera, samples)?;
        let frame = |camera: &Camera| rows_of_image(scene, camera, &COLOURS, row_step);
        Ok(Filtered { truth: mean(cameras.iter().map(frame)), row_step })
    }

    fn error(&self, frame: &Frame) -> Result<Error> {
        let error = Error::of(&compare(&every_row(frame, self.row_step), &self.truth, None, None)?);
        Ok(Error { row_step: self.row_step, ..error })
    }
}

/// The means of all frames' colours.
fn mean(frames: impl Iterator<Item = Frame>) -> Frame {
    let mut sums: Vec<Vec<f64>> = Vec::new();
    let (mut size, mut count) = ((0, 0), 0.0);
    for frame in frames {
        let pixels = frame.width as usize * frame.height as usize;
        sums.resize(COLOURS.len(), vec![0.0; pixels]);
        for (sum, channel) in sums.iter_mut().zip(COLOURS) {
            let values = frame.f32(channel).unwrap_or_default();
            sum.iter_mut().zip(values).for_each(|(s, v)| *s += f64::from(*v));
        }
        (size, count) = ((frame.width, frame.height), count + 1.0);
    }
    let plane = |sum: &Vec<f64>| Plane::F32(sum.iter().map(|s| (s / count) as f32).collect());
    let planes = COLOURS.into_iter().zip(&sums).map(|(channel, sum)| (channel, plane(sum))).collect();
    Frame { width: size.0, height: size.1, planes }
}

/// The options of an arm's render.
fn wanted(case: &Case, arm: &Arm) -> Wanted {
    let seen = seen(case.stiffness.is_some(), arm.bare);
    match (case.filtered.filter(|_| !arm.bare), arm.samples) {
        (Some(_), Samples::AtOnce(samples)) => Wanted { samples, ..Wanted::of(COLOURS.to_vec()) },
        (Some(_), Samples::Analytic(samples)) => Wanted { samples, analytic: true, ..Wanted::of(COLOURS.to_vec()) },
        (Some(_), Samples::Separate(frames)) => Wanted { frames, ..Wanted::of(COLOURS.to_vec()) },
        (None, _) => seen,
    }
}

/// `depth`: how far along the rays things are is asked for too; `bare`: no colour.
pub(super) fn seen(depth: bool, bare: bool) -> Wanted {
    let mut channels = vec![Channel::T, Channel::TriangleId];
    channels.extend([Channel::R, Channel::G, Channel::B].into_iter().filter(|_| !bare));
    channels.extend(depth.then_some(Channel::Z));
    Wanted::of(channels)
}

fn options(case: &Case, arm: &Arm, rules: &Rules) -> Result<RunOptions> {
    let (moving, draws_max) = (case.moving == Moving::Triangles, rules.draws_max);
    let (no_cull, arithmetic) = (arm.no_cull, arm.arithmetic);
    // what raster's stages do is counted
    let method = arm.method.unwrap_or(if case.counted { Method::Raster } else { Method::Auto });
    Ok(RunOptions { rival: arm.choice()?, moving, no_cull, method, arithmetic, draws_max, ..Default::default() })
}

/// Counters of one frame.
fn counted(
    engine: &mut Engine,
    scene: &Scene,
    camera: &Camera,
    options: &RunOptions,
    frame: &Frame,
) -> Result<Counted> {
    let wanted = Wanted { counting: true, ..seen(false, false) };
    let counts = engine.render(scene, camera, &wanted, options)?.counts;
    Ok(Counted::of(counts, covered(frame)))
}

/// What the adapter's rasterizer does for one frame of a rival.
fn drawn(
    engine: &mut Engine,
    scene: &Scene,
    camera: &Camera,
    options: &RunOptions,
    frame: &Frame,
) -> Result<Option<Drawn>> {
    let wanted = Wanted { counting: true, ..seen(false, false) };
    let draws = engine.render(scene, camera, &wanted, options)?.draws;
    Ok(draws.map(|draws| Drawn::of(draws, covered(frame))))
}

/// Pixels that show a triangle.
fn covered(frame: &Frame) -> u64 {
    frame.u32(Channel::TriangleId).map_or(0, |ids| ids.iter().filter(|id| **id != NO_ID).count() as u64)
}

/// Proofs of one frame.
fn certified(
    engine: &mut Engine,
    scene: &Scene,
    camera: &Camera,
    options: &RunOptions,
    truth: &Frame,
) -> Result<Certified> {
    let wanted = Wanted::of(vec![Channel::TriangleId, Channel::Certified]);
    let frame = engine.render(scene, camera, &wanted, options)?.frame;
    let ids = |frame: &Frame| frame.u32(Channel::TriangleId).map(<[u32]>::to_vec).unwrap_or_default();
    let proven = frame.u32(Channel::Certified).unwrap_or_default();
    let share = |how: u32| proven.iter().filter(|p| **p == how).count() as f64 / proven.len().max(1) as f64;
    let differs = ids(&frame).iter().zip(&ids(truth)).map(|(a, b)| a != b).collect::<Vec<_>>();
    let wrong = proven.iter().zip(differs).filter(|(p, differs)| **p > 0 && *differs).count() as u64;
    Ok(Certified { by_f32: share(2), by_recheck: share(1), wrong })
}

impl Runner {
    /// Time of the first frame, ms; 0 for an external program.
    fn first_ms(&self) -> f64 {
        match self {
            Runner::Frames(frames) => frames.first_ms(),
            Runner::Separate(frames) => frames.iter().map(Frames::first_ms).sum(),
            Runner::Yardstick(_) => 0.0,
        }
    }

    /// Frame `k` of the scene with `set`, ms.
    fn frame(&mut self, scenes: &Scenes, set: &[String], k: u32) -> Result<f64> {
        match self {
            Runner::Frames(frames) if scenes.case.moving == Moving::Camera => {
                let scene = scenes.load(set, k)?;
                let started = Instant::now();
                frames.aim(&scene.camera()?)?;
                let aimed_ms = started.elapsed().as_secs_f64() * 1e3;
                Ok(aimed_ms + frames.frame()?)
            }
            Runner::Frames(frames) => frames.frame(),
            Runner::Separate(frames) => frames.iter_mut().map(Frames::frame).sum(),
            Runner::Yardstick(yardstick) => yardstick.frame(),
        }
    }

    /// The frame by the camera of the first frame; the times of all frames go to the row.
    fn finish(self, first: Option<&Camera>, row: &mut Row) -> Result<Frame> {
        match self {
            Runner::Frames(mut frames) => {
                if let Some(camera) = first.filter(|_| row.moving == Moving::Camera) {
                    frames.aim(camera)?;
                }
                let rendered = frames.finish()?;
                row.took(&rendered);
                Ok(rendered.frame)
            }
            Runner::Separate(frames) => {
                let rendered: Vec<Rendered> = frames.into_iter().map(Frames::finish).collect::<Result<_>>()?;
                row.passes = rendered.iter().map(|r| r.passes.total()).sum();
                row.bytes = rendered.iter().map(|r| r.bytes).sum();
                Ok(mean(rendered.into_iter().map(|r| r.frame)))
            }
            Runner::Yardstick(yardstick) => yardstick.finish(),
        }
    }
}

/// Each `step`-th row of a frame, from the first one on.
fn every_row(frame: &Frame, step: u32) -> Frame {
    let width = frame.width as usize;
    let kept = |k: &usize| (k / width).is_multiple_of(step as usize);
    let plane = |plane: &Plane| match plane {
        Plane::F32(v) => Plane::F32((0..v.len()).filter(kept).map(|k| v[k]).collect()),
        Plane::U32(v) => Plane::U32((0..v.len()).filter(kept).map(|k| v[k]).collect()),
    };
    let planes = frame.planes.iter().map(|(channel, values)| (*channel, plane(values))).collect();
    Frame { width: frame.width, height: frame.height.div_ceil(step), planes }
}

/// Submits one empty pass: the time of a frame that does nothing, ms.
pub(super) fn empty_frame(gpu: &Gpu) -> Result<f64> {
    let started = Instant::now();
    let mut recorder = Recorder::new(gpu, 1);
    drop(recorder.compute("empty"));
    recorder.submit(gpu)?;
    wait(gpu)?;
    Ok(started.elapsed().as_secs_f64() * 1e3)
}
