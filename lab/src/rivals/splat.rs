//! `raster-splat`: two passes (Yu, Yu and McMillan 2009, section 3.3). The first fills a texture S, in which each triangle has k x k
//! texels, with where the camera shows them; the second renders every three neighbours there as a triangle. A pair of passes for
//! each GLC as in the paper, or for as many as fit S.

use super::draw::{BandRaster, Draw, texture};
use super::layout::Splat;
use super::outline;
use super::{kernels, with};
use anamorph::internals::engine::rival::{ChunkScopes, Rival, Setup, Target};
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::buffers::Buffers;
use anamorph::internals::gpu::recorder::Recorder;
use anamorph::internals::input::Result;
use wgpu::TextureFormat;

struct ByTexture {
    project: Draw,
    scatter: Draw,
    band_raster: BandRaster,
    own: Buffers,
    s: wgpu::TextureView,
    samples: u32,
    pieces: u32,
    /// A pair of passes holds one GLC at most.
    is_each: bool,
}

/// Texels a side of S: the paper has up to 1,024.
const SIDE: u32 = 1024;
/// Place and t.
const S: TextureFormat = TextureFormat::Rgba32Float;
const S_BYTES: u64 = 16;

/// The parameter: texels a side of a triangle.
pub fn batched(gpu: &Gpu, setup: &Setup) -> Result<Box<dyn Rival>> {
    splat(gpu, setup, false)
}

/// A pair of passes for each GLC.
pub fn each(gpu: &Gpu, setup: &Setup) -> Result<Box<dyn Rival>> {
    splat(gpu, setup, true)
}

fn splat(gpu: &Gpu, setup: &Setup, is_each: bool) -> Result<Box<dyn Rival>> {
    let samples = setup.parameter;
    let mut own = Buffers::default();
    let pieces = outline::upload(gpu, setup, &mut own)?;
    Ok(Box::new(ByTexture {
        project: Draw::onto(gpu, kernels::splat_project(samples), (S, 1), None),
        scatter: Draw::clipped(gpu, kernels::splat_move(setup.layers(), setup.variant.extras.culling, samples), 1)?,
        band_raster: BandRaster::new(gpu, setup)?,
        own,
        pieces,
        s: texture(gpu, (SIDE, SIDE), (S, 1)),
        samples,
        is_each,
    }))
}

impl ByTexture {
    /// Cells of S.
    fn cells_per_texture(&self) -> u32 {
        (SIDE / self.samples).pow(2)
    }

    /// Pairs of passes over the (piece, slot) pairs of a chunk: the first of each, and how many.
    fn pairs(&self, slots: u32) -> Vec<(u32, u32)> {
        let all = slots.saturating_mul(self.pieces);
        let span = if self.is_each { slots } else { all };
        let parts = |from: u32| {
            (from..from + span).step_by(self.cells_per_texture() as usize).map(move |k| (k, from + span - k))
        };
        let starts = (0..all).step_by(span.max(1) as usize);
        starts.flat_map(parts).map(|(first, left)| (first, left.min(self.cells_per_texture()))).collect()
    }

    fn encode_pair(
        &self,
        gpu: &Gpu,
        recorder: &mut Recorder,
        chunk: &ChunkScopes,
        (first, count): (u32, u32),
        is_first: bool,
    ) -> Result<()> {
        let mut cells = Buffers::default();
        cells.upload_uniform(gpu, "splat", &Splat { side: SIDE, first, slots: chunk.slots, pad0: 0 })?;
        let scopes = with(&chunk.scopes, &[&self.own, &cells]);
        let group = self.project.bind(gpu, &scopes)?;
        let onto_s = wgpu::RenderPassColorAttachment {
            view: &self.s,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
        };
        let mut pass = recorder.render("project", &[Some(onto_s)], None);
        pass.set_pipeline(&self.project.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..6 * count, 0..1);
        drop(pass);
        let group = self.scatter.bind_texture(gpu, &scopes, ("s", &self.s))?;
        let mut pass = self.band_raster.raster_target.pass(recorder, "draw", is_first);
        pass.set_pipeline(&self.scatter.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3 * (self.samples - 1).pow(2) * count, 0..1);
        Ok(())
    }
}

impl Rival for ByTexture {
    fn aim(&mut self, gpu: &Gpu, setup: &Setup) -> Result<()> {
        self.pieces = outline::upload(gpu, setup, &mut self.own)?;
        Ok(())
    }

    fn draws(&self, slots: u32) -> u64 {
        u64::from(slots) * u64::from(self.pieces) * (2 + u64::from(self.samples - 1).pow(2))
    }

    fn passes(&self, band: &Target) -> u32 {
        1 + band.chunks.iter().map(|c| 2 * self.pairs(c.slots).len() as u32).sum::<u32>()
    }

    fn encode(&self, gpu: &Gpu, recorder: &mut Recorder, band: &Target) -> Result<()> {
        let mut is_first = true;
        for chunk in &band.chunks {
            for pair in self.pairs(chunk.slots) {
                self.encode_pair(gpu, recorder, chunk, pair, is_first)?;
                is_first = false;
            }
        }
        self.band_raster.take(gpu, recorder, band)
    }

    fn bytes(&self) -> u64 {
        self.band_raster.raster_target.bytes() + self.own.bytes() + S_BYTES * u64::from(SIDE).pow(2)
    }
}
