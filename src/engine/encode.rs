//! A frame as one submission: for every band the passes of its rays, each cull, split, bin, raster, recheck and shade of all jobs.

use super::bounces::Bounce;
use super::frames::{Dirty, Frames, Submitted};
use super::readback::is_read;
use super::resident::Job;
use crate::engine::rival::{ChunkScopes, Target};
use crate::engine::stage::Stages;
use crate::engine::stage::certify::CERTIFY_STEPS;
use crate::gpu::buffers::readback;
use crate::gpu::layout::{COUNT_EDGES, COUNT_RECHECK_ITEMS, COUNT_RECHECK_SAMPLES, COUNTERS};
use crate::gpu::recorder::Recorder;
use crate::input::Result;

const STATUS_BYTES: u64 = 4 * COUNTERS as u64;

/// Compute passes of a job and of a pass over a band, at most.
const PASSES_EACH: u32 = 19;

/// And more of them where pixels have samples.
const PASSES_OF_SAMPLES: u32 = 22;

impl Frames {
    /// Encodes and submits the stages of one frame that are to run again; with `read`, also the copies that bring its image to the host.
    pub(super) fn submit(&self, read: bool, dirty: Dirty) -> Result<Submitted> {
        let (gpu, resident) = (&*self.gpu, &self.resident);
        let passes = self.plan.bands.len() * resident.passes.len();
        let by_rival = |band| self.rival.as_ref().map_or(0, |r| r.passes(&self.target(band)));
        let rival: u32 = (0..self.plan.bands.len()).map(by_rival).sum();
        let passes_each = PASSES_EACH + if self.stages.samples_edges() { PASSES_OF_SAMPLES } else { 0 };
        let mut recorder = Recorder::new(gpu, passes_each * (resident.job_count() + passes) as u32 + rival);
        let jobs = resident.job_count().max(1);
        let status = readback(gpu, STATUS_BYTES * jobs as u64);
        let (mut planes, mut srgb8, mut edge_of, mut samples) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (index, band) in self.plan.bands.iter().enumerate() {
            let pixels = band.rows * self.camera.width;
            if let (Some(_), Some(planes)) = (&resident.turns, resident.shared.get("planes")) {
                // what passes share adds up
                recorder.encoder.clear_buffer(planes, 0, None);
            }
            for (pass, Bounce { count: turns, .. }) in resident.passes.iter().enumerate() {
                if *turns > 0 {
                    self.encode_turn(&mut recorder, index, pass)?;
                }
                if dirty == Dirty::All {
                    self.encode_visibility(&mut recorder, &status, index, pass)?;
                    if self.stages_of(pass).samples_edges() {
                        self.encode_samples(&mut recorder, &status, index, pass)?;
                    }
                    if self.stages_of(pass).certifies() {
                        self.encode_proofs(&mut recorder, index, pass)?;
                    }
                }
                self.encode_planes(&mut recorder, index, pass)?;
            }
            if let (true, Some(job)) = (self.stages.pastes(), resident.jobs(index, 0).next()) {
                let mut encoded = recorder.compute("paste");
                self.stages.paste(gpu, &mut encoded, &resident.scopes(&job, index, 0), self.pixels(index))?;
            }
            if let (true, Some(job)) = (self.stages.outlines(), resident.jobs(index, 0).next()) {
                let mut encoded = recorder.compute("outline");
                self.stages.outline(gpu, &mut encoded, &resident.scopes(&job, index, 0), self.pixels(index))?;
            }
            if self.wanted.srgb8 {
                self.encode_srgb(&mut recorder, index)?;
            }
            self.keep(&mut recorder, index);
            if read {
                let own = 4 * u64::from(pixels);
                let wanted = self.read_planes().collect::<Vec<_>>();
                let to = readback(gpu, own * wanted.len() as u64);
                for (n, k) in (0u64..).zip(wanted) {
                    if let Some(planes) = resident.shared.get("planes") {
                        recorder.encoder.copy_buffer_to_buffer(planes, k as u64 * own, &to, n * own, own);
                    }
                }
                planes.push(to);
                let mut copy = |name: &str, bytes: u64| {
                    let to = readback(gpu, bytes);
                    if let Some(from) = resident.shared.get(name) {
                        recorder.encoder.copy_buffer_to_buffer(from, 0, &to, 0, bytes);
                    }
                    to
                };
                if self.wanted.srgb8 {
                    srgb8.push(copy("srgb8", 4 * pixels as u64));
                }
                if let (true, Some(rows)) = (self.wanted.sample_ids, resident.shared.get("samples")) {
                    edge_of.push(copy("edge_of", 4 * pixels as u64));
                    samples.push(copy("samples", rows.size()));
                }
            }
        }
        Ok(Submitted { status, planes, srgb8, edge_of, samples, recorded: recorder.submit(gpu)? })
    }

    /// Which planes are read: those that are wanted, and what samples see that hold no edge.
    fn read_planes(&self) -> impl Iterator<Item = usize> {
        let planes = self.plan.planes.iter().enumerate();
        planes.filter(|(_, channel)| is_read(&self.wanted, **channel)).map(|(k, _)| k)
    }

    /// The kernels of a pass.
    fn stages_of(&self, pass: usize) -> &Stages {
        self.turned.as_ref().filter(|_| self.resident.passes[pass].count > 0).unwrap_or(&self.stages)
    }

    fn pixels(&self, band: usize) -> u32 {
        self.plan.bands[band].rows * self.camera.width
    }

    /// Reflects or refracts the rays of a band that meet the optics, for a bounce, and bounds the rays after it.
    fn encode_turn(&self, recorder: &mut Recorder, band: usize, pass: usize) -> Result<()> {
        let (gpu, resident) = (&*self.gpu, &self.resident);
        let turns = resident.passes[pass].count;
        let Some(before) = resident.passes[..pass].iter().rposition(|p| p.count + 1 == turns) else { return Ok(()) };
        let (Some(own), Some(job)) = (&resident.turns, resident.jobs(band, before).next()) else { return Ok(()) };
        let scopes = [vec![own.pass(pass), own.target(turns)], resident.scopes(&job, band, before)].concat();
        let mut encoded = recorder.compute("bounce");
        self.stages_of(before).bounce(gpu, &mut encoded, &scopes, self.pixels(band))?;
        drop(encoded);
        let Some(job) = resident.jobs(band, pass).next() else { return Ok(()) };
        let mut encoded = recorder.compute("fit");
        let scopes = resident.scopes(&job, band, pass);
        self.stages_of(pass).fit(gpu, &mut encoded, &scopes, &self.plan.bands[band].nodes.levels)
    }

    /// Fills the visibility buffer of a band with what its rays of a pass meet: cull to recheck of every job, and what is no triangle.
    fn encode_visibility(
        &self,
        recorder: &mut Recorder,
        status: &wgpu::Buffer,
        band: usize,
        pass: usize,
    ) -> Result<()> {
        let (gpu, resident, stages) = (&*self.gpu, &self.resident, self.stages_of(pass));
        if let Some(job) = resident.jobs(band, pass).next() {
            let scopes = resident.scopes(&job, band, pass);
            if let Some(visibility) = scopes.iter().find_map(|s| s.get("visibility")) {
                recorder.encoder.clear_buffer(visibility, 0, Some(8 * self.pixels(band) as u64));
            }
            if let Some(counters) = resident.shared.get("counters") {
                recorder.encoder.clear_buffer(counters, 4 * u64::from(COUNT_EDGES), None);
            }
        }
        if let Some(rival) = &self.rival {
            return rival.encode(gpu, recorder, &self.target(band));
        }
        let alone = resident.is_alone(band, pass);
        for step in 0..stages.raster_steps() {
            for job in resident.jobs(band, pass).filter(|j| j.clusters > 0) {
                let scopes = resident.scopes(&job, band, pass);
                // the pairs of a lone job are still there for the second step, which leaves its items to recheck again
                match resident.shared.get("counters") {
                    Some(counters) if step > 0 && alone => {
                        recorder.encoder.clear_buffer(counters, 4 * u64::from(COUNT_RECHECK_ITEMS), Some(4));
                    }
                    _ => self.encode_pairs(recorder, band, pass, &job)?,
                }
                let mut encoded = recorder.compute("raster");
                stages.raster(gpu, &mut encoded, &scopes, step, resident.raster_rounds)?;
                drop(encoded);
                if stages.rechecks() {
                    let mut encoded = recorder.compute("recheck");
                    stages.recheck(gpu, &mut encoded, &scopes, step)?;
                    drop(encoded);
                }
                if let (0, Some(counters)) = (step, resident.shared.get("counters")) {
                    let at = STATUS_BYTES * job.index as u64;
                    recorder.encoder.copy_buffer_to_buffer(counters, 0, status, at, STATUS_BYTES);
                }
            }
            if let (true, Some(job)) = (stages.meets(), resident.jobs(band, pass).next()) {
                let mut encoded = recorder.compute("meet");
                stages.meet(gpu, &mut encoded, &resident.scopes(&job, band, pass), self.pixels(band), step)?;
            }
        }
        Ok(())
    }

    /// Lists the pairs of a job: cull, split, bin and sort.
    fn encode_pairs(&self, recorder: &mut Recorder, band: usize, pass: usize, job: &Job) -> Result<()> {
        let (gpu, resident, stages) = (&*self.gpu, &self.resident, self.stages_of(pass));
        let scopes = resident.scopes(job, band, pass);
        if let Some(counters) = resident.shared.get("counters") {
            recorder.encoder.clear_buffer(counters, 0, Some(4 * u64::from(COUNT_EDGES)));
        }
        if let Some(ends) = resident.shared.get("ends") {
            recorder.encoder.clear_buffer(ends, 0, None);
        }
        // where turned rays are torn is not known beforehand
        let nodes = &self.plan.bands[band].nodes;
        let is_turned = resident.passes[pass].count > 0;
        let steps = if is_turned { nodes.levels.len() as u32 } else { nodes.cull_steps() };
        let mut encoded = recorder.compute("cull");
        stages.cull(gpu, &mut encoded, &scopes, job.clusters, steps)?;
        drop(encoded);
        let mut encoded = recorder.compute("split");
        stages.split(gpu, &mut encoded, &scopes)?;
        drop(encoded);
        let mut encoded = recorder.compute("bin");
        stages.bin(gpu, &mut encoded, &scopes)?;
        drop(encoded);
        if stages.sorts() {
            let mut encoded = recorder.compute("sort");
            let tiles = &self.plan.bands[band].tiles;
            stages.sort(gpu, &mut encoded, &scopes, tiles.tiles_x * tiles.tiles_y)?;
        }
        Ok(())
    }

    /// Finds the pixels of a band that hold an edge, whose visibility buffer is complete, and what their samples see.
    fn encode_samples(&self, recorder: &mut Recorder, status: &wgpu::Buffer, band: usize, pass: usize) -> Result<()> {
        let (gpu, resident, stages) = (&*self.gpu, &self.resident, self.stages_of(pass));
        let pixels = self.pixels(band);
        let (Some(samples), Some(counters)) = (resident.shared.get("samples"), resident.shared.get("counters")) else {
            return Ok(());
        };
        let Some(first) = resident.jobs(band, pass).next() else { return Ok(()) };
        let alone = resident.is_alone(band, pass);
        let at = STATUS_BYTES * first.index as u64;
        let count = |recorder: &mut Recorder, counter: u32| {
            let from = 4 * u64::from(counter);
            recorder.encoder.copy_buffer_to_buffer(counters, from, status, at + from, 4);
        };
        if alone && resident.samples_by_tile(&self.plan) {
            if let Some(edge_of) = resident.shared.get("edge_of") {
                recorder.encoder.clear_buffer(edge_of, 0, None);
            }
            let Some(job) = resident.jobs(band, pass).find(|j| j.clusters > 0) else { return Ok(()) };
            let scopes = resident.scopes(&job, band, pass);
            let tiles = &self.plan.bands[band].tiles;
            let mut encoded = recorder.compute("edges");
            stages.edges_by_tile(gpu, &mut encoded, &scopes, tiles.tiles_x * tiles.tiles_y)?;
            drop(encoded);
            let mut encoded = recorder.compute("sample");
            stages.sample_by_tile(gpu, &mut encoded, &scopes)?;
            drop(encoded);
            count(recorder, COUNT_EDGES);
            count(recorder, COUNT_RECHECK_SAMPLES);
            return Ok(());
        }
        recorder.encoder.clear_buffer(samples, 0, None);
        let jobs = || resident.jobs(band, pass).filter(|j| j.clusters > 0);
        for job in self.chunks(band, pass) {
            let mut encoded = recorder.compute("edges");
            stages.look_for_edges(gpu, &mut encoded, &resident.scopes(&job, band, pass), pixels)?;
        }
        for job in jobs() {
            if !alone {
                self.encode_pairs(recorder, band, pass, &job)?;
            }
            let mut encoded = recorder.compute("edges");
            stages.edges(gpu, &mut encoded, &resident.scopes(&job, band, pass))?;
        }
        let mut encoded = recorder.compute("edges");
        stages.list_edges(gpu, &mut encoded, &resident.scopes(&first, band, pass), pixels)?;
        drop(encoded);
        count(recorder, COUNT_EDGES);
        for step in 0..stages.raster_steps() {
            for job in jobs() {
                if !alone {
                    self.encode_pairs(recorder, band, pass, &job)?;
                }
                let mut encoded = recorder.compute("sample");
                stages.sample(gpu, &mut encoded, &resident.scopes(&job, band, pass), step)?;
            }
        }
        Ok(())
    }

    /// Finds what is proven of the visibility buffer of a band, which is complete.
    fn encode_proofs(&self, recorder: &mut Recorder, band: usize, pass: usize) -> Result<()> {
        let (gpu, resident, stages) = (&*self.gpu, &self.resident, self.stages_of(pass));
        let Some(proofs) = resident.shared.get("proofs") else { return Ok(()) };
        recorder.encoder.clear_buffer(proofs, 0, None);
        let alone = resident.is_alone(band, pass);
        for step in 0..CERTIFY_STEPS {
            for job in resident.jobs(band, pass).filter(|j| j.clusters > 0) {
                if !alone {
                    self.encode_pairs(recorder, band, pass, &job)?;
                }
                let mut encoded = recorder.compute("certify");
                stages.certify(gpu, &mut encoded, &resident.scopes(&job, band, pass), step)?;
            }
        }
        let Some(job) = resident.jobs(band, pass).next() else { return Ok(()) };
        let mut encoded = recorder.compute("certify");
        stages.write_certified(gpu, &mut encoded, &resident.scopes(&job, band, pass), self.pixels(band))
    }

    /// A band as rivals see it.
    fn target(&self, band: usize) -> Target<'_> {
        let resident = &self.resident;
        let chunks = self
            .chunks(band, 0)
            .map(|job| ChunkScopes { scopes: resident.scopes(&job, band, 0), slots: job.chunk.slots });
        Target { rows: self.plan.bands[band].rows, chunks: chunks.collect() }
    }

    /// A job of every chunk: the batches of one share its ids.
    fn chunks(&self, band: usize, pass: usize) -> impl Iterator<Item = Job<'_>> {
        self.resident.jobs(band, pass).step_by(self.resident.batches as usize)
    }

    /// Writes a band's planes where its rays end in a pass.
    fn encode_planes(&self, recorder: &mut Recorder, band: usize, pass: usize) -> Result<()> {
        for job in self.chunks(band, pass) {
            let scopes = self.resident.scopes(&job, band, pass);
            let mut encoded = recorder.compute("shade");
            self.stages_of(pass).shade(&self.gpu, &mut encoded, &scopes, self.pixels(band))?;
        }
        // once all chunks have written what centres see
        if self.stages_of(pass).samples_edges() {
            for job in self.chunks(band, pass) {
                let scopes = self.resident.scopes(&job, band, pass);
                let mut encoded = recorder.compute("resolve");
                self.stages_of(pass).resolve(&self.gpu, &mut encoded, &scopes)?;
            }
        }
        // where on a receiver a hit lies is known of the rays that say what is seen
        let caustics = self.caustics.as_ref().filter(|_| self.resident.passes[pass].is_main);
        if let (Some((lit, gather)), Some(job)) = (caustics, self.resident.jobs(band, pass).next()) {
            let mut scopes = self.resident.scopes(&job, band, pass);
            scopes.push(&lit.buffers);
            let mut encoded = recorder.compute("gather");
            gather.run(&self.gpu, &mut encoded, &scopes, self.pixels(band))?;
        }
        Ok(())
    }

    /// Turns a band's colour planes into sRGB.
    fn encode_srgb(&self, recorder: &mut Recorder, band: usize) -> Result<()> {
        let Some(job) = self.resident.jobs(band, 0).next() else { return Ok(()) };
        let mut pass = recorder.compute("write");
        self.stages.write(&self.gpu, &mut pass, &[job.params, &self.resident.shared], self.pixels(band))
    }

    /// Copies a band's planes to where they are kept.
    fn keep(&self, recorder: &mut Recorder, band: usize) {
        let (Some(kept), Some(planes)) = (&self.kept, self.resident.shared.get("planes")) else { return };
        let whole = 4 * u64::from(self.camera.width) * u64::from(self.camera.height);
        let own = 4 * u64::from(self.pixels(band));
        let row = 4 * u64::from(self.camera.width) * u64::from(self.plan.bands[band].row);
        for k in 0..self.plan.planes.len() as u64 {
            recorder.encoder.copy_buffer_to_buffer(planes, k * own, kept, k * whole + row, own);
        }
    }
}
