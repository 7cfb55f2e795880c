//! gradient: how hits and edges change with corners and rays, rows by rows, after a frame was read back.
//!
//! A submission takes the rows that fit the adapter's bindings, and one direction of the rays or those of the corners. Rays and corners
//! are sent as the f64 that they are, and only the corners of triangles that these rows show.

use super::dispatch_items;
use crate::camera::change::{NUMBERS, PixelRay};
use crate::gpu::Gpu;
use crate::gpu::buffers::{Buffers, Pipeline};
use crate::gpu::kernels::Kernel;
use crate::gpu::layout::{GradientParams, NONE};
use crate::gpu::readback::{read_words, readback};
use crate::input::{Error, Result};
use crate::parallel;
use crate::scene::gradients::{Changes, HIT_NUMBERS, Seen, VERTEX_DIRECTIONS};
use glam::DVec3;
use wgpu::BufferUsages;

/// The kernels, compiled.
pub struct Gradient<'g> {
    gpu: &'g Gpu,
    hits: Pipeline,
    edges: Option<Pipeline>,
}

/// What a pixel has, as in the WGSL.
const HAS_RAY: u32 = 1;
const HAS_SLOPES: u32 = 2;

/// Bytes of a pixel of what is sent and what comes back, the largest of the buffers: its ray or its changes.
const PIXEL_BYTES: u64 = 4 * (HIT_NUMBERS * VERTEX_DIRECTIONS) as u64;

impl<'g> Gradient<'g> {
    /// With the kernel of edges if they are looked for.
    pub fn new(gpu: &'g Gpu, has_edges: bool) -> Result<Gradient<'g>> {
        let edges = if has_edges { Some(Pipeline::new(gpu, Kernel::alone("gradient_edge.wgsl"))?) } else { None };
        Ok(Gradient { gpu, hits: Pipeline::new(gpu, Kernel::alone("gradient.wgsl"))?, edges })
    }

    /// The changes of all pixels along the coordinates of their triangles' corners; or along a direction of the rays.
    ///
    /// # Errors
    /// [`Error::Work`] if three rows do not fit a binding, or the device fails.
    pub fn changes(&self, seen: &Seen, rates: Option<&[PixelRay]>) -> Result<Changes> {
        let mut all = Changes::default();
        let mut row = 0;
        let rows = self.rows_most(seen)?;
        while row < seen.height {
            let count = rows.min(seen.height - row);
            self.add_rows(seen, rates, (row, count), &mut all)?;
            row += count;
        }
        Ok(all)
    }

    /// Rows of a submission, with one above and one below.
    fn rows_most(&self, seen: &Seen) -> Result<u32> {
        let width = u64::from(seen.width);
        let most = self.gpu.binding_limit() / (PIXEL_BYTES * width);
        let rows = most.min(u64::from(u32::MAX) / width).saturating_sub(2).min(u64::from(seen.height)) as u32;
        if rows == 0 {
            return Err(Error::work(
                "gradients: three rows of the image do not fit a binding of the adapter; make it narrower",
            ));
        }
        Ok(rows)
    }

    fn add_rows(
        &self,
        seen: &Seen,
        rates: Option<&[PixelRay]>,
        (row, count): (u32, u32),
        all: &mut Changes,
    ) -> Result<()> {
        let gpu = self.gpu;
        let width = seen.width as usize;
        let (top, bottom) = (row.saturating_sub(1), (row + count + 1).min(seen.height));
        let table = top as usize * width..bottom as usize * width;
        let directions = if rates.is_some() { 1 } else { VERTEX_DIRECTIONS };
        let pixels = count as usize * width;
        let params = GradientParams {
            width: seen.width,
            rows: bottom - top,
            first: (row - top) * seen.width,
            pixels: pixels as u32,
            directions: directions as u32,
            pixel_first: top * seen.width,
            pad0: 0,
            pad1: 0,
        };
        let shown = Shown::of(seen, table.clone());
        let mut buffers = Buffers::default();
        buffers.upload_uniform(gpu, "gradient_params", &params)?;
        buffers.upload(gpu, "rays", &finite(&seen.rays[table.clone()]))?;
        buffers.upload(gpu, "ray_rates", &rates.map_or(Vec::new(), |rates| finite(&rates[table])))?;
        buffers.upload(gpu, "slots", &shown.slots)?;
        buffers.upload(gpu, "corners", &shown.corners)?;
        let hits = self.run(&self.hits, &mut buffers, &params, HIT_NUMBERS)?;
        all.hits.extend(hits.0.into_iter().map(f32::from_bits));
        if let Some(edges) = &self.edges {
            buffers.create(gpu, "edges", 16 * pixels as u64, BufferUsages::empty())?;
            let (changes, found) = self.run(edges, &mut buffers, &params, 1)?;
            all.coverage.extend(changes.into_iter().map(f32::from_bits));
            for edge in found.as_chunks::<4>().0.iter().take(pixels) {
                all.edges.coverage.push(f32::from_bits(edge[0]));
                all.edges.triangle.push(if edge[1] == NONE { NONE } else { shown.ids[edge[1] as usize] });
                all.edges.pixels.push([edge[2], edge[3]]);
            }
        }
        if let Some(rates) = rates {
            mark_unknown(rates, row as usize * width, pixels, (seen, all));
        }
        Ok(())
    }

    /// What a kernel writes: its changes, and the edges if there are any.
    fn run(
        &self,
        pipeline: &Pipeline,
        buffers: &mut Buffers,
        params: &GradientParams,
        numbers: usize,
    ) -> Result<(Vec<u32>, Vec<u32>)> {
        let gpu = self.gpu;
        let count = numbers * params.directions as usize * params.pixels as usize;
        buffers.create(gpu, "changes", 4 * count as u64, BufferUsages::empty())?;
        let group = pipeline.bind(gpu, &[buffers])?;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = encoder
            .begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("gradient"), timestamp_writes: None });
        pass.set_pipeline(pipeline.raw());
        pass.set_bind_group(0, &group, &[]);
        dispatch_items(gpu, &mut pass, params.pixels);
        drop(pass);
        let mut lists = Vec::new();
        for buffer in ["changes", "edges"].into_iter().filter_map(|name| buffers.get(name)) {
            let list = readback(gpu, buffer.size());
            encoder.copy_buffer_to_buffer(buffer, 0, &list, 0, buffer.size());
            lists.push(list);
        }
        gpu.queue.submit([encoder.finish()]);
        gpu.failure()?;
        let mut words = lists.iter().map(|list| read_words(gpu, list)).collect::<Result<Vec<_>>>()?;
        let edges = if words.len() > 1 { words.remove(1) } else { Vec::new() };
        let mut changes = words.swap_remove(0);
        changes.truncate(count);
        Ok((changes, edges))
    }
}

/// The triangles that some pixels show.
struct Shown {
    /// Ascending.
    ids: Vec<u32>,
    /// Of each pixel its triangle's number among these, and what it has.
    slots: Vec<[u32; 2]>,
    corners: Vec<[DVec3; 3]>,
}

impl Shown {
    fn of(seen: &Seen, pixels: std::ops::Range<usize>) -> Shown {
        let mut ids: Vec<u32> = seen.ids[pixels.clone()].iter().copied().filter(|id| *id != NONE).collect();
        parallel::sort(&mut ids);
        ids.dedup();
        let slot = |k: usize| {
            let is_there = |numbers: std::ops::Range<usize>| seen.rays[k][numbers].iter().all(|n| n.is_finite());
            let has = if is_there(0..6) { HAS_RAY } else { 0 } + if is_there(0..NUMBERS) { HAS_SLOPES } else { 0 };
            // each is in the list
            [ids.binary_search(&seen.ids[k]).map_or(NONE, |slot| slot as u32), has]
        };
        let slots = parallel::map(pixels, slot);
        let corners = ids.iter().map(|id| (seen.corners)(*id)).collect();
        Shown { ids, slots, corners }
    }
}

/// With 0 for what is not there: kernels do not tell NaN from numbers.
fn finite(rays: &[PixelRay]) -> Vec<PixelRay> {
    parallel::map(rays, |ray| ray.map(|n| if n.is_finite() { n } else { 0.0 }))
}

/// NaN for changes of pixels whose ray has no derivative.
fn mark_unknown(rates: &[PixelRay], first: usize, pixels: usize, (seen, all): (&Seen, &mut Changes)) {
    let is_unknown = |rate: &[f64]| rate.iter().any(|n| n.is_nan());
    for (pixel, rate) in rates.iter().enumerate().skip(first).take(pixels) {
        if seen.ids[pixel] != NONE && is_unknown(&rate[..6]) {
            all.hits[HIT_NUMBERS * pixel..][..HIT_NUMBERS].fill(f32::NAN);
        }
        let coverage = all.edges.coverage.get(pixel).copied().unwrap_or(1.0);
        if coverage > 0.0 && coverage < 1.0 && is_unknown(rate) {
            all.coverage[pixel] = f32::NAN;
        }
    }
}
