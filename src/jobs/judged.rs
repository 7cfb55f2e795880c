//! The extra, untimed frame: for the report's counters, which slow a frame down, and for `--check`.

use super::backend::Backend;
use super::job::RenderJob;
use crate::camera::Camera;
use crate::engine::Rendered;
use crate::engine::plan::Wanted;
use crate::engine::report::Judged;
use crate::image::compare::compare;
use crate::image::frame::Channel;
use crate::input::Result;
use crate::reference::image;
use crate::scene::Scene;
use std::sync::Arc;

/// Renders an extra frame if a report or a check needs it: with counters, and for a check with all channels.
pub fn render(job: &RenderJob, backend: &mut Backend, scene: &Scene, camera: &Arc<Camera>) -> Result<Option<Rendered>> {
    let counting = job.report.is_some() && matches!(backend, Backend::Compute(..));
    if !counting && !job.check {
        return Ok(None);
    }
    let channels = if job.check { camera.channels() } else { vec![Channel::TriangleId] };
    let wanted = Wanted { counting, ..Wanted::of(channels) };
    let run = job.run_options();
    backend.render(scene, camera, &wanted, &run, &mut |_| {}).map(Some)
}

/// The error against the reference. Each requested channel is compared as rendered, except averaged ones, because
/// the reference has one ray per pixel; the others as in `extra`.
pub fn judge(scene: &Scene, camera: &Camera, asked: &Rendered, extra: &Rendered, samples: u32) -> Result<Judged> {
    let mut frame = extra.frame.clone();
    let averaged = |c: Channel| samples > 1 && matches!(c, Channel::R | Channel::G | Channel::B | Channel::A);
    for (channel, plane) in &mut frame.planes {
        let as_rendered = asked.frame.planes.iter().find(|(c, _)| c == channel && !averaged(*c));
        if let Some((_, rendered)) = as_rendered {
            plane.clone_from(rendered);
        }
    }
    let truth = image::judge(scene, camera, &frame);
    let comparison = compare(&frame, &truth.truth, Some(&truth.safe), Some(&truth.scales))?;
    Ok(Judged { comparison, not_near: truth.not_near })
}
