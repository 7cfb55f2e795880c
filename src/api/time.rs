//! Time within a frame: objects that move while an image is taken, and when its pixels are exposed.

use super::Scene;
use crate::camera::exposure::{self, Lines, Readout, TimeTable};
use crate::geometry::time_steps::{TIMES_MAX, TimeSteps};
use crate::input::{Error, Result};
use glam::DVec3;
use std::sync::Arc;

pub use crate::camera::exposure::LineOrder;

/// When the pixels of an image are exposed: `docs/guide/time.md`. Times are in frames, or in any unit that is also that of
/// [`Scene::animate`]. By default all pixels are exposed at time 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Exposure {
    /// Time from one line to the next; the first line is read at time 0.
    pub line_time: f64,
    /// From the first line to the last.
    pub line_order: LineOrder,
    /// Instead: width, height and, row by row, the time of each pixel. A table of one row, or one column, holds for all.
    pub times: Option<(u32, u32, Vec<f64>)>,
    /// How long the shutter is open at each pixel, about the pixel's own time. Images of several samples are blurred by it.
    pub shutter: f64,
}

impl Default for Exposure {
    fn default() -> Exposure {
        Exposure { line_time: 0.0, line_order: LineOrder::Down, times: None, shutter: 0.0 }
    }
}

impl Scene {
    /// Lets an object move while an image is taken: at each of `times`, ascending, it has the vertices beside it, in world units, as many as it
    /// has. Between two times vertices move straight; before the first and after the last they stand still. The object is where it is at
    /// time 0 for everything that has no time, such as bounds and motion vectors. Its normals are dropped: it is shaded flat.
    /// [`Scene::move_object`] and [`Scene::set_vertices`] let it stand still again.
    ///
    /// # Errors
    /// [`Error::Input`] if the scene has no such object or has caustics, times do not ascend or are more than 256 in all, counts differ, or a
    /// number is not finite; the scene is then unchanged.
    pub fn animate(&mut self, name: &str, times: &[f64], vertices: &[Vec<[f64; 3]>]) -> Result<()> {
        self.or_unchanged(|scene| scene.animate_vertices(name, times, vertices))
    }

    fn animate_vertices(&mut self, name: &str, times: &[f64], vertices: &[Vec<[f64; 3]>]) -> Result<()> {
        let range = self.rest(name)?.vertices();
        let count = range.len();
        if times.is_empty() || times.len() != vertices.len() {
            let (k, n) = (times.len(), vertices.len());
            return Err(Error::input(format!(
                "{name}: {n} lists of vertices for {k} times; give one for each, and one at least"
            )));
        }
        if let Some(k) =
            times.windows(2).position(|pair| pair[0] >= pair[1]).or_else(|| times.iter().position(|t| !t.is_finite()))
        {
            return Err(Error::input(format!("{name}: times must be finite and ascend; see number {k}")));
        }
        if let Some((k, given)) = vertices.iter().map(Vec::len).enumerate().find(|(_, n)| *n != count) {
            return Err(Error::input(format!(
                "{name}: {given} vertices at time {} for an object of {count}",
                times[k]
            )));
        }
        if let Some(v) = vertices.iter().flatten().find(|v| !v.iter().all(|x| x.is_finite())) {
            return Err(Error::input(format!("{name}: a vertex would lie at {v:?}; use finite numbers")));
        }
        let positions: Vec<Vec<DVec3>> =
            vertices.iter().map(|step| step.iter().map(|v| DVec3::from_array(*v)).collect()).collect();
        let before = self.scene.steps.clone();
        let steps = TimeSteps::with(before.as_deref(), &self.scene.mesh, range, (times, &positions));
        if let Some(steps) = steps.as_ref().filter(|steps| steps.count() as usize > TIMES_MAX) {
            return Err(Error::input(format!(
                "{} times of all objects are over the limit of {TIMES_MAX}",
                steps.count()
            )));
        }
        // where it is at time 0
        let now = match steps.as_ref().map(|steps| (steps, steps.moment(0.0))) {
            Some((steps, moment)) => {
                let start = self.rest(name)?.vertices().start as u32;
                (0..count as u32).map(|v| steps.position_at(&self.scene.mesh, start + v, moment)).collect()
            }
            None => positions[0].clone(),
        };
        self.put(name, now, None)?;
        self.scene.steps = steps.map(Arc::new);
        Ok(())
    }

    /// Sets when the pixels of images are exposed.
    ///
    /// # Errors
    /// [`Error::Input`] for numbers that are not finite, a shutter below 0, or a table of another size than it says.
    pub fn set_exposure(&mut self, exposure: &Exposure) -> Result<()> {
        let Exposure { line_time, line_order, times, shutter } = exposure;
        if !line_time.is_finite() || !(0.0..f64::INFINITY).contains(shutter) {
            return Err(Error::input(format!(
                "line_time {line_time}, shutter {shutter}; use finite numbers, and a shutter of 0 and above"
            )));
        }
        let readout = match times {
            None if *line_time == 0.0 => Readout::AtOnce,
            None => Readout::Lines(Lines { first: 0.0, line_time: *line_time, order: *line_order, count: 0 }),
            Some((width, height, times)) => {
                if *line_time != 0.0 {
                    return Err(Error::input("times say it already; leave line_time out"));
                }
                let count = u64::from(*width) * u64::from(*height);
                if count == 0 || count != times.len() as u64 || times.iter().any(|t| !t.is_finite()) {
                    let n = times.len();
                    return Err(Error::input(format!(
                        "{n} times for {width} x {height} pixels; give a finite one for each"
                    )));
                }
                Readout::Table(Arc::new(TimeTable { size: Some((*width, *height)), times: times.clone() }))
            }
        };
        self.scene.exposure = exposure::Exposure { readout, shutter: *shutter, is_even: self.scene.exposure.is_even };
        Ok(())
    }
}
