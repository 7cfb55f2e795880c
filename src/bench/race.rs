//! Running a case: all arms in turn, A B A B, the order turned round every other time, with an empty kernel as a control; each
//! frame is held against one truth.

use super::case::{Arm, Case};
use super::row::{Counted, Error, Moving, Row, Times};
use super::yardstick::Yardstick;
use crate::camera::Camera;
use crate::compare::compare;
use crate::engine::{Engine, Frames, RunOptions};
use crate::error::Result;
use crate::frame::{Channel, Frame, NO_ID};
use crate::plan::Wanted;
use crate::reference::image::{Judgement, judge};
use crate::scene::Scene;
use std::path::PathBuf;
use std::time::Instant;

/// How cases are run.
#[derive(Debug, Clone)]
pub struct Rules {
    /// Timed frames of each arm.
    pub runs: u32,
    /// A program that runs beside all arms of cases that it can show.
    pub yardstick: Option<PathBuf>,
    /// Triangles that a technique may draw a frame.
    pub draws_max: Option<u64>,
    /// How long a technique's first frame may take, ms, to be repeated.
    pub first_ms_max: f64,
}

impl Rules {
    /// Of a full run, or of one for a look: `quick`. A software adapter draws some millions of triangles a second.
    pub fn new(quick: bool, is_software: bool) -> Rules {
        Rules {
            runs: if quick { 3 } else { 9 },
            yardstick: None,
            draws_max: is_software.then_some(if quick { 500_000 } else { 8_000_000 }),
            first_ms_max: if quick { 1500.0 } else { 10_000.0 },
        }
    }
}

/// Frames of more pixels are not held against the reference: it takes minutes.
const JUDGED_MAX: u64 = 1 << 20;

/// What runs.
enum Runner<'a> {
    Frames(Box<Frames<'a>>),
    Yardstick(Yardstick),
}

/// The scene file of a case.
struct Stage<'a> {
    case: &'a Case,
    path: PathBuf,
}

impl Stage<'_> {
    fn scene(&self, more: &[String], frame: u32) -> Result<Scene> {
        Scene::load(&self.path, &[&self.case.set[..], more].concat(), f64::from(frame))
    }

    fn scene_and_camera(&self, more: &[String]) -> Result<(Scene, Camera)> {
        let scene = self.scene(more, 0)?;
        let camera = scene.camera()?;
        Ok((scene, camera))
    }
}

/// Runs all arms of a case; what a technique cannot show is a row that says so.
///
/// # Errors
/// [`crate::Error`] where the case's scene or the device fails.
pub fn race(engine: &mut Engine, suite: &str, case: &Case, rules: &Rules) -> Result<Vec<Row>> {
    let folder = tempfile::tempdir().map_err(|e| crate::Error::work(format!("no temporary folder: {e}")))?;
    let stage = Stage { case, path: case.write(folder.path())? };
    let (truth_scene, truth_camera) = stage.scene_and_camera(&case.truth)?;
    let scenes: Vec<Result<(Scene, Camera)>> = case.arms.iter().map(|arm| stage.scene_and_camera(&arm.set)).collect();

    // everything that an arm needs, on the device
    let mut rows: Vec<Row> = case.arms.iter().map(|arm| Row::new(suite, case, arm)).collect();
    let mut runners = Vec::new();
    for ((arm, scene), row) in case.arms.iter().zip(&scenes).zip(&mut rows) {
        let runner = scene.as_ref().map_err(Clone::clone).and_then(|(scene, camera)| {
            row.describe(scene, camera);
            let frames = engine.prepare(scene, camera, &wanted(false), &options(case, arm, rules)?)?;
            let (first_ms, most) = (frames.first_ms(), rules.first_ms_max);
            if first_ms > most && !row.is_ours() {
                let why = format!("its first frame took {first_ms:.0} ms; those over {most:.0} are not repeated");
                return Err(crate::Error::work(why));
            }
            Ok(Runner::Frames(Box::new(frames)))
        });
        runners.push(or_refused(runner, row));
    }
    if let Some(program) = &rules.yardstick {
        if let Some(yardstick) = Yardstick::new(program, &truth_scene, &truth_camera, case.moving)? {
            let mut row = Row::of_yardstick(suite, case, program);
            row.describe(&truth_scene, &truth_camera);
            runners.push(Some(Runner::Yardstick(yardstick)));
            rows.push(row);
        }
    }

    let mut times = vec![Vec::new(); runners.len()];
    let mut control = Vec::new();
    for k in 0..rules.runs {
        let mut order: Vec<usize> = (0..runners.len()).collect();
        if k % 2 == 1 {
            order.reverse();
        }
        control.push(engine.empty_frame()?);
        for at in order {
            let Some(runner) = &mut runners[at] else { continue };
            let set = case.arms.get(at).map_or(&[][..], |arm| &arm.set);
            match runner.frame(&stage, set, k + 1) {
                Ok(ms) => times[at].push(ms),
                Err(e) => {
                    rows[at].refused = Some(e.to_string());
                    runners[at] = None;
                }
            }
        }
    }

    let judged = u64::from(truth_camera.width) * u64::from(truth_camera.height) <= JUDGED_MAX;
    let mut truth: Option<Judgement> = None;
    for (at, (runner, row)) in runners.into_iter().zip(&mut rows).enumerate() {
        let Some(runner) = runner else { continue };
        row.times = Some(Times::of(&times[at]));
        row.control_ms = Times::of(&control).median;
        let first = scenes.get(at).and_then(|s| s.as_ref().ok()).map(|s| &s.1);
        let Some(frame) = or_refused(runner.finish(first, row), row) else { continue };
        if judged {
            let truth = truth.get_or_insert_with(|| judge(&truth_scene, &truth_camera, &frame));
            let of = compare(&frame, &truth.truth, Some(&truth.safe), Some(&truth.scales))?;
            row.error = Some(Error::of(&of));
        }
        if case.counted && row.is_ours() {
            row.counted = Some(counted(engine, &options(case, &case.arms[at], rules)?, &scenes[at], &frame)?);
        }
    }
    let ours = rows.iter().find(|r| r.is_ours()).and_then(|r| r.times.as_ref()).map(|t| t.median);
    rows.iter_mut().for_each(|row| row.relate(ours));
    Ok(rows)
}

/// `None` with the reason in the row.
fn or_refused<T>(result: Result<T>, row: &mut Row) -> Option<T> {
    result.map_err(|e| row.refused = Some(e.to_string())).ok()
}

fn wanted(counting: bool) -> Wanted {
    let channels = vec![Channel::R, Channel::G, Channel::B, Channel::T, Channel::TriangleId];
    Wanted { channels, srgb8: false, counting }
}

fn options(case: &Case, arm: &Arm, rules: &Rules) -> Result<RunOptions> {
    let (moving, draws_max) = (case.moving == Moving::Triangles, rules.draws_max);
    Ok(RunOptions { by: arm.choice()?, moving, no_cull: arm.no_cull, draws_max, ..Default::default() })
}

/// What one frame tests and keeps.
fn counted(
    engine: &mut Engine,
    options: &RunOptions,
    scene: &Result<(Scene, Camera)>,
    frame: &Frame,
) -> Result<Counted> {
    let (scene, camera) = scene.as_ref().map_err(Clone::clone)?;
    let counts = engine.render(scene, camera, &wanted(true), options)?.counts;
    let covered = frame.u32(Channel::TriangleId).map_or(0, |ids| ids.iter().filter(|id| **id != NO_ID).count());
    Ok(Counted::of(counts, covered as u64))
}

impl Runner<'_> {
    /// Frame `k` of the scene with `set`, ms.
    fn frame(&mut self, stage: &Stage, set: &[String], k: u32) -> Result<f64> {
        match self {
            Runner::Frames(frames) if stage.case.moving == Moving::Camera => {
                let scene = stage.scene(set, k)?;
                let started = Instant::now();
                frames.aim(&scene.camera()?)?;
                let aimed_ms = started.elapsed().as_secs_f64() * 1e3;
                Ok(aimed_ms + frames.frame()?)
            }
            Runner::Frames(frames) => frames.frame(),
            Runner::Yardstick(yardstick) => yardstick.frame(),
        }
    }

    /// What it sees by the camera of the first frame; what all took goes to the row.
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
            Runner::Yardstick(yardstick) => yardstick.finish(),
        }
    }
}
