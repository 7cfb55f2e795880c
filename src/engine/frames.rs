//! Running frames: encode, submit, look at the status, grow and run again, read the image.

use super::illumination::Illuminated;
use super::passes::Pass;
use super::resident::Resident;
use super::{Capacities, Counts, Rendered, RunOptions, join};
use crate::camera::Camera;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::gpu::buffers::{read_words, readback, wait};
use crate::gpu::rows::{
    COUNT_FRAGMENTS_KEPT, COUNT_FRAGMENTS_TESTED, COUNT_PAIRS, COUNT_PAIRS_TESTED, COUNT_RECHECKED, COUNT_WORK,
    COUNTERS,
};
use crate::plan::{LeftOut, Plan, Wanted};
use crate::scene::Scene;
use crate::scene::clusters::cluster;
use crate::stage::Stages;
use crate::stage::gather::Gather;
use glam::{DMat3, DVec3};
use std::time::Instant;

pub(super) struct Frames<'a> {
    pub gpu: &'a Gpu,
    pub stages: &'a Stages,
    /// For rays that were turned.
    pub turned: Option<&'a Stages>,
    pub scene: &'a Scene,
    pub camera: &'a Camera,
    pub plan: &'a Plan,
    pub wanted: &'a Wanted,
    pub resident: Resident,
    /// The scene's caustics, where the frame shows them.
    pub caustics: Option<(&'a Illuminated, &'a Gather)>,
}

/// One submitted frame: its counters by job, its image by band, its stage times.
struct Submitted {
    status: wgpu::Buffer,
    planes: Vec<wgpu::Buffer>,
    srgb8: Vec<wgpu::Buffer>,
    times: Option<StageTimes>,
    passes: u32,
}

/// Timestamps at the start and end of every pass.
struct StageTimes {
    queries: wgpu::QuerySet,
    names: Vec<&'static str>,
    resolved: wgpu::Buffer,
}

/// Timestamps that one query set may hold.
const QUERIES_MAX: u32 = wgpu::QUERY_SET_MAX_QUERIES;
const STATUS_BYTES: u64 = 4 * COUNTERS as u64;

impl Frames<'_> {
    pub fn run(mut self, run: &RunOptions) -> Result<Rendered> {
        let mut grown = 0;
        // the first frame, again until its lists hold everything; its time is that of the last try
        let (first, mut frame_ms) = loop {
            let started = Instant::now();
            let submitted = self.submit(true)?;
            wait(self.gpu)?;
            match self.overflow(&submitted)? {
                Some(need) => self.resident.grow(self.gpu, self.camera, self.plan, need)?,
                None => break (submitted, vec![started.elapsed().as_secs_f64() * 1e3]),
            }
            grown += 1;
        };
        let mut stage_runs = vec![self.stage_ms(&first)?];
        if run.repeat > 0 {
            frame_ms.clear();
            stage_runs.clear();
        }
        let mut k = 0;
        while k < run.repeat {
            let fixed = self.camera.optics.as_ref().map_or(0, |o| o.vertex_count());
            let moved = run.moving.then(|| moved(self.scene, fixed, k + 1));
            let started = Instant::now();
            if let Some(moved) = &moved {
                self.resident
                    .upload_scene(self.gpu, cluster(&moved.mesh, self.plan.anchor, self.gpu.binding_limit()))?;
                self.resident.write_params(self.gpu, self.camera, self.plan)?;
            }
            let submitted = self.submit(false)?;
            wait(self.gpu)?;
            let ms = started.elapsed().as_secs_f64() * 1e3;
            let over = if run.moving { self.overflow(&submitted)? } else { None };
            if let Some(need) = over {
                self.resident.grow(self.gpu, self.camera, self.plan, need)?;
                grown += 1;
                continue;
            }
            frame_ms.push(ms);
            stage_runs.push(self.stage_ms(&submitted)?);
            k += 1;
        }
        self.rendered(first, frame_ms, stage_runs, grown)
    }

    fn rendered(
        self,
        first: Submitted,
        frame_ms: Vec<f64>,
        stage_runs: Vec<Vec<(&'static str, f64)>>,
        grown: u32,
    ) -> Result<Rendered> {
        let bands = first.planes.iter().map(|b| read_words(self.gpu, b)).collect::<Result<Vec<_>>>()?;
        let frame = join(self.camera, self.plan, self.wanted, &bands);
        let mut srgb8 = Vec::new();
        for (buffer, band) in first.srgb8.iter().zip(&self.plan.bands) {
            let words = read_words(self.gpu, buffer)?;
            let pixels = band.rows as usize * self.camera.width as usize;
            srgb8.extend_from_slice(bytemuck::cast_slice(&words[..pixels]));
        }
        let mut left_out = self.plan.left_out.clone();
        if self.resident.without_area > 0 {
            let what = format!("{} triangles", self.resident.without_area);
            left_out.push(LeftOut { what, why: "they have no area".into() });
        }
        Ok(Rendered {
            frame,
            srgb8: self.wanted.srgb8.then_some(srgb8),
            frame_ms,
            stages: medians(stage_runs),
            counts: self.counts(&first)?,
            bytes: self.resident.bytes() + self.caustics.map_or(0, |(lit, _)| lit.buffers.bytes()),
            left_out,
            grown,
            passes: first.passes,
            caustics: self.caustics.map(|(lit, _)| lit.account),
        })
    }

    /// Encodes and submits one frame; with `read`, also the copies that bring its image to the host.
    fn submit(&self, read: bool) -> Result<Submitted> {
        let (gpu, resident) = (self.gpu, &self.resident);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let jobs = resident.job_count().max(1);
        let status = readback(gpu, STATUS_BYTES * jobs as u64);
        let mut submitted =
            Submitted { status, planes: Vec::new(), srgb8: Vec::new(), times: self.stage_times(), passes: 0 };
        for (index, band) in self.plan.bands.iter().enumerate() {
            let pixels = band.rows * self.camera.width;
            if let (Some(_), Some(planes)) = (&resident.turns, resident.shared.get("planes")) {
                // what passes share adds up
                encoder.clear_buffer(planes, 0, None);
            }
            for (pass, Pass { turns, .. }) in resident.passes.iter().enumerate() {
                if *turns > 0 {
                    self.encode_turn(&mut encoder, &mut submitted, index, pass)?;
                }
                self.encode_visibility(&mut encoder, &mut submitted, index, pass)?;
                self.encode_planes(&mut encoder, &mut submitted, index, pass)?;
            }
            if let (true, Some(job)) = (self.stages.pastes(), resident.jobs(index, 0).next()) {
                let mut encoded = submitted.pass(&mut encoder, "paste");
                self.stages.paste(gpu, &mut encoded, &resident.scopes(&job, index, 0), self.pixels(index))?;
            }
            if self.wanted.srgb8 {
                self.encode_srgb(&mut encoder, &mut submitted, index)?;
            }
            if read {
                let copy = |encoder: &mut wgpu::CommandEncoder, name: &str, bytes: u64| {
                    let to = readback(gpu, bytes);
                    if let Some(from) = resident.shared.get(name) {
                        encoder.copy_buffer_to_buffer(from, 0, &to, 0, bytes);
                    }
                    to
                };
                submitted.planes.push(copy(&mut encoder, "planes", 4 * pixels as u64 * self.plan.planes.len() as u64));
                if self.wanted.srgb8 {
                    submitted.srgb8.push(copy(&mut encoder, "srgb8", 4 * pixels as u64));
                }
            }
        }
        if let Some(times) = &submitted.times {
            times.resolve(gpu, &mut encoder);
        }
        gpu.queue.submit([encoder.finish()]);
        gpu.failure()?;
        Ok(submitted)
    }

    /// The kernels of a pass.
    fn stages_of(&self, pass: usize) -> &Stages {
        self.turned.filter(|_| self.resident.passes[pass].turns > 0).unwrap_or(self.stages)
    }

    fn pixels(&self, band: usize) -> u32 {
        self.plan.bands[band].rows * self.camera.width
    }

    /// Turns the rays of a band that meet the optics to those of a pass, and bounds what comes of it.
    fn encode_turn(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        submitted: &mut Submitted,
        band: usize,
        pass: usize,
    ) -> Result<()> {
        let (gpu, resident) = (self.gpu, &self.resident);
        let turns = resident.passes[pass].turns;
        let Some(before) = resident.passes[..pass].iter().rposition(|p| p.turns + 1 == turns) else { return Ok(()) };
        let (Some(own), Some(job)) = (&resident.turns, resident.jobs(band, before).next()) else { return Ok(()) };
        let scopes = [vec![own.pass(pass), own.target(turns)], resident.scopes(&job, band, before)].concat();
        let mut encoded = submitted.pass(encoder, "bounce");
        self.stages_of(before).bounce(gpu, &mut encoded, &scopes, self.pixels(band))?;
        drop(encoded);
        let Some(job) = resident.jobs(band, pass).next() else { return Ok(()) };
        let mut encoded = submitted.pass(encoder, "fit");
        let scopes = resident.scopes(&job, band, pass);
        self.stages_of(pass).fit(gpu, &mut encoded, &scopes, &self.plan.bands[band].nodes.levels)
    }

    /// Fills the visibility buffer of a band with what its rays of a pass meet: cull, bin and raster of every job, and what is
    /// no triangle.
    fn encode_visibility(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        submitted: &mut Submitted,
        band: usize,
        pass: usize,
    ) -> Result<()> {
        let (gpu, resident, stages) = (self.gpu, &self.resident, self.stages_of(pass));
        let is_turned = resident.passes[pass].turns > 0;
        let clear = |encoder: &mut wgpu::CommandEncoder, buffer: Option<&wgpu::Buffer>, bytes: Option<u64>| {
            if let Some(buffer) = buffer {
                encoder.clear_buffer(buffer, 0, bytes);
            }
        };
        if let Some(job) = resident.jobs(band, pass).next() {
            let scopes = resident.scopes(&job, band, pass);
            clear(encoder, scopes.iter().find_map(|s| s.get("visibility")), Some(8 * self.pixels(band) as u64));
        }
        // where turned rays are torn is not known beforehand
        let nodes = &self.plan.bands[band].nodes;
        let steps = if is_turned { nodes.levels.len() as u32 } else { nodes.cull_steps() };
        let alone = resident.jobs(band, pass).filter(|j| j.clusters > 0).count() == 1;
        for step in 0..stages.raster_steps() {
            for job in resident.jobs(band, pass).filter(|j| j.clusters > 0) {
                let scopes = resident.scopes(&job, band, pass);
                // the pairs of a lone job are still there for the second step
                if step == 0 || !alone {
                    clear(encoder, resident.shared.get("counters"), None);
                    let mut encoded = submitted.pass(encoder, "cull");
                    stages.cull(gpu, &mut encoded, &scopes, job.clusters, steps)?;
                    drop(encoded);
                    let mut encoded = submitted.pass(encoder, "bin");
                    stages.bin(gpu, &mut encoded, &scopes)?;
                }
                let mut encoded = submitted.pass(encoder, "raster");
                stages.raster(gpu, &mut encoded, &scopes, step)?;
                drop(encoded);
                if let (0, Some(counters)) = (step, resident.shared.get("counters")) {
                    let at = STATUS_BYTES * job.index as u64;
                    encoder.copy_buffer_to_buffer(counters, 0, &submitted.status, at, STATUS_BYTES);
                }
            }
            if let (true, Some(job)) = (stages.meets(), resident.jobs(band, pass).next()) {
                let mut encoded = submitted.pass(encoder, "meet");
                stages.meet(gpu, &mut encoded, &resident.scopes(&job, band, pass), self.pixels(band), step)?;
            }
        }
        Ok(())
    }

    /// Writes a band's planes where its rays end in a pass.
    fn encode_planes(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        submitted: &mut Submitted,
        band: usize,
        pass: usize,
    ) -> Result<()> {
        let mut shaded = None;
        for job in self.resident.jobs(band, pass) {
            // once a chunk: the batches of one chunk share its ids
            if shaded == Some(job.chunk.id_first) {
                continue;
            }
            shaded = Some(job.chunk.id_first);
            let scopes = self.resident.scopes(&job, band, pass);
            let mut encoded = submitted.pass(encoder, "shade");
            self.stages_of(pass).shade(self.gpu, &mut encoded, &scopes, self.pixels(band))?;
        }
        // where on a receiver a hit lies is known of the rays that say what is seen
        let caustics = self.caustics.filter(|_| self.resident.passes[pass].is_main);
        if let (Some((lit, gather)), Some(job)) = (caustics, self.resident.jobs(band, pass).next()) {
            let mut scopes = self.resident.scopes(&job, band, pass);
            scopes.push(&lit.buffers);
            let mut encoded = submitted.pass(encoder, "gather");
            gather.run(self.gpu, &mut encoded, &scopes, self.pixels(band))?;
        }
        Ok(())
    }

    /// Turns a band's colour planes into sRGB.
    fn encode_srgb(&self, encoder: &mut wgpu::CommandEncoder, submitted: &mut Submitted, band: usize) -> Result<()> {
        let Some(job) = self.resident.jobs(band, 0).next() else { return Ok(()) };
        let mut pass = submitted.pass(encoder, "write");
        self.stages.write(self.gpu, &mut pass, &[job.params, &self.resident.shared], self.pixels(band))
    }

    /// What the lists should hold, where a counter ran over its capacity.
    fn overflow(&self, submitted: &Submitted) -> Result<Option<Capacities>> {
        let words = read_words(self.gpu, &submitted.status)?;
        let most =
            |counter: u32| words.chunks(COUNTERS as usize).map(|s| s[counter as usize]).max().unwrap_or(0) as u64;
        let need = Capacities {
            queue: (0..COUNT_WORK).map(most).max().unwrap_or(0),
            work: most(COUNT_WORK),
            pairs: most(COUNT_PAIRS),
        };
        let have = self.resident.capacities;
        let over = need.queue > have.queue || need.work > have.work || need.pairs > have.pairs;
        Ok(over.then_some(need))
    }

    fn counts(&self, submitted: &Submitted) -> Result<Counts> {
        let words = read_words(self.gpu, &submitted.status)?;
        let sum = |counter: u32| words.chunks(COUNTERS as usize).map(|s| s[counter as usize] as u64).sum();
        Ok(Counts {
            pairs_tested: sum(COUNT_PAIRS_TESTED),
            pairs_kept: sum(COUNT_PAIRS),
            fragments_tested: sum(COUNT_FRAGMENTS_TESTED),
            fragments_kept: sum(COUNT_FRAGMENTS_KEPT),
            rechecked: sum(COUNT_RECHECKED),
        })
    }

    fn stage_times(&self) -> Option<StageTimes> {
        let bands = (self.plan.bands.len() * self.resident.passes.len()) as u32;
        let passes = 8 * (self.resident.job_count() as u32 + bands);
        let count = 2 * passes;
        (self.gpu.has.timestamps && count <= QUERIES_MAX).then(|| StageTimes {
            queries: self.gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("stages"),
                ty: wgpu::QueryType::Timestamp,
                count,
            }),
            names: Vec::new(),
            resolved: readback(self.gpu, 8 * count as u64),
        })
    }

    /// The GPU time of every stage, summed over its passes.
    fn stage_ms(&self, submitted: &Submitted) -> Result<Vec<(&'static str, f64)>> {
        let Some(times) = &submitted.times else { return Ok(Vec::new()) };
        let words = read_words(self.gpu, &times.resolved)?;
        let stamp = |k: usize| words[2 * k] as u64 | (words[2 * k + 1] as u64) << 32;
        let period_ms = self.gpu.queue.get_timestamp_period() as f64 / 1e6;
        let mut sums: Vec<(&'static str, f64)> = Vec::new();
        for (k, name) in times.names.iter().enumerate() {
            let ms = stamp(2 * k + 1).saturating_sub(stamp(2 * k)) as f64 * period_ms;
            match sums.iter_mut().find(|s| s.0 == *name) {
                Some(sum) => sum.1 += ms,
                None => sums.push((name, ms)),
            }
        }
        Ok(sums)
    }
}

impl Submitted {
    /// A compute pass named after its stage, timed where the adapter can.
    fn pass<'e>(&mut self, encoder: &'e mut wgpu::CommandEncoder, name: &'static str) -> wgpu::ComputePass<'e> {
        self.passes += 1;
        let timestamp_writes = self.times.as_mut().map(|t| {
            let k = 2 * t.names.len() as u32;
            t.names.push(name);
            wgpu::ComputePassTimestampWrites {
                query_set: &t.queries,
                beginning_of_pass_write_index: Some(k),
                end_of_pass_write_index: Some(k + 1),
            }
        });
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(name), timestamp_writes })
    }
}

impl StageTimes {
    fn resolve(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) {
        let count = 2 * self.names.len() as u32;
        if count == 0 {
            return;
        }
        let bytes = 8 * count as u64;
        let resolved = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("timestamps"),
            size: bytes,
            usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        encoder.resolve_query_set(&self.queries, 0..count, &resolved, 0);
        encoder.copy_buffer_to_buffer(&resolved, 0, &self.resolved, 0, bytes);
    }
}

/// The median of every stage over the runs.
fn medians(runs: Vec<Vec<(&'static str, f64)>>) -> Vec<(&'static str, f64)> {
    let Some(first) = runs.first() else { return Vec::new() };
    let median = |name: &str| {
        let mut ms: Vec<f64> = runs.iter().flatten().filter(|s| s.0 == name).map(|s| s.1).collect();
        ms.sort_by(f64::total_cmp);
        ms[ms.len() / 2]
    };
    first.iter().map(|&(name, _)| (name, median(name))).collect()
}

/// The scene with every vertex but the last `fixed`, which are a mirror's, turned about its middle by a little more each
/// frame.
fn moved(scene: &Scene, fixed: usize, frame: u32) -> Scene {
    let mut scene = scene.clone();
    let (lo, hi) = scene.bounds().unwrap_or((DVec3::ZERO, DVec3::ZERO));
    let (middle, turn) = ((lo + hi) / 2.0, DMat3::from_rotation_y(frame as f64 * MOVING_STEP_RAD));
    let moving = scene.mesh.positions.len() - fixed;
    scene.mesh.positions[..moving].iter_mut().for_each(|p| *p = middle + turn * (*p - middle));
    scene
}

/// How far a moving scene turns a frame.
const MOVING_STEP_RAD: f64 = 0.01;
