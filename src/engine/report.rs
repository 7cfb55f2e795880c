//! The report of a render, as JSON: `docs/reference/commands.md`, Reports.

use crate::camera::Camera;
use crate::engine::call_ms::CallMs;
use crate::engine::left_out::LeftOut;
use crate::engine::rival::EngineName;
use crate::engine::{Counts, MethodUsed, Rendered};
use crate::image::compare::Comparison;
use crate::scene::Scene;
use crate::scene::caustics::CausticsReport;
use serde::Serialize;

/// What rendered, and on what.
#[derive(Debug, Clone, Serialize)]
pub struct Device {
    pub adapter: String,
    pub driver: String,
    pub engine: EngineName,
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

/// Passes of one stage in a frame.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct StagePasses {
    pub name: &'static str,
    pub passes: u32,
}

/// How many items the stages processed in a frame, or in all frames whose mean is the picture; see [`Counts`].
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Operations {
    pub cull_items: u64,
    pub split_items: u64,
    pub bin_items: u64,
    pub large_items: u64,
    pub raster_items: u64,
    pub recheck_pixels: u64,
    pub edge_pixels: u64,
    pub recheck_sample_items: u64,
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
    /// Images of this size, where they are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub views: Option<usize>,
    pub samples: u32,
    pub triangles: usize,
    /// 0 for a camera that has a ray of its own for each pixel.
    pub pieces: usize,
    /// Of the library from the call until the arrays are in memory, of the program from its start until the files are written.
    pub call_ms: CallMs,
    pub frame_ms: FrameMs,
    /// Empty without timestamps.
    pub stages: Vec<StageMs>,
    /// Compute and render passes of a frame.
    pub passes: Option<u32>,
    /// The passes of each stage.
    pub stage_passes: Vec<StagePasses>,
    /// The items that the stages processed.
    pub operations: Option<Operations>,
    pub pairs_tested: Option<u64>,
    pub pairs_kept: Option<u64>,
    pub fragments_tested: Option<u64>,
    pub fragments_kept: Option<u64>,
    /// Tested fragments whose signs f32 did not prove.
    pub rechecked: Option<u64>,
    /// Their share of `fragments_tested`.
    pub rechecked_share: Option<f64>,
    /// Device memory held.
    pub bytes: Option<u64>,
    /// How the triangle of each pixel was found; null with a rival or the reference.
    pub method: Option<MethodUsed>,
    pub left_out: Vec<LeftOut>,
    /// What the camera's keys ask for and this scene does not allow.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unmet: Vec<String>,
    /// How many times lists had to grow.
    pub grown: Option<u32>,
    /// Where the light of the scene's caustics went.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub caustics: Option<CausticsReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<Judged>,
}

impl Operations {
    fn of(counts: Counts) -> Operations {
        Operations {
            cull_items: counts.cull_items,
            split_items: counts.split_items,
            bin_items: counts.bin_items,
            large_items: counts.large_items,
            raster_items: counts.pairs,
            recheck_pixels: counts.rechecked,
            edge_pixels: counts.edges,
            recheck_sample_items: counts.recheck_sample_items,
        }
    }
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
        let missing = scene.mesh.base().missing.iter().cloned().map(LeftOut::Missing);
        Report {
            version: env!("CARGO_PKG_VERSION"),
            device,
            width: camera.width,
            height: camera.height,
            views: None,
            samples: 1,
            triangles: scene.mesh.triangle_count(),
            pieces: camera.piece_count(),
            call_ms: rendered.call,
            frame_ms: FrameMs::of(&rendered.frame_ms),
            stages: rendered.stages.iter().map(|&(name, ms)| StageMs { name, ms }).collect(),
            passes: Some(rendered.passes.total()).filter(|passes| *passes > 0),
            stage_passes: rendered
                .passes
                .by_stage()
                .iter()
                .map(|&(name, passes)| StagePasses { name, passes })
                .collect(),
            operations: has_device.then(|| Operations::of(rendered.counts)),
            pairs_tested: counts.map(|c| c.pairs_tested),
            pairs_kept: counts.map(|c| c.pairs_kept),
            fragments_tested: counts.map(|c| c.fragments_tested),
            fragments_kept: counts.map(|c| c.fragments_kept),
            rechecked: counts.map(|c| c.rechecked),
            rechecked_share: counts.map(|c| c.rechecked as f64 / c.fragments_tested.max(1) as f64),
            bytes: has_device.then_some(rendered.bytes),
            method: Some(rendered.method.clone()).filter(|method| !method.name.is_empty()),
            left_out: rendered.left_out.iter().cloned().chain(missing).collect(),
            unmet: camera.unfulfilled.clone(),
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
