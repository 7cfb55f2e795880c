//! Multisampling: colour and coverage are averaged over several rays per pixel; all other channels use the pixel centre. The engine
//! renders all samples in one frame if it can; else each takes its own frame.

use super::backend::Backend;
use crate::camera::Camera;
use crate::camera::exposure::Sample;
use crate::engine::combinations::at_once;
use crate::engine::plan::Wanted;
use crate::engine::plan::samples::sample_offsets;
use crate::engine::planned::Planned;
use crate::engine::sequence::Sequence;
use crate::engine::{Rendered, RunOptions};
use crate::image::cryptomatte::Matte;
use crate::image::frame::{Channel, Frame, Plane};
use crate::image::opaque8;
use crate::input::{Error, Result};
use crate::scene::Scene;
use std::sync::Arc;

/// The channels that are averaged.
const MEANS: [Channel; 4] = [Channel::R, Channel::G, Channel::B, Channel::A];

/// Renders with `samples` rays per pixel; times, counts and stages are the sums over all frames. Every ray counts in the mattes.
pub fn render(
    backend: &mut Backend,
    scene: &Scene,
    camera: &Arc<Camera>,
    wanted: &Wanted,
    samples: u32,
    run: &RunOptions,
    mattes: &mut [Matte],
) -> Result<Rendered> {
    let ids = (!mattes.is_empty()).then_some(Channel::TriangleId);
    if samples == 1 || at_once_on(backend, scene, camera, samples) {
        let mut rendered = backend.render(scene, camera, &in_one_frame(wanted, samples, ids.is_some()), run)?;
        count(&mut rendered, mattes);
        return Ok(rendered);
    }
    let is_mean = |c: &Channel| MEANS.contains(c);
    let is_colour = |c: &Channel| wanted.srgb8 && *c != Channel::A;
    let means: Vec<Channel> = MEANS.into_iter().filter(|c| wanted.channels.contains(c) || is_colour(c)).collect();
    let mut all = Sum::default();
    if !means.is_empty() || ids.is_some() {
        let channels = means.into_iter().chain(ids).collect();
        let each = Wanted { counting: wanted.counting, frames: samples, ..Wanted::of(channels) };
        let mut frames = Frames::default();
        let run = &RunOptions { share: run.share.part_of(samples as usize), ..run.clone() };
        for (number, offset) in (0..samples).zip(sample_offsets(samples)) {
            let moved = Arc::new(camera.of_sample(offset.into(), Sample { number, count: samples })?);
            let rendered = frames.render(backend, scene, &moved, &each, run)?;
            count_centres(&rendered.frame, mattes);
            all.add(rendered);
        }
    }
    let mut frame = all.mean(camera, samples);
    let srgb8 = if wanted.srgb8 { opaque8(&frame, scene.tone) } else { None };
    frame.planes.retain(|(c, _)| wanted.channels.contains(c));
    let rest: Vec<Channel> = wanted.channels.iter().copied().filter(|c| !is_mean(c)).collect();
    if !rest.is_empty() {
        let each = Wanted { counting: wanted.counting, ..Wanted::of(rest) };
        let mut centre = backend.render(scene, camera, &each, run)?;
        frame.planes.append(&mut centre.frame.planes);
        frame.planes.sort_by_key(|(c, _)| *c);
        all.add_costs(centre);
    }
    let mut rendered = all.costs.ok_or_else(|| Error::work("no frame was asked for"))?;
    (rendered.frame, rendered.srgb8) = (frame, srgb8);
    Ok(rendered)
}

/// The options of a frame that may be one of a sequence and renders the whole image; `None`: it takes several frames, or one by itself.
pub fn in_sequence(scene: &Scene, camera: &Camera, wanted: &Wanted, samples: u32, has_mattes: bool) -> Option<Wanted> {
    Some(in_one_frame(wanted, samples, has_mattes)).filter(|wanted| Sequence::takes(scene, camera, wanted))
}

/// Whether one frame renders all samples.
pub fn at_once_on(backend: &Backend, scene: &Scene, camera: &Camera, samples: u32) -> bool {
    let Backend::Compute(_, rival) = backend else { return false };
    rival.is_none_or(|choice| choice.samples(camera) == samples) && at_once(scene, camera, samples)
}

/// The options of that frame.
pub fn in_one_frame(wanted: &Wanted, samples: u32, has_mattes: bool) -> Wanted {
    if samples > 1 {
        return Wanted { samples, sample_ids: has_mattes, ..wanted.clone() };
    }
    let channels = Channel::in_order(wanted.channels.iter().copied().chain(has_mattes.then_some(Channel::TriangleId)));
    Wanted { channels, ..wanted.clone() }
}

/// Adds the ids of all samples of that frame to the mattes.
pub fn count(rendered: &mut Rendered, mattes: &mut [Matte]) {
    if rendered.sample_ids.is_empty() {
        return count_centres(&rendered.frame, mattes);
    }
    for ids in std::mem::take(&mut rendered.sample_ids) {
        mattes.iter_mut().for_each(|matte| matte.add(&ids));
    }
}

fn count_centres(frame: &Frame, mattes: &mut [Matte]) {
    let ids = frame.u32(Channel::TriangleId).unwrap_or_default();
    mattes.iter_mut().for_each(|matte| matte.add(ids));
}

/// The frames of samples, one after another: what they share stays on the device.
#[derive(Default)]
struct Frames {
    sequence: Sequence,
    last: Option<Planned>,
}

impl Frames {
    fn render(
        &mut self,
        backend: &mut Backend,
        scene: &Scene,
        camera: &Arc<Camera>,
        wanted: &Wanted,
        run: &RunOptions,
    ) -> Result<Rendered> {
        let is_plain = run.repeat == 0 && !run.moving && Sequence::takes(scene, camera, wanted);
        let Backend::Compute(engine, None) = backend else { return backend.render(scene, camera, wanted, run) };
        if !is_plain {
            return engine.render(scene, camera.clone(), wanted, run).inspect(|_| run.share.add());
        }
        let planned = engine.planner().plan(scene, camera.clone(), wanted, run, self.last.as_ref())?;
        self.last = Some(planned.clone());
        let rendered = self.sequence.render(engine, planned, run)?.rendered();
        run.share.add();
        Ok(rendered)
    }
}

/// Sums of planes in f64, and of their costs.
#[derive(Default)]
struct Sum {
    planes: Vec<(Channel, Vec<f64>)>,
    costs: Option<Rendered>,
}

impl Sum {
    fn add(&mut self, rendered: Rendered) {
        for (channel, plane) in &rendered.frame.planes {
            let Plane::F32(values) = plane else { continue };
            match self.planes.iter_mut().find(|(c, _)| c == channel) {
                Some((_, sum)) => sum.iter_mut().zip(values).for_each(|(s, v)| *s += f64::from(*v)),
                None => self.planes.push((*channel, values.iter().map(|v| f64::from(*v)).collect())),
            }
        }
        self.add_costs(rendered);
    }

    fn add_costs(&mut self, mut next: Rendered) {
        next.frame.planes.clear();
        match &mut self.costs {
            Some(sum) => sum.add_costs(&next),
            None => self.costs = Some(next),
        }
    }

    fn mean(&self, camera: &Camera, samples: u32) -> Frame {
        let n = f64::from(samples);
        let mean = |sum: &Vec<f64>| Plane::F32(sum.iter().map(|s| (s / n) as f32).collect());
        let planes = self.planes.iter().map(|(c, sum)| (*c, mean(sum))).collect();
        Frame { width: camera.width, height: camera.height, planes }
    }
}
