//! Whole calls through the public interface: from a change of the camera, of matrices of objects or of vertices to the arrays in the
//! caller's memory, along a path; and many small images at once.

mod beside;
mod city;
mod many;
mod memory;
mod path;

use super::case::{Arm, Case, Source};
use super::race::{Engines, Rules, empty_frame};
use super::row::{Calls, Error, Row};
use super::times::{Ratio, Times};
use anamorph::Error as Failure;
use anamorph::{Camera, Channel, RenderOptions, Rendered, Renderer, Result};
use city::City;
pub use city::Motion;
pub use path::{Lens, Pose};
use std::path::Path;
use std::time::Instant;

/// A case of whole calls.
#[derive(Debug, Clone, Copy)]
pub struct Plan {
    pub work: Work,
    pub lens: Lens,
    pub motion: Motion,
    pub triangles: u32,
    /// Width and height, pixels.
    pub size: (u32, u32),
    /// Poses of the path: half along a street, half around the city.
    pub poses: u32,
}

/// Work of one call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Work {
    /// An image at each pose, a call each.
    Image,
    /// The images of all poses by one call of `Renderer::render_many`.
    Views,
    /// The images of all poses by one `Batch`, written as EXR.
    Batch,
}

/// The channels that a call asks for.
const CHANNELS: [Channel; 3] = [Channel::T, Channel::Z, Channel::TriangleId];

/// Seconds of the calls of a case: of slower ones poses are left out.
const SECONDS_MAX: f64 = 40.0;

/// Calls of the slowest cases.
const CALLS_MIN: u32 = 10;

/// Pixels of an image up to which four poses are compared with the reference; two of a larger one.
const SMALL: u32 = 500_000;

impl Plan {
    /// A case with its name.
    pub fn case(self, name: String) -> Case {
        let source =
            Source::Files(vec![("scene.toml", self.text()), (path::CALIBRATION_FILE, path::CALIBRATION.into())]);
        Case { calls: Some(self), moving: self.motion.moving(), ..Case::new(name, source, vec![Arm::ours()]) }
    }

    /// The scene file, with the camera of the first pose.
    fn text(&self) -> String {
        format!("{}[camera]\n{}", city::meshes(self.motion, self.triangles), self.camera_keys(0))
    }

    fn camera_keys(&self, pose: u32) -> String {
        self.lens.keys(&Pose::of(pose, self.poses))
    }

    fn options() -> RenderOptions {
        RenderOptions { channels: CHANNELS.to_vec(), ..RenderOptions::default() }
    }

    /// The camera at a pose.
    fn camera(&self, pose: u32, city: &City, folder: &Path) -> Result<Camera> {
        let size = self.lens.own_size().unwrap_or(self.size);
        Camera::parse(&self.camera_keys(pose), folder, &city.scene, Some(size))
    }

    /// The poses that are compared with the reference: as many from both halves of the path.
    fn checked(&self) -> Vec<u32> {
        let (width, height) = self.lens.own_size().unwrap_or(self.size);
        let eighths: &[u32] = if width * height <= SMALL { &[1, 3, 5, 7] } else { &[2, 6] };
        eighths.iter().map(|k| k * self.poses / 8).collect()
    }
}

/// Runs a case of whole calls: the row of this engine, and the row of the program beside, if it can show the camera.
///
/// # Errors
/// [`anamorph::Error`] where the scene, the device or the program fails.
pub fn rows(engines: &Engines, suite: &str, case: &Case, plan: &Plan, rules: &Rules) -> Result<Vec<Row>> {
    let folder = tempfile::tempdir().map_err(|e| Failure::work(format!("no temporary folder: {e}")))?;
    let folder = folder.path();
    let adapter = engines.computing.gpu.info.name.as_str();
    let mut row = Row { control_ms: empty_frame(&engines.computing.gpu)?, ..Row::new(suite, case, &case.arms[0]) };
    let mut city = City::new(plan.motion, &plan.text(), folder)?;
    let camera = plan.camera(0, &city, folder)?;
    (row.triangles, row.pieces) = (city.scene.triangle_count(), camera.piece_count());
    (row.width, row.height) = (camera.width(), camera.height());
    match plan.work {
        Work::Image => {}
        Work::Views => return Ok(vec![many::views(plan, adapter, &city, folder, row)?]),
        Work::Batch => return Ok(vec![many::batch(plan, adapter, folder, row)?]),
    }
    let program = rules.yardstick.as_deref();
    let beside = program.map(|program| beside::row(program, suite, case, plan, &city, folder)).transpose()?.flatten();
    let mut renderer = Renderer::on(adapter)?;
    let timed = time(plan, &mut city, &mut renderer, folder)?;
    let mut errors = Vec::new();
    for pose in plan.checked() {
        let change = city.change(plan.motion, pose);
        city.apply(&change)?;
        let camera = plan.camera(pose, &city, folder)?;
        let frame = renderer.render(&city.scene, &camera, &Plan::options())?.frame;
        errors.push(Error::of(&anamorph::check(&city.scene, &camera, &frame)?));
    }
    row.error = Error::over(&errors);
    timed.add_to(&mut row);
    let mut rows = vec![row];
    if let Some((mut row, rounds)) = beside {
        let theirs: Vec<Option<f64>> = rounds.iter().map(|round| Some(round.1)).collect();
        let ours: Vec<Option<f64>> = rounds.iter().map(|round| timed.at(round.0)).collect();
        row.to_ours = Ratio::of(&theirs, &ours);
        rows.push(row);
    }
    Ok(rows)
}

/// Times of one call.
struct Call {
    pose: u32,
    ms: f64,
    /// The parts of the call by name, ms.
    parts: Vec<(String, f64)>,
    frame_ms: f64,
    /// Times on the device by stage, ms.
    stages: Vec<(String, f64)>,
}

/// Times of the calls of a case.
struct Timed {
    first_ms: f64,
    calls: Vec<Call>,
    /// Device memory held, bytes.
    bytes: u64,
    peak_bytes: Option<u64>,
}

/// Renders along the path.
fn time(plan: &Plan, city: &mut City, renderer: &mut Renderer, folder: &Path) -> Result<Timed> {
    memory::forget_peak();
    // the first call compiles the kernels and uploads the scene
    let (first, mut rendered) = call(plan, 0, city, renderer, folder)?;
    let (mut calls, mut pose): (Vec<Call>, u32) = (Vec::new(), 0);
    while pose < plan.poses {
        let call;
        (call, rendered) = self::call(plan, pose, city, renderer, folder)?;
        calls.push(call);
        pose += step(&calls, plan.poses - pose, plan.poses);
    }
    Ok(Timed { first_ms: first.ms, calls, bytes: device_bytes(&rendered.report()), peak_bytes: memory::peak_bytes() })
}

/// Returns the distance to the next timed pose: if all further calls are as short as the shortest so far, the `left` poses end in time. At least
/// [`CALLS_MIN`] of the `poses` are timed.
fn step(calls: &[Call], left: u32, poses: u32) -> u32 {
    let all_ms: f64 = calls.iter().map(|call| call.ms).sum();
    let least_ms = calls.iter().map(|call| call.ms).fold(f64::INFINITY, f64::min);
    let in_time = least_ms * f64::from(left) / (1e3 * SECONDS_MAX - all_ms).max(0.0);
    // without time left it is infinite, and saturates
    (in_time.ceil() as u32).clamp(1, (poses / CALLS_MIN).max(1))
}

/// One call, from the change to the arrays.
fn call(plan: &Plan, pose: u32, city: &mut City, renderer: &mut Renderer, folder: &Path) -> Result<(Call, Rendered)> {
    let change = city.change(plan.motion, pose);
    let started = Instant::now();
    let since_start = || started.elapsed().as_secs_f64() * 1e3;
    city.apply(&change)?;
    let changed = since_start();
    let camera = plan.camera(pose, city, folder)?;
    let rendered = renderer.render(&city.scene, &camera, &Plan::options())?;
    let ms = since_start();
    let mut parts = vec![("change", changed)];
    parts.extend(rendered.call_parts_ms());
    let rest = ms - parts.iter().map(|part| part.1).sum::<f64>();
    parts.push(("rest", rest.max(0.0)));
    let parts = parts.into_iter().map(|(name, ms)| (name.to_owned(), ms)).collect();
    let stages = rendered.stages_ms().map(|(name, ms)| (name.to_owned(), ms)).collect();
    Ok((Call { pose, ms, parts, frame_ms: rendered.frame_ms(), stages }, rendered))
}

/// The device memory in a report of a render.
fn device_bytes(report: &str) -> u64 {
    let report: serde_json::Value = serde_json::from_str(report).unwrap_or_default();
    report["bytes"].as_u64().unwrap_or(0)
}

/// Medians by name, each over the lists that have it.
fn medians<'a>(lists: impl Iterator<Item = &'a Vec<(String, f64)>>) -> Vec<(String, f64)> {
    let mut all: Vec<(String, Vec<f64>)> = Vec::new();
    for (name, ms) in lists.flatten() {
        match all.iter_mut().find(|of| of.0 == *name) {
            Some(of) => of.1.push(*ms),
            None => all.push((name.clone(), vec![*ms])),
        }
    }
    all.into_iter().map(|(name, list)| (name, Times::of(&list).median)).collect()
}

impl Timed {
    fn add_to(&self, row: &mut Row) {
        let all: Vec<f64> = self.calls.iter().map(|call| call.ms).collect();
        let frames: Vec<f64> = self.calls.iter().map(|call| call.frame_ms).collect();
        row.times = Some(Times::of(&frames));
        row.stages = medians(self.calls.iter().map(|call| &call.stages));
        row.bytes = self.bytes;
        let first_ms = Some(self.first_ms);
        let parts = medians(self.calls.iter().map(|call| &call.parts));
        row.calls = Some(Calls { first_ms, parts, peak_bytes: self.peak_bytes, ..Calls::of(&all, &frames) });
    }

    /// The time of the call at a pose, ms.
    fn at(&self, pose: u32) -> Option<f64> {
        self.calls.iter().find(|call| call.pose == pose).map(|call| call.ms)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(lens: Lens, motion: Motion) -> Plan {
        Plan { work: Work::Image, lens, motion, triangles: 30_000, size: (64, 48), poses: 8 }
    }

    #[test]
    fn every_camera_sees_the_city_along_the_whole_path() {
        let folder = tempfile::tempdir().unwrap();
        for lens in Lens::ALL {
            let plan = plan(lens, Motion::Still);
            let city = City::new(plan.motion, &plan.text(), folder.path()).unwrap();
            for pose in 0..plan.poses {
                let camera = plan.camera(pose, &city, folder.path()).unwrap();
                assert_eq!((camera.width(), camera.height()), lens.own_size().unwrap_or(plan.size));
                let frame = anamorph::reference(&city.scene, &camera, &[Channel::TriangleId]);
                let hits = frame.u32(Channel::TriangleId).unwrap().iter().filter(|id| **id != anamorph::NO_ID).count();
                assert!(hits * 25 > frame.width as usize * frame.height as usize, "{lens:?} {pose}: {hits} hits");
            }
        }
    }

    #[test]
    fn a_change_gives_another_picture_and_no_change_the_same() {
        let folder = tempfile::tempdir().unwrap();
        for (motion, differs) in [(Motion::Still, false), (Motion::Objects, true), (Motion::Vertices, true)] {
            let plan = plan(Lens::Pinhole, motion);
            let mut city = City::new(motion, &plan.text(), folder.path()).unwrap();
            let camera = plan.camera(6, &city, folder.path()).unwrap();
            let pictures = [1, 5].map(|k| {
                let change = city.change(motion, k);
                city.apply(&change).unwrap();
                anamorph::reference(&city.scene, &camera, &[Channel::T])
            });
            assert_eq!(pictures[0] != pictures[1], differs, "{motion:?}");
            assert_eq!(city.scene.triangle_count(), 30_000);
        }
    }

    #[test]
    fn slow_calls_leave_poses_out_but_not_all() {
        let call = |ms: f64| Call { pose: 0, ms, parts: Vec::new(), frame_ms: 0.0, stages: Vec::new() };
        assert_eq!(step(&[call(10.0)], 100, 100), 1);
        // 40 s hold 40 calls of a second: one is done
        assert_eq!(step(&[call(1000.0)], 100, 100), 3);
        // a slow call takes time, but says nothing of the next ones
        assert_eq!(step(&[call(1000.0), call(19_000.0)], 100, 100), 5);
        assert_eq!(step(&[call(1000.0), call(90_000.0)], 50, 100), 10);
        assert_eq!(step(&[call(90_000.0)], 4, 8), 1);
    }

    #[test]
    fn medians_are_of_the_calls_that_have_a_part() {
        let list = |all: &[(&str, f64)]| all.iter().map(|(name, ms)| ((*name).to_owned(), *ms)).collect::<Vec<_>>();
        let lists = [list(&[("a", 1.0), ("b", 5.0)]), list(&[("a", 3.0)]), list(&[("a", 2.0), ("b", 7.0)])];
        assert_eq!(medians(lists.iter()), list(&[("a", 2.0), ("b", 6.0)]));
        assert_eq!(device_bytes("{ \"bytes\": 7 }"), 7);
    }
}
