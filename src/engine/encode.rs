//! A frame as one submission: its steps one by one.

use super::changes::Dirty;
use super::frames::Frames;
use super::readback::{Copies, is_read};
use super::resident::{BvhState, Job};
use super::steps::{FrameInputs, Step, StepScope, passes, steps};
use crate::engine::rival::{ChunkScopes, Target};
use crate::engine::stage::Stages;
use crate::gpu::buffers::{BindGroups, Buffers};
use crate::gpu::layout::COUNTERS;
use crate::gpu::readback::readback;
use crate::gpu::recorder::{Recorded, Recorder};
use crate::input::Result;
use std::sync::PoisonError;
use std::sync::atomic::Ordering;

const STATUS_BYTES: u64 = 4 * COUNTERS as u64;

impl Frames {
    /// The steps that draw what is dirty of one frame. With `reads`, they copy its image to where the host can read it.
    pub(super) fn steps(&self, reads: bool, dirty: Dirty) -> Vec<Step> {
        let resident = &self.resident;
        let inputs = FrameInputs {
            plan: &self.plan,
            bounces: &resident.bounces,
            jobs: resident.jobs(0, 0).map(|job| job.clusters).collect(),
            batches: resident.batches as usize,
            raster_rounds: resident.raster_rounds,
            samples_by_tile: resident.samples_by_tile(&self.plan),
            prefers_trace: resident.bvh == BvhState::Preferred,
            aims: resident.needs_aim.load(Ordering::Relaxed),
            by_rival: self.rival.is_some(),
            gathers: self.caustics.is_some(),
            keeps: self.planes_copy.is_some(),
            reads,
        };
        steps(&inputs, dirty)
    }

    /// Compiles the kernels that steps take, before their time is taken.
    pub(super) fn compile(&self, steps: &[Step]) -> Result<()> {
        steps.iter().try_for_each(|step| match step {
            Step::Pass { at, dispatches, .. } => self.stages_of(at.bounce).compile(&self.gpu, dispatches),
            _ => Ok(()),
        })
    }

    /// Encodes and submits steps.
    pub(super) fn submit(&self, steps: &[Step]) -> Result<(Copies, Recorded)> {
        let gpu = &*self.gpu;
        let by_rival = |step: &Step| match (step, &self.rival) {
            (Step::Rival { band }, Some(rival)) => rival.passes(&self.target(*band)),
            _ => 0,
        };
        let rivals_passes = steps.iter().map(by_rival).sum::<u32>();
        let mut recorder = Recorder::new(gpu, passes(steps) + rivals_passes);
        if self.plan.variant.extras.counting {
            recorder = recorder.counting_draws(gpu, rivals_passes);
        }
        let mut copies = Copies::new(readback(gpu, STATUS_BYTES * self.resident.job_count().max(1) as u64));
        let mut groups = self.bind_groups.lock().unwrap_or_else(PoisonError::into_inner);
        groups.rewind();
        for step in steps {
            self.encode(&mut recorder, step, &mut copies, &mut groups)?;
        }
        let recorded = recorder.submit(gpu)?;
        self.resident.needs_aim.store(false, Ordering::Relaxed);
        Ok((copies, recorded))
    }

    fn encode(&self, recorder: &mut Recorder, step: &Step, copies: &mut Copies, groups: &mut BindGroups) -> Result<()> {
        let (gpu, resident) = (&*self.gpu, &self.resident);
        match step {
            Step::Pass { name, at, dispatches } => {
                let mut pass = recorder.compute(name);
                self.stages_of(at.bounce).encode(gpu, &mut pass, &self.scopes(*at), dispatches, groups)?;
            }
            Step::Clear { buffer, at, from, bytes } => {
                if let Some(buffer) = self.scopes(*at).iter().find_map(|s| s.get(buffer)) {
                    recorder.encoder.clear_buffer(buffer, *from, *bytes);
                }
            }
            Step::Count { at, first, count } => {
                let (from, bytes) = (4 * u64::from(*first), 4 * u64::from(*count));
                if let (Some(counters), Some(job)) = (resident.shared.get("counters"), self.job(*at)) {
                    let to = STATUS_BYTES * job.index as u64 + from;
                    recorder.encoder.copy_buffer_to_buffer(counters, from, &copies.status, to, bytes);
                }
            }
            Step::Rival { band } => {
                if let Some(rival) = &self.rival {
                    rival.encode(gpu, recorder, &self.target(*band))?;
                }
            }
            Step::Keep { band } => self.keep(recorder, *band),
            Step::Read { band } => self.read(recorder, *band, copies),
        }
        Ok(())
    }

    fn job(&self, at: StepScope) -> Option<Job<'_>> {
        self.resident.job(at.band, at.bounce, at.job)
    }

    /// Where a step finds its buffers, the innermost scope first.
    fn scopes(&self, at: StepScope) -> Vec<&Buffers> {
        let resident = &self.resident;
        let mut scopes = Vec::new();
        if let (Some(bounce), Some(tables)) = (at.into, &resident.bounce_tables) {
            scopes.extend([tables.uniforms(bounce), tables.target(resident.bounces[bounce].count)]);
        }
        match self.job(at) {
            Some(job) => scopes.extend(resident.scopes(&job, at.band, at.bounce)),
            None => scopes.push(&resident.shared),
        }
        scopes.extend(self.caustics.as_ref().map(|c| &c.buffers));
        scopes
    }

    /// The kernels of a bounce.
    fn stages_of(&self, bounce: usize) -> &Stages {
        self.after_bounce.as_ref().filter(|_| self.resident.bounces[bounce].count > 0).unwrap_or(&self.stages)
    }

    fn pixels(&self, band: usize) -> u32 {
        self.plan.bands[band].rows * self.camera.width
    }

    /// A band as rivals see it.
    fn target(&self, band: usize) -> Target<'_> {
        let resident = &self.resident;
        let chunks = resident
            .jobs(band, 0)
            .step_by(resident.batches as usize)
            .map(|job| ChunkScopes { scopes: resident.scopes(&job, band, 0), slots: job.chunk.slots });
        Target { rows: self.plan.bands[band].rows, chunks: chunks.collect() }
    }

    /// Copies a band's planes, and what else is wanted, to where the host reads them.
    fn read(&self, recorder: &mut Recorder, band: usize, copies: &mut Copies) {
        let (gpu, shared) = (&*self.gpu, &self.resident.shared);
        let plane = 4 * u64::from(self.pixels(band));
        let planes = self.plan.planes.iter().enumerate();
        let wanted: Vec<u64> =
            planes.filter(|(_, channel)| is_read(&self.wanted, **channel)).map(|(k, _)| k as u64).collect();
        let to = readback(gpu, plane * wanted.len() as u64);
        for (n, k) in (0u64..).zip(wanted) {
            if let Some(planes) = shared.get("planes") {
                recorder.encoder.copy_buffer_to_buffer(planes, k * plane, &to, n * plane, plane);
            }
        }
        copies.planes.push(to);
        let mut copy = |name: &str, bytes: u64| {
            let to = readback(gpu, bytes);
            if let Some(from) = shared.get(name) {
                recorder.encoder.copy_buffer_to_buffer(from, 0, &to, 0, bytes);
            }
            to
        };
        if self.wanted.srgb8 {
            copies.srgb8.push(copy("srgb8", plane));
        }
        if let (true, Some(records)) = (self.wanted.sample_ids, shared.get("samples")) {
            copies.edge_of.push(copy("edge_of", plane));
            copies.samples.push(copy("samples", records.size()));
        }
    }

    /// Copies a band's planes to where they are kept.
    fn keep(&self, recorder: &mut Recorder, band: usize) {
        let (Some(kept), Some(planes)) = (&self.planes_copy, self.resident.shared.get("planes")) else { return };
        let whole = 4 * u64::from(self.camera.width) * u64::from(self.camera.height);
        let own = 4 * u64::from(self.pixels(band));
        let row = 4 * u64::from(self.camera.width) * u64::from(self.plan.bands[band].row);
        for k in 0..self.plan.planes.len() as u64 {
            recorder.encoder.copy_buffer_to_buffer(planes, k * own, kept, k * whole + row, own);
        }
    }
}
