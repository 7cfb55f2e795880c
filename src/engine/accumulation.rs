//! Renders each sample of a pixel in a frame of its own. Color and coverage are the means of these frames; all other channels are those at
//! pixel centers.

use super::combinations::Asked;
use super::plan::Wanted;
use super::plan::samples::sample_offsets;
use super::planned::Planned;
use super::sequence::Sequence;
use super::{Engine, Rendered, RunOptions};
use crate::camera::Camera;
use crate::camera::exposure::Sample;
use crate::image::frame::{Channel, Frame, Plane};
use crate::image::opaque8;
use crate::image::tone::Tone;
use crate::input::{Error, Result};
use crate::scene::Scene;
use std::sync::Arc;

/// The channels that are means over samples.
const MEANS: [Channel; 4] = [Channel::R, Channel::G, Channel::B, Channel::A];

/// Renders a frame for each of `wanted.samples`, and one of pixel centers if channels of these are wanted. Times, counts and stages are sums
/// over all frames. `ids` receives the triangle ids of each sample, if these are wanted.
pub fn render(
    (camera, wanted, tone): (&Arc<Camera>, &Wanted, Tone),
    run: &RunOptions,
    mut frame: impl FnMut(&Arc<Camera>, &Wanted, &RunOptions) -> Result<Rendered>,
    ids: &mut dyn FnMut(Vec<u32>),
) -> Result<Rendered> {
    let samples = wanted.samples;
    let is_mean = |c: &Channel| MEANS.contains(c);
    let is_color = |c: &Channel| wanted.srgb8 && *c != Channel::A;
    let means: Vec<Channel> = MEANS.into_iter().filter(|c| wanted.channels.contains(c) || is_color(c)).collect();
    let rest: Vec<Channel> = wanted.channels.iter().copied().filter(|c| !is_mean(c)).collect();
    let has_means = !means.is_empty() || wanted.sample_ids;
    let frames = if has_means { samples as usize } else { 0 } + usize::from(!rest.is_empty());
    let run = &RunOptions { share: run.share.part_of(frames), ..run.clone() };
    let mut sum = Sum::default();
    if has_means {
        let one = Wanted { counting: wanted.counting, rows: wanted.rows, ..Wanted::of(means) };
        let each = Wanted { sample_ids: wanted.sample_ids, frames: samples, ..one };
        for (number, offset) in (0..samples).zip(sample_offsets(samples)) {
            let moved = Arc::new(camera.of_sample(offset.into(), Sample { number, count: samples })?);
            let mut rendered = frame(&moved, &each, run)?;
            rendered.sample_ids.drain(..).for_each(&mut *ids);
            sum.add(rendered);
        }
    }
    let mut mean = sum.mean(camera, wanted);
    let srgb8 = if wanted.srgb8 { opaque8(&mean, tone) } else { None };
    mean.planes.retain(|(c, _)| wanted.channels.contains(c));
    if !rest.is_empty() {
        let of_centers = Wanted { counting: wanted.counting, rows: wanted.rows, ..Wanted::of(rest) };
        let mut centers = frame(camera, &of_centers, run)?;
        mean.planes.append(&mut centers.frame.planes);
        mean.planes.sort_by_key(|(c, _)| *c);
        sum.add_costs(centers);
    }
    let costs = sum.costs.ok_or_else(|| Error::work("no frame was asked for"))?;
    Ok(Rendered { frame: mean, srgb8, ..costs })
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

    fn mean(&self, camera: &Camera, wanted: &Wanted) -> Frame {
        let n = f64::from(wanted.samples);
        let mean = |sum: &Vec<f64>| Plane::F32(sum.iter().map(|s| (s / n) as f32).collect());
        let planes = self.planes.iter().map(|(c, sum)| (*c, mean(sum))).collect();
        Frame { width: camera.width, height: wanted.rows.map_or(camera.height, |rows| rows.count), planes }
    }
}

/// Renders frames one after another; data that they share stays on the device.
#[derive(Default)]
struct Successive {
    sequence: Sequence,
    last: Option<Planned>,
}

impl Successive {
    fn render(
        &mut self,
        engine: &mut Engine,
        scene: &Scene,
        camera: &Arc<Camera>,
        wanted: &Wanted,
        run: &RunOptions,
    ) -> Result<Rendered> {
        let is_plain = run.rival.is_none() && run.repeat == 0 && !run.moving;
        if !is_plain || !Sequence::takes(scene, camera, wanted) {
            return engine.render(scene, camera.clone(), wanted, run);
        }
        let planned = engine.planner().plan(scene, camera.clone(), wanted, run, self.last.as_ref())?;
        self.last = Some(planned.clone());
        let rendered = self.sequence.render(engine, planned, run)?.rendered();
        run.share.add();
        Ok(rendered)
    }
}

impl Engine {
    /// Renders a frame for each sample.
    pub(super) fn accumulate(
        &mut self,
        scene: &Scene,
        camera: &Arc<Camera>,
        wanted: &Wanted,
        run: &RunOptions,
        ids: &mut dyn FnMut(Vec<u32>),
    ) -> Result<Rendered> {
        Asked::of(scene, camera, wanted, run).check()?;
        let mut frames = Successive::default();
        let frame =
            |camera: &Arc<Camera>, wanted: &Wanted, run: &RunOptions| frames.render(self, scene, camera, wanted, run);
        render((camera, wanted, scene.tone), run, frame, ids)
    }
}
