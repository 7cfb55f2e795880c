//! The one way to run a frame: submit its steps, read its counters, and repeat it with larger lists if these were too small.

use super::call_ms::ms_since;
use super::changes::Dirty;
use super::frames::Frames;
use super::planned::Planned;
use super::readback::{Copies, InFlight, PendingReads, Readback};
use super::resident::BvhState;
use super::{Capacities, Counts, Rendered, RunOptions};
use crate::engine::plan::Plan;
use crate::engine::plan::variant::method;
use crate::gpu::buffers::wait_for;
use crate::gpu::kernels::Method;
use crate::gpu::layout::{COUNTERS, CULL_QUEUES, Counter};
use crate::gpu::readback::read_words;
use crate::gpu::recorder::Recorded;
use crate::input::{Error, Result};
use std::time::Instant;

/// A submitted frame, and the sizes of its lists.
pub(super) struct Running {
    pub copies: Copies,
    pub recorded: Recorded,
    capacities: Capacities,
    raster_rounds: u32,
    /// The hierarchies when it was submitted: a later frame may have built them.
    bvh: BvhState,
    /// Cost of hierarchies that would have followed the triangles that moved before this frame; 0 if the hierarchies are there.
    fit_cost: u64,
    /// Time that its kernels took to compile, ms.
    pub(super) compile_ms: f64,
    started: Instant,
}

impl Frames {
    /// Submits the steps that draw what is dirty. With `reads`, they copy the picture to where the host can read it.
    pub(super) fn begin(&self, dirty: Dirty, reads: bool) -> Result<Running> {
        if self.is_partly_uploaded {
            return Err(Error::work("an earlier change of these frames failed; call Engine::prepare again"));
        }
        if self.resident.cannot_trace() {
            return Err(self.not_traced());
        }
        let steps = self.steps(reads, dirty);
        let compiling = Instant::now();
        self.compile(&steps)?;
        let compile_ms = ms_since(compiling);
        let started = Instant::now();
        let (copies, recorded) = self.submit(&steps)?;
        let (capacities, raster_rounds) = (self.resident.capacities, self.resident.raster_rounds);
        let (bvh, fit_cost) = (self.resident.bvh, self.fit_cost);
        Ok(Running { copies, recorded, capacities, raster_rounds, bvh, fit_cost, compile_ms, started })
    }

    /// Submits a whole frame of `planned`, which is shown, and returns without waiting for it.
    pub(super) fn start(&self, planned: Planned) -> Result<InFlight> {
        let running = self.begin(Dirty::All, true)?;
        let reads = PendingReads::start(&running);
        Ok(InFlight { started: running.started, planned, running, reads, frame_layout: self.frame_layout() })
    }

    /// Waits for a frame, even if another scene is shown by now. If the lists between the stages were too small, the frame
    /// runs again with larger ones.
    pub(super) fn wait_for(&mut self, mut in_flight: InFlight) -> Result<Readback> {
        let (mut grown, mut call) = (0, in_flight.planned.call);
        loop {
            let InFlight { planned, running, reads, frame_layout, .. } = in_flight;
            wait_for(&self.gpu, &running.recorded.submission)?;
            call.compile += running.compile_ms;
            call.wait += running.ms();
            let reading = Instant::now();
            let raw = reads.finish(&self.gpu, &running)?;
            call.read_back += ms_since(reading);
            let Some(short) = self.shortage(&raw.status, &running, frame_layout.plan.variant.by_tile()) else {
                self.note_method(&frame_layout.plan, running.bvh, &Counts::of(&raw.status));
                let (frame_ms, stages) = (vec![running.ms()], raw.stages.clone());
                let rest =
                    Rendered { frame_ms, call, stages, grown, ..self.statistics(&frame_layout.plan, &running, &raw) };
                self.weigh_tracing(&frame_layout.plan, &running, &rest.counts)?;
                return Ok(Readback { frame_layout, raw, rest });
            };
            let growing = Instant::now();
            // raster that was stopped counts as a cost, too
            self.weigh_tracing(&planned.plan, &running, &Counts::of(&raw.status))?;
            // the lists are to hold this frame
            if !self.show_by(&planned, false)? {
                return Err(Error::work("a frame cannot be shown again"));
            }
            self.grow_lists(short)?;
            call.upload += ms_since(growing);
            grown += 1;
            in_flight = self.start(planned)?;
        }
    }

    /// Notes whether trace took a frame over from raster.
    fn note_method(&mut self, plan: &Plan, bvh: BvhState, counts: &Counts) {
        // a frame that was traced from the start says nothing about raster
        if bvh != BvhState::Preferred {
            let pixels: u64 = plan.bands.iter().map(|band| u64::from(band.rows) * u64::from(plan.width)).sum();
            // of several chunks and bands, trace may take over few
            self.trial.note(2 * counts.taken_over > pixels * self.resident.chunks.len() as u64);
        }
    }

    /// Decides whether the next frame tries raster or is traced from the start. Returns whether the decision changed.
    pub(super) fn choose_method(&mut self) -> bool {
        let is_built = matches!(self.resident.bvh, BvhState::Built | BvhState::Preferred);
        if self.plan.variant.method() != Method::Auto || !is_built {
            return false;
        }
        let next = if self.trial.take_traced() { BvhState::Preferred } else { BvhState::Built };
        std::mem::replace(&mut self.resident.bvh, next) != next
    }

    /// Adds the savings of tracing in a frame that was submitted as `running`. Builds hierarchies, once these savings pay for them.
    fn weigh_tracing(&mut self, plan: &Plan, running: &Running, counts: &Counts) -> Result<()> {
        if self.plan.variant.method() != Method::Auto || self.resident.bvh == BvhState::GivenUp {
            return Ok(());
        }
        let rebuild_cost = self.resident.rebuild_cost();
        if running.bvh != BvhState::Preferred {
            let trace = self.resident.trace_cost(plan);
            let saved = self.resident.raster_cost(counts.raster_cost()).saturating_sub(trace + trace / 8);
            let least = if running.bvh == BvhState::None { rebuild_cost } else { 0 };
            self.savings.note(saved, (counts.taken_over > 0).then_some(least));
        }
        self.savings.add(running.fit_cost, rebuild_cost);
        if self.resident.bvh != BvhState::None || !self.savings.pay(rebuild_cost) {
            return Ok(());
        }
        self.build_bvh()?;
        self.resident.write_params(&self.gpu, &self.camera, &self.plan)
    }

    /// Takes the cost of fitting the hierarchies to moved triangles out of what tracing has saved. Returns whether that was enough; rays that are
    /// always traced need the hierarchies whatever they cost.
    pub(super) fn pay_for_fit(&mut self, cost: u64) -> bool {
        let is_built = matches!(self.resident.bvh, BvhState::Built | BvhState::Preferred);
        let has_choice = self.plan.variant.method() == Method::Auto && is_built && !self.resident.always_traces;
        !has_choice || self.savings.pay_for_fit(cost)
    }

    /// The rays of these frames could not be followed to their ends: there is nothing to trace them with, or it took too many steps.
    pub(super) fn is_lost(&self) -> bool {
        self.is_lost || self.resident.cannot_trace()
    }

    fn not_traced(&self) -> Error {
        let by_raster = RunOptions { method: Method::Raster, ..self.run.clone() };
        let (by_raster, _) = method(&self.camera, self.plan.contents, &self.wanted, self.gpu.has, &by_raster);
        let can_raster = self.run.method == Method::Trace && by_raster == Method::Raster;
        let remedy = if can_raster { "; use --method raster" } else { "" };
        Error::work(format!("tracing takes too many steps here{remedy}"))
    }

    /// Enlarges the lists if they were too small for a finished frame. Returns whether they were large enough.
    pub(super) fn fits(&mut self, running: &Running) -> Result<bool> {
        let status = read_words(&self.gpu, &running.copies.status)?;
        // of lists that were cut off nothing is learnt
        if running.bvh != BvhState::Preferred {
            self.timed.raster_cost = Counts::of(&status).raster_cost();
        }
        match self.shortage(&status, running, self.plan.variant.by_tile()) {
            Some(short) => self.grow_lists(short).map(|()| false),
            None => Ok(true),
        }
    }

    /// The list sizes that a frame needed, by its counters, if it did not have them. `by_tile`: its raster went so.
    fn shortage(&self, status: &[u32], running: &Running, by_tile: bool) -> Option<Shortage> {
        let have = running.capacities;
        let is_set = |job: &[u32], counter: Counter| job[counter.index() as usize] > 0;
        let jobs = || status.chunks_exact(COUNTERS as usize);
        // where trace took over, raster's own lists may have run over
        let matters = |job: &[u32], index: u32| {
            index >= Counter::Edges.index() || index == Counter::RecheckItems.index() || !is_set(job, Counter::Traced)
        };
        let most =
            |index: u32| jobs().filter(|job| matters(job, index)).map(|s| s[index as usize]).max().unwrap_or(0) as u64;
        let most_of = |counter: Counter| most(counter.index());
        let need = Capacities {
            queue: (0..CULL_QUEUES).map(most).max().unwrap_or(0),
            work: most_of(Counter::Work),
            tasks: most_of(Counter::Tasks),
            pairs: most_of(Counter::Pairs).max(most_of(Counter::Large)),
            recheck_items: most_of(Counter::RecheckItems).max(2 * most_of(Counter::RecheckSamples)),
            edges: most_of(Counter::Edges),
        };
        let fits =
            need.queue <= have.queue && need.work <= have.work && need.tasks <= have.tasks && need.pairs <= have.pairs;
        let is_left = |job: &[u32]| {
            !is_set(job, Counter::Traced)
                && job[Counter::Busy.index() as usize] > job[Counter::BusyEnd.index() as usize]
        };
        let is_done = !by_tile || !jobs().any(is_left);
        let needs_bvh = running.bvh == BvhState::None && jobs().any(|job| is_set(job, Counter::Traced));
        let has_all = fits && need.recheck_items <= have.recheck_items && need.edges <= have.edges && is_done;
        let is_lost = jobs().any(|job| is_set(job, Counter::Unfinished));
        let rounds = (!is_done).then_some(2 * running.raster_rounds);
        (!has_all || needs_bvh || is_lost).then_some(Shortage { need, rounds, needs_bvh, is_lost })
    }

    fn grow_lists(&mut self, short: Shortage) -> Result<()> {
        self.timed.grown += 1;
        if short.is_lost {
            if self.plan.variant.method() != Method::Auto || self.plan.variant.bounces_rays() {
                self.is_lost = true;
                return Err(self.not_traced());
            }
            self.resident.bvh = BvhState::GivenUp;
        }
        if short.needs_bvh && self.resident.bvh == BvhState::None {
            self.build_bvh()?;
        }
        if let Some(rounds) = short.rounds {
            self.resident.raster_rounds = self.resident.raster_rounds.max(rounds);
        }
        // they hold the lists that are to be replaced
        self.bind_groups = Default::default();
        self.resident.grow(&self.gpu, &self.camera, &self.plan, short.need)
    }
}

/// Costs that tracing has saved over raster along a path, and has not spent on hierarchies yet.
#[derive(Debug, Default)]
pub struct Savings {
    total: i64,
    /// Saved in a frame, by the last one in which raster was tried.
    a_frame: i64,
}

impl Savings {
    /// Notes what tracing saves in a frame in which raster was tried. Where trace took over, raster was stopped before all of its cost was known,
    /// and tracing saves `stopped` at least.
    fn note(&mut self, saved: u64, stopped: Option<u64>) {
        let saved = saved as i64;
        self.a_frame = stopped.map_or(saved, |least| self.a_frame.max(saved).max(least as i64));
    }

    /// Adds a frame, less `fit_cost` if that was not paid before. A scene that stands still does not save up for more than new hierarchies.
    fn add(&mut self, fit_cost: u64, rebuild_cost: u64) {
        self.total = (self.total + self.a_frame - fit_cost as i64).clamp(0, rebuild_cost as i64);
    }

    /// Pays for new hierarchies, if enough was saved.
    fn pay(&mut self, cost: u64) -> bool {
        let is_enough = self.total >= cost as i64;
        if is_enough {
            self.total = 0;
        }
        is_enough
    }

    /// Pays for fitting hierarchies to moved triangles, on credit of the coming frame. If that is not enough, nothing is saved any more.
    fn pay_for_fit(&mut self, cost: u64) -> bool {
        self.total -= cost as i64;
        let is_enough = self.total + self.a_frame >= 0;
        if !is_enough {
            self.total = 0;
        }
        is_enough
    }
}

/// When raster is tried again in frames that trace took over: after one frame, then after twice as many as the last time.
#[derive(Debug, Default)]
pub struct RasterTrial {
    /// Frames still to be traced before the next trial.
    left: u32,
    /// Frames to trace after the last trial; 0 if raster was not stopped in it.
    traced: u32,
}

/// Frames of a path that are traced between two trials of raster, at most.
const TRACED_MAX: u32 = 16;

impl RasterTrial {
    /// Notes a frame in which raster was tried.
    fn note(&mut self, is_traced: bool) {
        self.traced = if is_traced { (2 * self.traced).clamp(1, TRACED_MAX) } else { 0 };
        self.left = self.traced;
    }

    /// Takes one of the frames to trace before the next trial, if there is one.
    fn take_traced(&mut self) -> bool {
        let is_traced = self.left > 0;
        self.left = self.left.saturating_sub(1);
        is_traced
    }

    /// Whether raster was stopped in the last trial.
    pub fn was_in_vain(&self) -> bool {
        self.traced > 0
    }
}

impl Running {
    /// Time since the submission, ms.
    pub(super) fn ms(&self) -> f64 {
        ms_since(self.started)
    }
}

/// The list sizes that a frame needed.
struct Shortage {
    need: Capacities,
    /// Rounds of raster over the busy tiles, if it left some.
    rounds: Option<u32>,
    /// Trace took over, and has no hierarchy yet.
    needs_bvh: bool,
    /// Trace did not follow all paths to their ends.
    is_lost: bool,
}

#[cfg(test)]
mod tests {
    use super::Savings;

    /// Whether hierarchies are built within 1,000 frames that each would save so much.
    fn is_built(saved: u64, fit_cost: u64) -> bool {
        let mut savings = Savings::default();
        (0..1000).any(|_| {
            savings.note(saved, None);
            savings.add(fit_cost, 50);
            savings.pay(50)
        })
    }

    /// Whether hierarchies are kept for 1,000 frames before each of which triangles move.
    fn is_kept(saved: u64, fit_cost: u64) -> bool {
        let mut savings = Savings::default();
        savings.note(saved, None);
        (0..1000).all(|_| {
            let is_kept = savings.pay_for_fit(fit_cost);
            savings.add(0, 50);
            is_kept
        })
    }

    #[test]
    fn hierarchies_are_kept_while_tracing_saves_what_fitting_them_costs() {
        assert!(is_built(1, 0) && !is_built(0, 0));
        assert!(is_built(13, 12) && !is_built(12, 12));
        assert!(is_kept(12, 12) && !is_kept(12, 13));
        // frames between two moves pay together, yet not for more than new hierarchies and the next frame
        let mut savings = Savings::default();
        savings.note(10, None);
        for (cost, is_kept) in [(60, true), (61, false)] {
            (0..100).for_each(|_| savings.add(0, 50));
            assert_eq!(savings.pay_for_fit(cost), is_kept);
        }
    }

    #[test]
    fn where_raster_was_stopped_tracing_saves_more_than_was_counted() {
        let mut savings = Savings::default();
        savings.note(10, None);
        savings.note(3, Some(0));
        assert_eq!(savings.a_frame, 10);
        savings.note(3, Some(50));
        assert_eq!(savings.a_frame, 50);
        savings.note(3, None);
        assert_eq!(savings.a_frame, 3);
    }
}
