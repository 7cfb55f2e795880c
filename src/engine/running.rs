//! How every frame runs: it begins, is done, and what its lists lacked is known; those who wait for it and those who do not.

use super::changes::Dirty;
use super::frames::Frames;
use super::planned::Planned;
use super::readback::{Copies, InFlight, PendingReads, Readback};
use super::{Capacities, Rendered};
use crate::gpu::buffers::{read_words, wait_for};
use crate::gpu::layout::{COUNTERS, CULL_QUEUES, Counter};
use crate::gpu::recorder::Recorded;
use crate::input::{Error, Result};
use std::time::Instant;

/// A frame that the device was given, and how large its lists were.
pub(super) struct Running {
    pub copies: Copies,
    pub recorded: Recorded,
    capacities: Capacities,
    raster_rounds: u32,
    started: Instant,
}

impl Frames {
    /// Gives the device the steps of a frame that show what is dirty, by which every frame runs; with `reads` its picture can be read.
    pub(super) fn begin(&self, dirty: Dirty, reads: bool) -> Result<Running> {
        let steps = self.steps(reads, dirty);
        self.compile(&steps)?;
        let started = Instant::now();
        let (copies, recorded) = self.submit(&steps)?;
        let (capacities, raster_rounds) = (self.resident.capacities, self.resident.raster_rounds);
        Ok(Running { copies, recorded, capacities, raster_rounds, started })
    }

    /// Gives the device a frame of what is shown, by all stages, and does not wait for it.
    pub fn start(&self) -> Result<InFlight> {
        let running = self.begin(Dirty::All, true)?;
        let reads = PendingReads::start(&running);
        Ok(InFlight { started: running.started, running, reads, frame_layout: self.frame_layout() })
    }

    /// Waits for a frame of `planned`, whatever is shown by now. Where the lists between the stages did not hold everything it is shown and
    /// started again with larger ones.
    pub fn recheck_samples(&mut self, planned: &Planned, flight: InFlight) -> Result<Readback> {
        let mut flight = flight;
        loop {
            match self.land(flight)? {
                Ok(landed) => return Ok(landed),
                Err(short) => {
                    // what there is to be room for is this frame's
                    if !self.show(planned)? {
                        return Err(Error::work("a frame cannot be shown again"));
                    }
                    self.make_room(short)?;
                    flight = self.start()?;
                }
            }
        }
    }

    /// Waits for a frame; or what its lists lacked.
    fn land(&mut self, flight: InFlight) -> Result<std::result::Result<Readback, Shortage>> {
        let InFlight { running, reads, frame_layout, .. } = flight;
        wait_for(&self.gpu, &running.recorded.submission)?;
        let words = reads.words(&self.gpu, &running)?;
        if let Some(short) = self.shortage(&words.status, &running) {
            return Ok(Err(short));
        }
        let (frame_ms, stages) = (vec![running.ms()], words.stages.clone());
        let grown = self.timed.grown;
        let rest = Rendered { frame_ms, stages, grown, ..self.took(&frame_layout.plan, &running, &words) };
        Ok(Ok(Readback { frame_layout, words, rest }))
    }

    /// Makes room for what the counters of a frame that is done demanded; whether there was enough.
    pub(super) fn fits(&mut self, running: &Running) -> Result<bool> {
        let status = read_words(&self.gpu, &running.copies.status)?;
        match self.shortage(&status, running) {
            Some(short) => self.make_room(short).map(|()| false),
            None => Ok(true),
        }
    }

    /// What the lists of a frame lacked, by its counters.
    fn shortage(&self, status: &[u32], running: &Running) -> Option<Shortage> {
        let have = running.capacities;
        let most =
            |index: u32| status.chunks_exact(COUNTERS as usize).map(|s| s[index as usize]).max().unwrap_or(0) as u64;
        let most_of = |counter: Counter| most(counter.index());
        let need = Capacities {
            queue: (0..CULL_QUEUES).map(most).max().unwrap_or(0),
            work: most_of(Counter::Work),
            tasks: most_of(Counter::Tasks),
            pairs: most_of(Counter::Pairs),
            recheck_items: most_of(Counter::RecheckItems).max(2 * most_of(Counter::RecheckSamples)),
            edges: most_of(Counter::Edges),
        };
        let fits =
            need.queue <= have.queue && need.work <= have.work && need.tasks <= have.tasks && need.pairs <= have.pairs;
        let is_left = |job: &[u32]| job[Counter::Busy.index() as usize] > job[Counter::BusyEnd.index() as usize];
        let is_done = !self.plan.variant.by_tile || !status.chunks_exact(COUNTERS as usize).any(is_left);
        let has_all = fits && need.recheck_items <= have.recheck_items && need.edges <= have.edges && is_done;
        (!has_all).then_some(Shortage { need, rounds: (!is_done).then_some(2 * running.raster_rounds) })
    }

    fn make_room(&mut self, short: Shortage) -> Result<()> {
        self.timed.grown += 1;
        if let Some(rounds) = short.rounds {
            self.resident.raster_rounds = self.resident.raster_rounds.max(rounds);
        }
        self.resident.grow(&self.gpu, &self.camera, &self.plan, short.need)
    }
}

impl Running {
    /// Since it was given to the device.
    pub(super) fn ms(&self) -> f64 {
        self.started.elapsed().as_secs_f64() * 1e3
    }
}

/// What the lists of a frame lacked.
struct Shortage {
    need: Capacities,
    /// How often raster is to go over the busy tiles, where it left some.
    rounds: Option<u32>,
}
