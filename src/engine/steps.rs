//! A frame as data: the list of its steps, made by a pure function of the plan and of how its lists are split. [`super::encode`]
//! goes through it.

use super::bounces::Bounce;
use super::changes::Dirty;
use super::stage::aim::aim;
use super::stage::bin::bin;
use super::stage::bounce::bounce;
use super::stage::certify::{CERTIFY_STEPS, certify, certify_traced, write_certified};
use super::stage::cull::cull;
use super::stage::edges::{edges, edges_by_tile, find_edges, list_edges};
use super::stage::fit::fit;
use super::stage::forget::forget;
use super::stage::gather::gather;
use super::stage::meet::meet;
use super::stage::outline::outline;
use super::stage::paste::paste;
use super::stage::raster::{raster, raster_steps};
use super::stage::reach::reach;
use super::stage::recheck::recheck;
use super::stage::resolve::resolve;
use super::stage::sample::{sample, sample_by_tile};
use super::stage::shade::shade;
use super::stage::small::small;
use super::stage::sort::sort;
use super::stage::split::split;
use super::stage::trace::{take_over, trace};
use super::stage::volume::volume;
use super::stage::write::write;
use super::stage::{Dispatch, Pixels};
use crate::arrays::MapEach;
use crate::camera::TILE;
use crate::engine::plan::Plan;
use crate::gpu::kernels::{Method, OpticsKind, Variant};
use crate::gpu::layout::{COUNTERS, Counter};
use crate::image::frame::Channel;

/// What determines the steps of a frame.
#[derive(Debug, Clone)]
pub struct FrameInputs<'a> {
    pub plan: &'a Plan,
    pub bounces: &'a [Bounce],
    /// Clusters of each job over a band: batch by batch of each chunk of triangles.
    pub jobs: Vec<u32>,
    /// Batches of a chunk.
    pub batches: usize,
    /// As [`super::resident::Resident::raster_rounds`].
    pub raster_rounds: u32,
    /// As [`super::resident::Resident::samples_by_tile`].
    pub samples_by_tile: bool,
    /// Raster is left out where there is trace too.
    pub prefers_trace: bool,
    /// The rays of viewers that turn, or the bounds on these, are not there yet.
    pub aims: bool,
    /// A rival finds what is seen.
    pub by_rival: bool,
    /// Caustics are added.
    pub gathers: bool,
    /// Planes are kept on the device.
    pub keeps: bool,
    /// Planes go to the host.
    pub reads: bool,
}

/// The band, bounce and job whose buffers a step uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StepScope {
    pub band: usize,
    /// By its number in [`FrameInputs::bounces`].
    pub bounce: usize,
    /// By its number in [`FrameInputs::jobs`].
    pub job: usize,
    /// The bounce whose rays are written.
    pub into: Option<usize>,
}

/// A step of a frame, in the order of the list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Step {
    /// A compute pass.
    Pass { name: &'static str, at: StepScope, dispatches: Vec<Dispatch> },
    /// A buffer becomes 0, from a byte on.
    Clear { buffer: &'static str, at: StepScope, from: u64, bytes: Option<u64> },
    /// So many counters go to the host, to the job's part of them.
    Count { at: StepScope, first: u32, count: u32 },
    /// The passes of a rival.
    Rival { band: usize },
    /// The planes go to where they are kept.
    Keep { band: usize },
    /// The planes and what else is wanted go to the host.
    Read { band: usize },
}

/// The steps of a frame that shows what is dirty.
pub fn steps(inputs: &FrameInputs, dirty: Dirty) -> Vec<Step> {
    let mut list = StepList { inputs, steps: Vec::new() };
    for band in 0..inputs.plan.bands.len() {
        list.add_band(band, dirty);
    }
    list.steps
}

/// How many compute passes there are.
pub fn passes(steps: &[Step]) -> u32 {
    steps.iter().filter(|s| matches!(s, Step::Pass { .. })).count() as u32
}

impl FrameInputs<'_> {
    /// The kernels of a bounce.
    pub fn variant(&self, bounce: usize) -> Variant {
        let own = self.plan.variant;
        if self.bounces[bounce].count > 0 { own.after_bounce() } else { own }
    }

    /// One job has all triangles, whose lists stay until they are needed again.
    fn is_alone(&self) -> bool {
        self.jobs.iter().filter(|clusters| **clusters > 0).count() == 1
    }

    fn pixels(&self, band: usize) -> u32 {
        self.plan.bands[band].rows * self.plan.width
    }

    /// The pixels that may have a ray.
    fn rays(&self, at: StepScope) -> Pixels {
        if self.bounces[at.bounce].count > 0 { Pixels::Live } else { Pixels::Every(self.pixels(at.band)) }
    }

    /// The same, by tiles of one slab.
    fn traced(&self, at: StepScope) -> Pixels {
        match self.rays(at) {
            Pixels::Live => Pixels::Live,
            Pixels::Every(_) => {
                let band = &self.plan.bands[at.band];
                Pixels::Every(TILE * TILE * band.tiles.tiles_x * band.rows.div_ceil(TILE))
            }
        }
    }

    /// Over all slabs.
    fn tiles(&self, band: usize) -> u32 {
        let tiles = &self.plan.bands[band].tiles;
        tiles.tiles_x * tiles.tiles_y
    }
}

struct StepList<'a> {
    inputs: &'a FrameInputs<'a>,
    steps: Vec<Step>,
}

impl StepList<'_> {
    fn add_band(&mut self, band: usize, dirty: Dirty) {
        let inputs = self.inputs;
        let variant = inputs.plan.variant;
        let first = StepScope { band, bounce: 0, job: 0, into: None };
        let pixels = inputs.pixels(band);
        let has_jobs = !inputs.jobs.is_empty();
        if let Some(turned) = inputs.plan.bands[band].turned.as_ref().filter(|_| inputs.aims) {
            let dispatches = aim(turned, variant);
            if !dispatches.is_empty() {
                self.pass("aim", first, dispatches);
            }
        }
        if variant.rays.optics.is_some() {
            // what bounces see adds up
            self.clear("planes", first, 0, None);
        }
        if variant.bounces_rays() && has_jobs {
            self.clear("live", first, 0, None);
            self.pass("reach", first, [reach(inputs.tiles(band))]);
        }
        for bounce in 0..inputs.bounces.len() {
            let at = StepScope { bounce, ..first };
            if inputs.bounces[bounce].count > 0 && has_jobs {
                self.add_bounce(at);
            }
            if dirty == Dirty::All {
                self.add_visibility(at);
                if inputs.variant(bounce).samples_edges() && has_jobs {
                    self.add_samples(at);
                }
                if inputs.plan.planes.contains(&Channel::Certified) {
                    self.add_proofs(at);
                }
            }
            self.add_planes(at);
        }
        if has_jobs {
            if variant.optics() == Some(OpticsKind::Atlas) {
                self.pass("paste", first, [paste(pixels)]);
            }
            if variant.extras.outlined {
                self.pass("outline", first, [outline(pixels)]);
            }
            if variant.extras.volume.is_some() {
                self.pass("volume", first, [volume(pixels)]);
            }
            if inputs.plan.srgb8 && !variant.extras.writes {
                self.pass("write", first, [write(pixels)]);
            }
        }
        self.steps.extend(inputs.keeps.then_some(Step::Keep { band }));
        self.steps.extend(inputs.reads.then_some(Step::Read { band }));
    }

    fn pass(&mut self, name: &'static str, at: StepScope, dispatches: impl Into<Vec<Dispatch>>) {
        self.steps.push(Step::Pass { name, at, dispatches: dispatches.into() });
    }

    fn clear(&mut self, buffer: &'static str, at: StepScope, from: u64, bytes: Option<u64>) {
        self.steps.push(Step::Clear { buffer, at, from, bytes });
    }

    /// Reflects or refracts the rays that meet the optics, for a bounce, and bounds the rays after it.
    fn add_bounce(&mut self, at: StepScope) {
        let inputs = self.inputs;
        let count = inputs.bounces[at.bounce].count;
        let Some(before) = inputs.bounces[..at.bounce].iter().rposition(|b| b.count + 1 == count) else { return };
        let from = StepScope { bounce: before, into: Some(at.bounce), ..at };
        self.pass("forget", from, [forget()]);
        self.clear("bounced_live", from, 0, None);
        self.pass("bounce", from, [bounce()]);
        if inputs.variant(at.bounce).rasters() {
            self.pass("fit", at, fit(&inputs.plan.bands[at.band].nodes.levels));
        }
    }

    /// Those that have clusters.
    fn jobs(&self, at: StepScope) -> impl Iterator<Item = StepScope> + use<> {
        let full: Vec<usize> = (0..self.inputs.jobs.len()).filter(|&job| self.inputs.jobs[job] > 0).collect();
        full.into_iter().map(move |job| StepScope { job, ..at })
    }

    /// A job of every chunk: the batches of one share its ids.
    fn chunks(&self, at: StepScope) -> impl Iterator<Item = StepScope> + use<> {
        (0..self.inputs.jobs.len()).step_by(self.inputs.batches).map(move |job| StepScope { job, ..at })
    }

    /// Fills the visibility buffer with what rays meet: cull to recheck of every job, and what is no triangle.
    fn add_visibility(&mut self, at: StepScope) {
        let inputs = self.inputs;
        let (pixels, variant, alone) = (inputs.pixels(at.band), inputs.variant(at.bounce), inputs.is_alone());
        if !inputs.jobs.is_empty() {
            self.clear("visibility", at, 0, Some(8 * u64::from(pixels)));
            self.clear("counters", at, counter_at(PERSISTENT_FROM), None);
        }
        if inputs.by_rival {
            self.steps.push(Step::Rival { band: at.band });
            return;
        }
        let method = match variant.method() {
            Method::Auto if inputs.prefers_trace => Method::Trace,
            method => method,
        };
        for step in 0..raster_steps(variant) {
            for at in self.jobs(at) {
                if step > 0 && alone && variant.leaves_all_to_recheck() {
                    // its items are still there
                    self.pass("recheck", at, [recheck(step)]);
                    continue;
                }
                if step > 0 && alone {
                    // its pairs are still there, and it leaves its items to recheck again
                    self.clear("counters", at, counter_at(Counter::RecheckItems), Some(4));
                } else if method != Method::Trace {
                    self.add_pairs(at);
                } else {
                    self.clear("counters", at, 0, Some(counter_at(PERSISTENT_FROM)));
                }
                match method {
                    Method::Raster => self.pass("raster", at, raster(variant, step, inputs.raster_rounds)),
                    Method::Trace => self.pass("trace", at, [trace(inputs.traced(at), step)]),
                    Method::Auto => {
                        self.pass("raster", at, raster(variant, step, inputs.raster_rounds));
                        self.pass("trace", at, [take_over(step)]);
                    }
                }
                if variant.rechecks() {
                    self.pass("recheck", at, [recheck(step)]);
                }
                if step == 0 {
                    self.steps.push(Step::Count { at, first: 0, count: COUNTERS });
                }
            }
            if variant.meets() && !inputs.jobs.is_empty() {
                self.pass("meet", at, [meet(step)]);
            }
        }
    }

    /// Draws the small triangles of a job, where there is `small`, and lists the pairs of the others: cull to sort.
    fn add_pairs(&mut self, at: StepScope) {
        let inputs = self.inputs;
        let variant = inputs.variant(at.bounce);
        self.clear("counters", at, 0, Some(counter_at(PERSISTENT_FROM)));
        if variant.by_tile() {
            self.clear("ends", at, 0, None);
        }
        // where bounced rays are discontinuous is not known beforehand
        let nodes = &inputs.plan.bands[at.band].nodes;
        let steps = if variant.is_bounced() { nodes.levels.len() as u32 } else { nodes.cull_steps() };
        self.pass("cull", at, cull(inputs.jobs[at.job], steps));
        self.pass("split", at, [split()]);
        if variant.draws_small() {
            self.pass("small", at, [small()]);
        }
        self.pass("bin", at, [bin(variant)]);
        if variant.by_tile() {
            self.pass("sort", at, sort(inputs.tiles(at.band)));
        }
    }

    /// Finds the edge pixels of a visibility buffer that is complete, and what their samples see.
    fn add_samples(&mut self, at: StepScope) {
        let inputs = self.inputs;
        let (pixels, alone) = (inputs.pixels(at.band), inputs.is_alone());
        let count = |counter: Counter| Step::Count { at, first: counter.index(), count: 1 };
        if inputs.by_rival {
            // it has listed them
            self.steps.push(count(Counter::Edges));
            return;
        }
        if alone && inputs.samples_by_tile {
            self.clear("edge_of", at, 0, None);
            for job in self.jobs(at) {
                self.pass("edges", job, [edges_by_tile(inputs.tiles(at.band))]);
                self.pass("sample", job, sample_by_tile());
                self.steps.extend([Counter::Edges, Counter::RecheckSamples].map_each(count));
            }
            return;
        }
        self.clear("samples", at, 0, None);
        for chunk in self.chunks(at) {
            self.pass("edges", chunk, [find_edges(pixels)]);
        }
        for job in self.jobs(at) {
            if !alone {
                self.add_pairs(job);
            }
            self.pass("edges", job, [edges()]);
        }
        self.pass("edges", at, [list_edges(pixels)]);
        self.steps.push(count(Counter::Edges));
        for step in 0..raster_steps(inputs.variant(at.bounce)) {
            for job in self.jobs(at) {
                if !alone {
                    self.add_pairs(job);
                }
                self.pass("sample", job, [sample(step)]);
            }
        }
    }

    /// Finds what is proven of a visibility buffer that is complete.
    fn add_proofs(&mut self, at: StepScope) {
        let inputs = self.inputs;
        self.clear("proofs", at, 0, None);
        for step in 0..CERTIFY_STEPS {
            for job in self.jobs(at) {
                if inputs.variant(at.bounce).has_round() {
                    self.pass("certify", job, [certify_traced(inputs.traced(job), step)]);
                    continue;
                }
                if !inputs.is_alone() {
                    self.add_pairs(job);
                }
                self.pass("certify", job, [certify(step)]);
            }
        }
        if !inputs.jobs.is_empty() {
            self.pass("certify", at, [write_certified(inputs.pixels(at.band))]);
        }
    }

    /// Writes the planes where rays end in a bounce.
    fn add_planes(&mut self, at: StepScope) {
        let inputs = self.inputs;
        let pixels = inputs.pixels(at.band);
        for chunk in self.chunks(at) {
            self.pass("shade", chunk, [shade(inputs.rays(at))]);
        }
        // once all chunks have written what centres see
        if inputs.variant(at.bounce).samples_edges() {
            for chunk in self.chunks(at) {
                self.pass("resolve", chunk, [resolve()]);
            }
        }
        // where on a receiver a hit lies is known of the rays that say what is seen
        if inputs.gathers && inputs.bounces[at.bounce].is_main && !inputs.jobs.is_empty() {
            self.pass("gather", at, [gather(pixels)]);
        }
    }
}

/// The first of the counters that keep their values while pairs are listed again.
const PERSISTENT_FROM: Counter = Counter::Edges;

/// Where a counter lies, bytes.
fn counter_at(counter: Counter) -> u64 {
    4 * u64::from(counter.index())
}
