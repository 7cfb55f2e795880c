//! The passes of one submission, each timed where the adapter can.

#[cfg(feature = "internals")]
pub mod drawing;

use super::buffers::wait;
use super::device::Gpu;
use super::draw_counts::{DrawCounts, DrawQueries};
use super::queries::{Queries, answered};
use super::readback::PendingRead;
use crate::input::Result;

/// Records passes, named after their stages.
pub struct Recorder {
    pub encoder: wgpu::CommandEncoder,
    times: Option<Times>,
    draws: Option<DrawQueries>,
    passes: Passes,
}

/// What is left to read once a submission is done.
pub struct Recorded {
    times: Option<Times>,
    draws: Option<DrawQueries>,
    pub submission: wgpu::SubmissionIndex,
    pub passes: Passes,
}

/// Number of passes of each stage, in the order of first use.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Passes(Vec<(&'static str, u32)>);

/// Timestamps at the start and end of every pass.
struct Times {
    queries: Queries,
    /// Of the passes that are recorded.
    names: Vec<&'static str>,
    /// How many fit.
    capacity: u32,
}

/// Index of the first of a pass's two timestamps.
fn first(pass: usize) -> u32 {
    2 * pass as u32
}

impl Passes {
    pub fn by_stage(&self) -> &[(&'static str, u32)] {
        &self.0
    }

    pub fn total(&self) -> u32 {
        self.0.iter().map(|stage| stage.1).sum()
    }

    /// Adds the passes of another submission.
    pub fn add(&mut self, other: &Passes) {
        other.0.iter().for_each(|(name, count)| *self.of(name) += count);
    }

    fn count(&mut self, name: &'static str) {
        *self.of(name) += 1;
    }

    fn of(&mut self, name: &'static str) -> &mut u32 {
        let at = self.0.iter().position(|stage| stage.0 == name).unwrap_or_else(|| {
            self.0.push((name, 0));
            self.0.len() - 1
        });
        &mut self.0[at].1
    }
}

impl Recorder {
    /// Times all of at most `passes_max` passes, or none where they are too many.
    pub fn new(gpu: &Gpu, passes_max: u32) -> Recorder {
        let queries = || Queries::new(gpu, wgpu::QueryType::Timestamp, 2 * passes_max, 1);
        let times = gpu.has.timestamps.then(queries).flatten();
        let times = times.map(|queries| Times { queries, names: Vec::new(), capacity: passes_max });
        let encoder = gpu.device.create_command_encoder(&Default::default());
        Recorder { encoder, times, draws: None, passes: Passes::default() }
    }

    /// Counts what the rasterizer does in the passes of [`Recorder::draw`], where the adapter can.
    pub fn counting_draws(self, gpu: &Gpu, passes_max: u32) -> Recorder {
        Recorder { draws: DrawQueries::new(gpu, passes_max), ..self }
    }

    pub fn compute(&mut self, name: &'static str) -> wgpu::ComputePass<'_> {
        let k = self.count(name);
        let timestamp_writes = self.times.as_ref().zip(k).map(|(t, k)| wgpu::ComputePassTimestampWrites {
            query_set: &t.queries.set,
            beginning_of_pass_write_index: Some(k),
            end_of_pass_write_index: Some(k + 1),
        });
        let label = Some(name);
        self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label, timestamp_writes })
    }

    /// The first timestamp of the next pass.
    fn count(&mut self, name: &'static str) -> Option<u32> {
        self.passes.count(name);
        let times = self.times.as_mut().filter(|t| t.names.len() < t.capacity as usize)?;
        times.names.push(name);
        Some(first(times.names.len() - 1))
    }

    pub fn submit(mut self, gpu: &Gpu) -> Result<Recorded> {
        if let Some(times) = &self.times {
            times.queries.resolve(gpu, &mut self.encoder, first(times.names.len()));
        }
        if let Some(draws) = &self.draws {
            draws.resolve(gpu, &mut self.encoder);
        }
        let submission = gpu.queue.submit([self.encoder.finish()]);
        gpu.failure()?;
        Ok(Recorded { times: self.times, draws: self.draws, submission, passes: self.passes })
    }
}

impl Recorded {
    /// The time on the device of every stage, ms, summed over its passes; empty without timestamps.
    pub fn stage_ms(&self, gpu: &Gpu) -> Result<Vec<(&'static str, f64)>> {
        let pending = self.read();
        wait(gpu)?;
        self.stages_read(gpu, pending)
    }

    /// Starts to read the times, for [`Recorded::stages_read`].
    pub fn read(&self) -> Option<PendingRead> {
        self.times.as_ref().map(|t| t.queries.start())
    }

    /// Starts to read what the rasterizer counted, for [`Recorded::draws_read`].
    pub fn read_draws(&self) -> Option<PendingRead> {
        self.draws.as_ref().map(DrawQueries::start)
    }

    /// What it counted, once the submission is done; `None` if it did not.
    pub fn draws_read(&self, gpu: &Gpu, pending: Option<PendingRead>) -> Result<Option<DrawCounts>> {
        self.draws.as_ref().zip(pending).map(|(draws, pending)| draws.read(gpu, pending)).transpose()
    }

    /// As [`Recorded::stage_ms`], once the submission is done.
    pub fn stages_read(&self, gpu: &Gpu, pending: Option<PendingRead>) -> Result<Vec<(&'static str, f64)>> {
        let (Some(times), Some(pending)) = (&self.times, pending) else { return Ok(Vec::new()) };
        let stamps = answered(gpu, pending)?;
        let period_ms = f64::from(gpu.queue.get_timestamp_period()) / 1e6;
        let mut sums: Vec<(&'static str, f64)> = Vec::new();
        for (pass, name) in times.names.iter().enumerate() {
            let k = first(pass) as usize;
            let ms = stamps[k + 1].saturating_sub(stamps[k]) as f64 * period_ms;
            match sums.iter_mut().find(|s| s.0 == *name) {
                Some(sum) => sum.1 += ms,
                None => sums.push((name, ms)),
            }
        }
        Ok(sums)
    }
}
