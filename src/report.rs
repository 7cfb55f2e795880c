//! The report of a render: what the contract's section 4 lists, as JSON.

use crate::camera::Camera;
use crate::caustics::Account;
use crate::compare::Comparison;
use crate::engine::{Counts, Rendered};
use crate::plan::LeftOut;
use crate::scene::Scene;
use serde::Serialize;

/// What rendered, and on what.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Device {
    pub adapter: String,
    pub driver: String,
    /// compute, reference, or a rival and its number.
    pub engine: String,
}

/// Wall times of one frame, from the first submission until its results are complete on the device, ms.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrameMs {
    pub min: f64,
    pub median: f64,
    pub max: f64,
    /// How many frames were timed.
    pub runs: usize,
    /// Each of them, in order.
    pub all: Vec<f64>,
}

/// The time of one stage on the device, ms; the median over the timed frames.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageMs {
    pub name: &'static str,
    pub ms: f64,
}

/// The error against the reference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Judged {
    #[serde(flatten)]
    pub comparison: Comparison,
    /// Pixels whose triangle is neither the reference's nor a near candidate.
    pub not_near: u64,
}

/// One render. What an engine does not have is null.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    pub version: &'static str,
    #[serde(flatten)]
    pub device: Device,
    pub width: u32,
    pub height: u32,
    pub samples: u32,
    pub triangles: usize,
    /// 0 for a camera that has a ray of its own for each pixel.
    pub pieces: usize,
    pub frame_ms: FrameMs,
    /// From the start of the process until the files are written, ms.
    pub total_ms: f64,
    /// Empty without timestamps.
    pub stages: Vec<StageMs>,
    pub pairs_tested: Option<u64>,
    pub pairs_kept: Option<u64>,
    pub fragments_tested: Option<u64>,
    pub fragments_kept: Option<u64>,
    /// Decisions taken again in f64.
    pub rechecked: Option<u64>,
    /// Device memory held.
    pub bytes: Option<u64>,
    pub left_out: Vec<LeftOut>,
    /// How many times lists had to grow.
    pub grown: Option<u32>,
    /// Where the light of the scene's caustics went.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub caustics: Option<Account>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<Judged>,
}

impl FrameMs {
    /// The median of an even number of times is the upper of the two in the middle.
    pub fn of(times: &[f64]) -> FrameMs {
        let mut sorted = times.to_vec();
        sorted.sort_by(f64::total_cmp);
        let at = |k: usize| sorted.get(k).copied().unwrap_or(0.0);
        let runs = sorted.len();
        FrameMs { min: at(0), median: at(runs / 2), max: at(runs.saturating_sub(1)), runs, all: times.to_vec() }
    }
}

impl Report {
    /// The report of a frame. `counts` come from a run of its own; `None` with the reference engine, as all that
    /// only a device has.
    pub fn new(device: Device, scene: &Scene, camera: &Camera, rendered: &Rendered, counts: Option<Counts>) -> Report {
        let has_device = counts.is_some();
        Report {
            version: env!("CARGO_PKG_VERSION"),
            device,
            width: camera.width,
            height: camera.height,
            samples: 1,
            triangles: scene.mesh.triangles.len(),
            pieces: camera.piece_count(),
            frame_ms: FrameMs::of(&rendered.frame_ms),
            total_ms: 0.0,
            stages: rendered.stages.iter().map(|&(name, ms)| StageMs { name, ms }).collect(),
            pairs_tested: counts.map(|c| c.pairs_tested),
            pairs_kept: counts.map(|c| c.pairs_kept),
            fragments_tested: counts.map(|c| c.fragments_tested),
            fragments_kept: counts.map(|c| c.fragments_kept),
            rechecked: counts.map(|c| c.rechecked),
            bytes: has_device.then_some(rendered.bytes),
            left_out: rendered.left_out.clone(),
            grown: has_device.then_some(rendered.grown),
            caustics: rendered.caustics,
            error: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_keep_their_order_and_give_their_middle() {
        let ms = FrameMs::of(&[3.0, 1.0, 2.0]);
        assert_eq!((ms.min, ms.median, ms.max, ms.runs), (1.0, 2.0, 3.0, 3));
        assert_eq!(ms.all, [3.0, 1.0, 2.0]);
        assert_eq!(FrameMs::of(&[]).runs, 0);
    }
}
