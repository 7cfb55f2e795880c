//! The times of a frame at which a scene file is read: those between which everything moves straight.

use super::{FileStep, SceneFile, read_all_spheres, read_meshes};
use crate::arrays::MapEach;
use crate::camera::kinds::read_camera_and_readout;
use crate::camera::spec::CameraSpec;
use crate::geometry::spec::{MeshSource, MeshSpec};
use crate::geometry::time_steps::TIMES_MAX;
use crate::input::keyframes;
use crate::input::reader::{Field, Source};
use crate::input::tree::{Node, Value};
use crate::input::{Error, Result};

/// Degrees that a mesh turns in a step at most, unless the file says how many steps there are: a point's way in a step is then longer than
/// its chord by less than 0.04 percent.
const TURN_MAX: f64 = 5.0;

/// Steps of a second of a glTF animation, unless the file says how many there are.
const ANIMATION_STEPS: f64 = 60.0;

/// Steps of a camera that moves from one keyframe to the next, unless the file says how many there are.
const CAMERA_STEPS: u32 = 8;

/// Most steps of a frame, each from one time to the next.
const STEPS_MAX: u64 = TIMES_MAX as u64 - 1;

/// The scene at the times that a frame takes; none if nothing has keyframes, or all is exposed at once. `keyed` has all keyframes as they
/// are, `file` is the scene at `frame`.
pub(super) fn steps(keyed: &Node, source: &Source, file: &SceneFile, frame: f64) -> Result<Vec<FileStep>> {
    let moving = ["mesh", "spheres", "camera"].map_each(|key| entry(keyed, key));
    let keys: Vec<f64> = moving.into_iter().flatten().flat_map(keyframes::frames).collect();
    if keys.is_empty() || file.exposure.is_instant() {
        return Ok(Vec::new());
    }
    let [first, last] = file.exposure.range();
    let at = |time: f64| step(keyed, source, file, (frame, time));
    let mut times: Vec<f64> = keys.iter().map(|key| key - frame).filter(|t| first < *t && *t < last).collect();
    times.extend([first, last]);
    times.sort_by(f64::total_cmp);
    times.dedup();
    if times.len() == 1 {
        // all at one time, which is not the frame's own
        times.push(last + 1.0);
    }
    let refuse = |n: String| {
        Err(Error::input(format!(
            "{}: the frame takes {n} steps from keyframe to keyframe, over the limit of {STEPS_MAX}; shorten shutter or line_time, or set \
             image.motion_steps",
            source.path.display()
        )))
    };
    // each way is at least one step; counted before the scene is read at each keyframe
    let ways = times.len() as u64 - 1;
    if ways > STEPS_MAX {
        return refuse(format!("{ways} or more"));
    }
    let ends = times.iter().map(|t| at(*t)).collect::<Result<Vec<_>>>()?;
    let ways: Vec<(f64, f64, u32)> = ends
        .windows(2)
        .map(|pair| {
            let (from, to) = (pair[0].time, pair[1].time);
            let of_frame = |n: u32| (f64::from(n) * (to - from)).ceil() as u32;
            (from, to, file.image.motion_steps.map_or_else(|| parts(&pair[0], &pair[1]), of_frame))
        })
        .collect();
    // counted before any is listed: there can be billions
    let n: u64 = ways.iter().map(|(.., parts)| u64::from(*parts)).sum();
    if n > STEPS_MAX {
        return refuse(n.to_string());
    }
    let part = |(from, to, parts)| (0..parts).map(move |k| from + (to - from) * f64::from(k) / f64::from(parts));
    ways.into_iter().flat_map(part).chain(times.last().copied()).map(at).collect()
}

fn entry<'a>(root: &'a Node, key: &str) -> Option<&'a Node> {
    let Value::Table(entries) = &root.value else { return None };
    entries.iter().find(|e| e.key == key).map(|e| &e.node)
}

/// Meshes and camera at a time after a frame.
fn step(keyed: &Node, source: &Source, file: &SceneFile, (frame, time): (f64, f64)) -> Result<FileStep> {
    let at = |key: &str| -> Result<Option<Node>> {
        let Some(node) = entry(keyed, key).filter(|node| !keyframes::frames(node).is_empty()) else { return Ok(None) };
        let mut node = node.clone();
        keyframes::pick(&mut node, key, source, frame + time)?;
        Ok(Some(node))
    };
    let is_spheres = |mesh: &&MeshSpec| matches!(mesh.source, MeshSource::Spheres(_));
    let mut meshes: Vec<MeshSpec> = match at("mesh")? {
        Some(node) => read_meshes(&Field::new(source, "mesh", &node))?,
        None => file.meshes.iter().filter(|mesh| !is_spheres(mesh)).cloned().collect(),
    };
    match at("spheres")? {
        Some(node) => meshes.extend(read_all_spheres(&Field::new(source, "spheres", &node))?),
        None => meshes.extend(file.meshes.iter().filter(is_spheres).cloned()),
    }
    let camera: CameraSpec = match at("camera")? {
        Some(node) => {
            let size = (file.image.width, file.image.height);
            read_camera_and_readout(&Field::new(source, "camera", &node), size, file.image.frame_rate)?.0
        }
        None => file.camera.clone(),
    };
    Ok(FileStep { time, meshes, camera })
}

/// Steps from one keyframe to the next.
fn parts(from: &FileStep, to: &FileStep) -> u32 {
    let turn = |(a, b): (&MeshSpec, &MeshSpec)| (b.rotate - a.rotate).abs().element_sum();
    let turned = from.meshes.iter().zip(&to.meshes).map(turn).fold(0.0, f64::max);
    let time = |mesh: &MeshSpec| mesh.animation.as_ref().map_or(0.0, |a| a.time);
    let played = from.meshes.iter().zip(&to.meshes).map(|(a, b)| (time(b) - time(a)).abs()).fold(0.0, f64::max);
    // a number of any size saturates
    let of_meshes = (turned / TURN_MAX).max(played * ANIMATION_STEPS).ceil().max(1.0) as u32;
    if from.camera == to.camera { of_meshes } else { of_meshes.max(CAMERA_STEPS) }
}
