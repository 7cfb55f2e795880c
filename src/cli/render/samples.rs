//! Many rays a pixel: colour and coverage are means over the pixel, everything else stays that of its centre.

use super::backend::{Backend, picture};
use crate::camera::Camera;
use crate::engine::{Rendered, RunOptions};
use crate::error::{Error, Result};
use crate::frame::{Channel, Frame, Plane};
use crate::output::cryptomatte::Matte;
use crate::plan::Wanted;
use crate::scene::Scene;

/// The channels that are averaged.
const MEANS: [Channel; 4] = [Channel::R, Channel::G, Channel::B, Channel::A];

/// Renders with `samples` rays a pixel; times, counts and stages are the sums over all of them. Every ray counts in the mattes.
pub fn render(
    backend: &mut Backend,
    scene: &Scene,
    camera: &Camera,
    wanted: &Wanted,
    samples: u32,
    run: &RunOptions,
    mattes: &mut [Matte],
) -> Result<Rendered> {
    let ids = (!mattes.is_empty()).then_some(Channel::TriangleId);
    let mut count = |frame: &Frame| {
        let ids = frame.u32(Channel::TriangleId).unwrap_or_default();
        mattes.iter_mut().for_each(|matte| matte.add(ids));
    };
    if samples == 1 {
        let mut channels: Vec<Channel> = wanted.channels.iter().copied().chain(ids).collect();
        channels.sort_unstable();
        channels.dedup();
        let rendered = backend.render(scene, camera, &Wanted { channels, ..wanted.clone() }, run)?;
        count(&rendered.frame);
        return Ok(rendered);
    }
    let is_mean = |c: &Channel| MEANS.contains(c);
    let is_colour = |c: &Channel| wanted.srgb8 && *c != Channel::A;
    let means: Vec<Channel> = MEANS.into_iter().filter(|c| wanted.channels.contains(c) || is_colour(c)).collect();
    let mut all = Sum::default();
    if !means.is_empty() || ids.is_some() {
        let channels = means.into_iter().chain(ids).collect();
        let each = Wanted { channels, srgb8: false, counting: wanted.counting };
        for (dx, dy) in offsets(samples) {
            let rendered = backend.render(scene, &camera.with_sample_offset(dx, dy), &each, run)?;
            count(&rendered.frame);
            all.add(rendered);
        }
    }
    let mut frame = all.mean(camera, samples);
    let srgb8 = if wanted.srgb8 { picture(&frame, scene.tone) } else { None };
    frame.planes.retain(|(c, _)| wanted.channels.contains(c));
    let rest: Vec<Channel> = wanted.channels.iter().copied().filter(|c| !is_mean(c)).collect();
    if !rest.is_empty() {
        let each = Wanted { channels: rest, srgb8: false, counting: wanted.counting };
        let mut centre = backend.render(scene, camera, &each, run)?;
        frame.planes.append(&mut centre.frame.planes);
        frame.planes.sort_by_key(|(c, _)| *c);
        all.add_costs(centre);
    }
    let mut rendered = all.costs.ok_or_else(|| Error::work("no frame was asked for"))?;
    (rendered.frame, rendered.srgb8) = (frame, srgb8);
    Ok(rendered)
}

/// Places of `count` samples about the pixel's centre, px, right and down, each in (-1/2, 1/2).
///
/// A rank-1 lattice without its origin: the k-th of N samples lies in column k and row (k + 1) g mod (N + 1) - 1 of
/// an N x N grid, in the middle of its cell, g being the number nearest to (N + 1) / golden ratio that is coprime to
/// N + 1. Each column and each row is taken once, so the mean of the places is the centre; 4 is the rotated grid.
fn offsets(count: u32) -> impl Iterator<Item = (f64, f64)> {
    const GOLDEN: f64 = 1.618_033_988_749_895;
    let (n, modulus) = (f64::from(count), count + 1);
    let ideal = f64::from(modulus) / GOLDEN;
    let distance = |g: &u32| (f64::from(*g) - ideal).abs();
    let coprime = (1..modulus).filter(|&g| greatest_common_divisor(g, modulus) == 1);
    let generator = coprime.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(1);
    (0..count).map(move |k| {
        let row = (k + 1) * generator % modulus - 1;
        ((f64::from(k) + 0.5) / n - 0.5, (f64::from(row) + 0.5) / n - 0.5)
    })
}

fn greatest_common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

/// Sums of planes in f64, and of what they cost.
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
        let Some(sum) = &mut self.costs else {
            self.costs = Some(next);
            return;
        };
        sum.frame_ms.iter_mut().zip(&next.frame_ms).for_each(|(s, ms)| *s += ms);
        for (name, ms) in next.stages {
            match sum.stages.iter_mut().find(|s| s.0 == name) {
                Some(stage) => stage.1 += ms,
                None => sum.stages.push((name, ms)),
            }
        }
        sum.bytes = sum.bytes.max(next.bytes);
        sum.grown += next.grown;
    }

    fn mean(&self, camera: &Camera, samples: u32) -> Frame {
        let n = f64::from(samples);
        let mean = |sum: &Vec<f64>| Plane::F32(sum.iter().map(|s| (s / n) as f32).collect());
        let planes = self.planes.iter().map(|(c, sum)| (*c, mean(sum))).collect();
        Frame { width: camera.width, height: camera.height, planes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_are_centred_and_take_each_row_once() {
        assert_eq!(offsets(1).collect::<Vec<_>>(), [(0.0, 0.0)]);
        for count in 1..=64 {
            let n = f64::from(count);
            let mut rows: Vec<u32> = offsets(count).map(|o| ((o.1 + 0.5) * n).floor() as u32).collect();
            rows.sort_unstable();
            assert_eq!(rows, (0..count).collect::<Vec<_>>());
            let mean = offsets(count).fold((0.0, 0.0), |m, o| (m.0 + o.0, m.1 + o.1));
            assert!(mean.0.abs() < 1e-12 && mean.1.abs() < 1e-12);
        }
    }

    #[test]
    fn four_samples_are_the_rotated_grid() {
        let eighths: Vec<_> = offsets(4).map(|(x, y)| (x * 8.0, y * 8.0)).collect();
        assert_eq!(eighths, [(-3.0, 1.0), (-1.0, -3.0), (1.0, 3.0), (3.0, -1.0)]);
    }
}
