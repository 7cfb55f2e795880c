//! Every list that kernels of a frame write: its size follows from the plan and the capacities, so that the host can allocate it.
//!
//! Buffers that the host uploads are as large as what it uploads (`resident`); rays after a bounce are in `bounce_tables`.

use super::Capacities;
use crate::engine::plan::Plan;
use crate::gpu::layout::{COUNTERS, LANES};
use crate::image::frame::Channel;
use wgpu::BufferUsages;

/// A buffer that kernels write.
#[derive(Debug)]
pub struct BufferSpec {
    pub name: &'static str,
    /// Size in bytes; `None` if the frame does not need the buffer.
    pub bytes: fn(&Sizes) -> Option<u64>,
    /// Beyond storage and copies.
    pub usage: BufferUsages,
}

/// What the sizes of buffers follow from.
#[derive(Debug, Clone, Copy)]
pub struct Sizes<'a> {
    pub plan: &'a Plan,
    pub capacities: Capacities,
    /// As [`super::resident::Resident::raster_rounds`].
    pub raster_rounds: u32,
    /// As [`super::resident::Resident::samples_by_tile`].
    pub samples_by_tile: bool,
}

impl Sizes<'_> {
    /// Of the largest band.
    fn pixels(&self) -> u64 {
        u64::from(self.plan.rows_max()) * u64::from(self.plan.width)
    }

    /// Of the band with most, over all slabs.
    fn tiles(&self) -> u64 {
        let tiles = self.plan.bands.iter().map(|b| b.tiles.tiles_x * b.tiles.tiles_y);
        tiles.max().unwrap_or(0).into()
    }

    fn by_tile(&self, bytes: u64) -> Option<u64> {
        self.plan.variant.by_tile().then_some(bytes)
    }

    fn of_samples(&self, bytes: u64) -> Option<u64> {
        self.plan.variant.samples_edges().then_some(bytes)
    }
}

/// Bytes of an item of a list: two words.
pub const ITEM_BYTES: u64 = 8;

/// Bytes of a vec4.
pub const VEC4_BYTES: u64 = 16;

/// Blocks of [`LANES`] strips of four samples: of each tile the last one may be partly empty.
fn blocks(s: &Sizes) -> u64 {
    let strips = s.capacities.edges * u64::from(s.plan.variant.samples().div_ceil(4));
    strips.div_ceil(u64::from(LANES)) + s.tiles()
}

/// Every list, in the order of first use.
pub fn table() -> Vec<BufferSpec> {
    let list = |name, bytes: fn(&Sizes) -> Option<u64>| BufferSpec { name, bytes, usage: BufferUsages::empty() };
    vec![
        // counts of items, and the size of the next dispatch
        list("counters", |_| Some(4 * u64::from(COUNTERS))),
        BufferSpec { usage: BufferUsages::INDIRECT, ..list("indirect", |_| Some(12)) },
        // lists between the stages
        list("queue_even", |s| Some(ITEM_BYTES * s.capacities.queue)),
        list("queue_odd", |s| Some(ITEM_BYTES * s.capacities.queue)),
        list("work", |s| Some(ITEM_BYTES * s.capacities.work)),
        list("tasks", |s| Some(ITEM_BYTES * s.capacities.tasks)),
        list("large", |s| s.plan.variant.draws_small().then_some(ITEM_BYTES * s.capacities.pairs)),
        list("unsorted", |s| s.by_tile(ITEM_BYTES * s.capacities.pairs)),
        list("ranks", |s| s.by_tile(4 * s.capacities.pairs)),
        list("starts", |s| s.by_tile(4 * s.tiles())),
        list("ends", |s| s.by_tile(4 * s.tiles())),
        list("busy", |s| s.by_tile(4 * s.tiles() * u64::from(1 + s.raster_rounds))),
        list("pairs", |s| Some(ITEM_BYTES * s.capacities.pairs)),
        list("recheck_items", |s| Some(ITEM_BYTES * s.capacities.recheck_items)),
        // for each pixel with an edge: its position, and a key for each sample
        list("samples", |s| s.of_samples(ITEM_BYTES * u64::from(s.plan.variant.samples() + 1) * s.capacities.edges)),
        list("edge_of", |s| s.of_samples(4 * s.pixels())),
        list("blocks", |s| s.samples_by_tile.then(|| VEC4_BYTES * blocks(s))),
        list("touches", |s| s.samples_by_tile.then_some(VEC4_BYTES * s.capacities.pairs)),
        // the image
        list("visibility", |s| Some(8 * s.pixels())),
        list("proofs", |s| s.plan.planes.contains(&Channel::Certified).then_some(8 * s.pixels())),
        list("planes", |s| Some(4 * s.plan.planes.len() as u64 * s.pixels())),
        list("srgb8", |s| s.plan.srgb8.then_some(4 * s.pixels())),
    ]
}
