//! splat: which points may be the nearest at a pixel.
//!
//! `claim` finds for each pixel the least t that proven images are sure to have, over all chunks so far, and `contend` lists the points with
//! an image that may be nearer, or of which solve has not proven everything. The host projects only these, in f64: all others are hidden.

use super::dispatch_items;
use super::solve::Solve;
use crate::camera::project::Projector;
use crate::gpu::Gpu;
use crate::gpu::buffers::{Buffers, Pipeline};
use crate::gpu::kernels::Kernel;
use crate::gpu::readback::{read_words, readback};
use crate::input::Result;
use glam::DVec3;

/// The kernels, compiled, and the pixels of one image.
pub struct Splat<'g> {
    solve: Solve<'g>,
    pipelines: [Pipeline; 2],
    /// `nearest`: a word each pixel, by `claim`, for `contend`.
    pixels: Buffers,
}

/// A chunk that the device is at work on: its bits.
pub struct SplatStarted {
    wanted: wgpu::Buffer,
    points: usize,
}

impl<'g> Splat<'g> {
    /// An image without points; `None` for a camera that is not one layer of pieces, or of curves that solve has bounds of, and for
    /// an image that no binding holds.
    pub fn new(gpu: &'g Gpu, projector: &Projector) -> Result<Option<Splat<'g>>> {
        let camera = projector.camera();
        if camera.layers.len() != 1 {
            return Ok(None);
        }
        let count = camera.width as usize * camera.height as usize;
        let solve = Solve::with_curves(gpu, projector)?;
        if !solve.solves(0) || 4 * count as u64 > gpu.binding_limit() {
            return Ok(None);
        }
        let pixels = vec![u32::MAX; count];
        let mut nearest = Buffers::default();
        nearest.upload(gpu, "nearest", &pixels)?;
        Ok(Some(Splat {
            solve,
            pipelines: [
                Pipeline::new(gpu, Kernel::alone("claim.wgsl"))?,
                Pipeline::new(gpu, Kernel::alone("contend.wgsl"))?,
            ],
            pixels: nearest,
        }))
    }

    /// Points of a chunk at most.
    pub fn points_most(&self) -> usize {
        self.solve.points_most()
    }

    /// Gives lists as many slots as some of the points need.
    pub fn adapt(&mut self, points: &[DVec3]) -> Result<()> {
        self.solve.adapt(points)
    }

    /// Sends a chunk of at most [`Splat::points_most`] points on its way, after those before it.
    pub fn start(&self, points: &[DVec3]) -> Result<SplatStarted> {
        let gpu = self.solve.gpu;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let bytes = 4 * (points.len() as u64).div_ceil(32);
        let to = readback(gpu, bytes);
        for (slots, sifted) in self.solve.sift.encode(&mut encoder, points)? {
            let Some(chunk) = self.solve.encode(&mut encoder, 0, points, slots, &sifted)? else { continue };
            for (pipeline, label) in self.pipelines.iter().zip(["claim", "contend"]) {
                let group = pipeline.bind(gpu, &[&chunk, &self.pixels])?;
                let mut pass = encoder
                    .begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(label), timestamp_writes: None });
                pass.set_pipeline(pipeline.raw());
                pass.set_bind_group(0, &group, &[]);
                dispatch_items(gpu, &mut pass, Solve::images_most(gpu, points.len()));
            }
            if let Some(wanted) = chunk.get("wanted") {
                encoder.copy_buffer_to_buffer(wanted, 0, &to, 0, bytes);
            }
        }
        gpu.queue.submit([encoder.finish()]);
        gpu.failure()?;
        Ok(SplatStarted { wanted: to, points: points.len() })
    }

    /// Waits for a chunk: the points that may be the nearest of a pixel, by their numbers in it, ascending.
    pub fn finish(&self, started: SplatStarted) -> Result<Vec<usize>> {
        let words = read_words(self.solve.gpu, &started.wanted)?;
        let is_wanted = |k: &usize| words[k / 32] >> (k % 32) & 1 == 1;
        Ok((0..started.points).filter(is_wanted).collect())
    }
}
