//! deposit: caustic triangles onto the maps of their receivers, once for all frames of a scene.

use super::dispatch_items;
use crate::arrays::MapEach;
use crate::gpu::Gpu;
use crate::gpu::buffers::{Buffers, Pipeline};
use crate::gpu::kernels::Kernel;
use crate::gpu::layout;
use crate::gpu::readback::{read_words, readback};
use crate::input::{Error, Result};
use crate::parallel;
use crate::scene::caustics::beams::CausticTriangle;
use crate::scene::caustics::{CausticMaps, Caustics, Map, mean};
use wgpu::BufferUsages;

/// The kernel, compiled.
pub struct Deposit<'g> {
    gpu: &'g Gpu,
    pipeline: Pipeline,
}

/// What `deposit` reads, ready to upload.
#[derive(Debug, Clone)]
pub struct CausticTriangles {
    pub triangles: Vec<layout::CausticTriangle>,
    pub receivers: Vec<layout::Receiver>,
    /// Of all receivers.
    pub texels: u32,
    /// Flux of a unit.
    pub unit: f64,
}

/// Words of a texel's sums: low and high of R, G and B.
pub const TEXEL_WORDS: u64 = 6;

/// Units of the brightest triangle at most. 2^34 such triangles would not fill a sum, and rounding is far below f32's.
const UNITS: f64 = (1u64 << 30) as f64;

impl CausticTriangles {
    /// # Errors
    /// [`Error::Input`] for more texels than indices.
    pub fn new(caustics: &Caustics, caustic_triangles: &[CausticTriangle]) -> Result<CausticTriangles> {
        let brightest = caustic_triangles.iter().flat_map(|c| c.flux).fold(0.0, f64::max);
        let unit = if brightest > 0.0 { brightest / UNITS } else { 1.0 };
        let all: u64 = caustics.receivers.iter().map(|r| r.texels[0] as u64 * r.texels[1] as u64).sum();
        if TEXEL_WORDS * (all + 2) > u64::from(u32::MAX) {
            return Err(Error::input(format!("caustics.receivers: {all} texels are too many; use fewer")));
        }
        let firsts = caustics.first_texels();
        let receiver = |(r, first): (&crate::scene::caustics::Receiver, &u32)| layout::Receiver {
            columns: r.texels[0],
            rows: r.texels[1],
            first: *first,
            scale: (unit / r.texel_area() / std::f64::consts::PI) as f32,
        };
        let packed = |triangle: &CausticTriangle| {
            let [a, b, c] = triangle.corners.map_each(|p| p.as_vec2().to_array());
            let flux = triangle.flux.map_each(|f| (f / unit).round() as u32);
            layout::CausticTriangle { a, b, c, receiver: triangle.receiver, pad0: 0, flux, pad1: 0 }
        };
        Ok(CausticTriangles {
            triangles: parallel::map(caustic_triangles, packed),
            receivers: caustics.receivers.iter().zip(&firsts).map(receiver).collect(),
            texels: all as u32,
            unit,
        })
    }
}

impl<'g> Deposit<'g> {
    pub fn new(gpu: &'g Gpu) -> Result<Deposit<'g>> {
        Ok(Deposit { gpu, pipeline: Pipeline::new(gpu, Kernel::alone("deposit.wgsl"))? })
    }

    /// Adds up the flux of all triangles in `sums`, which `buffers` gets together with `receivers`; returns the sums: 6
    /// words a texel, as many of what missed, and the number of lines and points.
    pub fn run(&self, caustic_triangles: &CausticTriangles, buffers: &mut Buffers) -> Result<Vec<u32>> {
        let gpu = self.gpu;
        let bytes = 4 * (TEXEL_WORDS * (u64::from(caustic_triangles.texels) + 1) + 1);
        buffers.create(gpu, "sums", bytes, BufferUsages::empty())?;
        buffers.upload(gpu, "receivers", &caustic_triangles.receivers)?;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        if let Some(sums) = buffers.get("sums") {
            encoder.clear_buffer(sums, 0, None);
        }
        let most = (gpu.binding_limit() as usize / size_of::<layout::CausticTriangle>()).max(1);
        for chunk in caustic_triangles.triangles.chunks(most) {
            let mut own = Buffers::default();
            own.upload(gpu, "caustic_triangles", chunk)?;
            let deposit_params =
                layout::DepositParams { count: chunk.len() as u32, texels: caustic_triangles.texels, pad0: 0, pad1: 0 };
            own.upload_uniform(gpu, "deposit_params", &deposit_params)?;
            let group = self.pipeline.bind(gpu, &[&own, buffers])?;
            let mut pass = encoder
                .begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("deposit"), timestamp_writes: None });
            pass.set_pipeline(self.pipeline.raw());
            pass.set_bind_group(0, &group, &[]);
            dispatch_items(gpu, &mut pass, deposit_params.count);
        }
        let list = readback(gpu, bytes);
        if let Some(sums) = buffers.get("sums") {
            encoder.copy_buffer_to_buffer(sums, 0, &list, 0, bytes);
        }
        gpu.queue.submit([encoder.finish()]);
        let mut words = read_words(gpu, &list)?;
        words.truncate((bytes / 4) as usize);
        Ok(words)
    }
}

impl CausticTriangles {
    /// The maps of the sums, and the budget completed.
    pub fn maps(
        &self,
        caustics: &Caustics,
        mut budget: crate::scene::caustics::FluxBudget,
        sums: &[u32],
    ) -> CausticMaps {
        let texel = |words: &[u32]| {
            [0, 1, 2].map_each(|k| (u64::from(words[2 * k]) | u64::from(words[2 * k + 1]) << 32) as f64 * self.unit)
        };
        let (texels, rest) = sums.split_at(TEXEL_WORDS as usize * self.texels as usize);
        let flux: Vec<[f64; 3]> = texels.chunks_exact(TEXEL_WORDS as usize).map(texel).collect();
        let firsts = caustics.first_texels();
        let map = |(k, receiver): (usize, &crate::scene::caustics::Receiver)| Map {
            receiver: *receiver,
            flux: flux[firsts[k] as usize..firsts[k + 1] as usize].to_vec(),
        };
        let maps: Vec<Map> = caustics.receivers.iter().enumerate().map(map).collect();
        budget.deposited = maps.iter().map(|m| mean(m.total())).sum();
        budget.missed += mean(texel(rest));
        budget.degenerate = rest.get(TEXEL_WORDS as usize).copied().unwrap_or(0).into();
        CausticMaps { maps, budget }
    }
}
