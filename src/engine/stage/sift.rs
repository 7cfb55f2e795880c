//! sift: points against the beams of a camera, chunk by chunk: which parts of the image may see each.
//!
//! A point has so many slots for what is found; of points with more the host walks the whole tree, and the next chunk
//! has more slots. Nothing is run again, and nothing waits for a count.

use super::dispatch_items;
use crate::camera::project::Projector;
use crate::camera::project::tree::WHOLE;
use crate::engine::plan::beams::{BEAM_BYTES, Beams};
use crate::gpu::Gpu;
use crate::gpu::buffers::{Buffers, Pipeline};
use crate::gpu::kernels::Kernel;
use crate::gpu::layout::Chunk;
use crate::gpu::readback::{read_words, readback};
use crate::input::Result;
use crate::parallel;
use glam::DVec3;
use wgpu::BufferUsages;

/// The kernel, compiled, and the beams of each layer on the device.
pub struct Sift<'g> {
    gpu: &'g Gpu,
    pipeline: Pipeline,
    layers: Vec<Layer>,
}

struct Layer {
    beams: Beams,
    /// `beams`: the nodes of the tree, written by the host, read by the kernel.
    tables: Buffers,
    /// Of each point of the next chunk.
    slots: u32,
}

/// A chunk that the device is at work on.
pub struct Started {
    pub(super) points: usize,
    /// Slots and list of each layer.
    pub(super) layers: Vec<(u32, wgpu::Buffer)>,
}

/// What was found for the points of a chunk.
pub struct Sifted {
    /// Of each layer: slots, and each point's count and slots.
    layers: Vec<(u32, Vec<u32>)>,
}

/// Slots of a point at first, and at most; a power of 2 each.
const SLOTS: u32 = 8;
const SLOTS_MOST: u32 = 1024;

/// Of so many points one may have more than its slots.
const OVER: usize = 16;

impl<'g> Sift<'g> {
    /// For the points of one camera; the device holds 64 bytes a node of its trees.
    pub fn new(gpu: &'g Gpu, projector: &Projector) -> Result<Sift<'g>> {
        let pipeline = Pipeline::new(gpu, Kernel::alone("sift.wgsl"))?;
        let most = (gpu.binding_limit() / BEAM_BYTES) as usize;
        let layer = |tree| {
            let beams = Beams::new(tree, most);
            let mut tables = Buffers::default();
            tables.upload(gpu, "beams", &beams.nodes)?;
            // no more than there are nodes
            let slots = SLOTS.min((beams.nodes.len() as u32).next_power_of_two());
            Ok(Layer { beams, tables, slots })
        };
        let layers = projector.trees().map(layer).collect::<Result<_>>()?;
        Ok(Sift { gpu, pipeline, layers })
    }

    /// Points of a chunk at most: their lists must fit a binding with all slots.
    pub fn points_most(&self) -> usize {
        (self.gpu.binding_limit() / (4 * (u64::from(SLOTS_MOST) + 1))) as usize
    }

    /// Sends a chunk of at most [`Sift::points_most`] points on its way.
    pub fn start(&self, points: &[DVec3]) -> Result<Started> {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let mut started = Started { points: points.len(), layers: Vec::new() };
        for (slots, chunk) in self.encode(&mut encoder, points)? {
            started.layers.push((slots, self.copied(&mut encoder, points.len(), slots, &chunk)));
        }
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.failure()?;
        Ok(started)
    }

    /// Appends the dispatches of a chunk. Of each layer: slots, and buffers of which `found` will have the lists.
    pub(super) fn encode(&self, encoder: &mut wgpu::CommandEncoder, points: &[DVec3]) -> Result<Vec<(u32, Buffers)>> {
        let gpu = self.gpu;
        let mut layers = Vec::new();
        for Layer { beams, tables, slots } in &self.layers {
            let mut chunk = Buffers::default();
            let packed: Vec<[f32; 4]> = parallel::map(points, |p| beams.point(*p));
            chunk.upload(gpu, "points", &packed)?;
            chunk.create(gpu, "found", list_bytes(points.len(), *slots), BufferUsages::empty())?;
            let uniform = Chunk {
                points: points.len() as u32,
                beams: beams.nodes.len() as u32,
                slots: *slots,
                most: SLOTS_MOST,
                t_min: beams.t_range[0],
                t_max: beams.t_range[1],
                pad0: 0,
                pad1: 0,
            };
            chunk.upload_uniform(gpu, "chunk", &uniform)?;
            let group = self.pipeline.bind(gpu, &[&chunk, tables])?;
            let mut pass = encoder
                .begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("sift"), timestamp_writes: None });
            pass.set_pipeline(self.pipeline.raw());
            pass.set_bind_group(0, &group, &[]);
            dispatch_items(gpu, &mut pass, uniform.points);
            drop(pass);
            layers.push((*slots, chunk));
        }
        Ok(layers)
    }

    /// Appends the copy of a layer's list to a buffer that the host reads.
    pub(super) fn copied(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        points: usize,
        slots: u32,
        chunk: &Buffers,
    ) -> wgpu::Buffer {
        let bytes = list_bytes(points, slots);
        let list = readback(self.gpu, bytes);
        if let Some(found) = chunk.get("found") {
            encoder.copy_buffer_to_buffer(found, 0, &list, 0, bytes);
        }
        list
    }

    /// Waits for a chunk.
    pub fn finish(&mut self, started: Started) -> Result<Sifted> {
        let mut sifted = Sifted { layers: Vec::new() };
        for (layer, (slots, list)) in self.layers.iter_mut().zip(started.layers) {
            let mut words = read_words(self.gpu, &list)?;
            words.truncate(started.points * (slots as usize + 1));
            layer.slots = slots_for(&words, slots);
            sifted.layers.push((slots, words));
        }
        Ok(sifted)
    }
}

/// Bytes of the list of a layer: a count and the slots of each point, a word each.
fn list_bytes(points: usize, slots: u32) -> u64 {
    4 * points as u64 * (u64::from(slots) + 1)
}

/// Slots that suffice for all but one of [`OVER`] points like these.
fn slots_for(words: &[u32], slots: u32) -> u32 {
    let mut counts: Vec<u32> = words.chunks(slots as usize + 1).map(|list| list[0]).collect();
    let last = (counts.len() - counts.len() / OVER).saturating_sub(1);
    if counts.is_empty() {
        return slots;
    }
    let (_, enough, _) = counts.select_nth_unstable(last);
    (*enough).clamp(SLOTS.min(slots), SLOTS_MOST).next_power_of_two()
}

impl Sifted {
    /// Takes those out of a layer's lists that hold no image: slot by slot, whether each does.
    pub(super) fn keep(&mut self, layer: usize, holds: impl Fn(usize) -> bool + Sync) {
        let (slots, words) = &mut self.layers[layer];
        let slots = *slots as usize;
        parallel::for_each(words.chunks_mut(slots + 1).enumerate(), |(point, list)| {
            let count = list[0] as usize;
            if count > slots {
                return;
            }
            let mut kept = 0;
            for slot in 0..count {
                if holds(point * slots + slot) {
                    kept += 1;
                    list[kept] = list[1 + slot];
                }
            }
            list[0] = kept as u32;
        });
    }

    /// The nodes of a layer's tree at or below which the chunk's `point` may be seen, ascending.
    pub fn nodes(&self, layer: usize, point: usize) -> &[u32] {
        let (slots, words) = &self.layers[layer];
        let start = point * (*slots as usize + 1);
        match words[start] {
            count if count > *slots => WHOLE,
            count => &words[start + 1..][..count as usize],
        }
    }

    /// Slots of a point in a layer's list.
    pub(super) fn slots(&self, layer: usize) -> usize {
        self.layers[layer].0 as usize
    }

    /// How many nodes a point was found in; `None` where they were not all counted.
    #[cfg(feature = "internals")]
    pub fn count(&self, layer: usize, point: usize) -> Option<u32> {
        let (slots, words) = &self.layers[layer];
        Some(words[point * (*slots as usize + 1)]).filter(|count| *count <= SLOTS_MOST)
    }
}
