//! Costs of stages, by which a frame is rasterized or traced.

use crate::engine::plan::{Band, Plan};

/// What things cost besides raster's lists, in the units of [`crate::gpu::layout::CULL_COST`]. Measurements are in `bench_results/lab.md`.
pub(super) struct Costs {
    /// The stages of raster, however little they do.
    pub stages: u64,
    /// Tracing a pixel that has a ray.
    pub pixel: u64,
    /// Building a hierarchy on the CPU, a triangle.
    pub triangle: u64,
    /// Fitting a hierarchy to a triangle that moved.
    pub moved_triangle: u64,
    /// Cost units per millisecond.
    pub millisecond: u32,
}

impl Costs {
    /// Two cores: medians over the paths of `lab/examples/methods.rs` through up to a million triangles.
    pub const SOFTWARE: Costs = Costs { stages: 0, pixel: 28, triangle: 46, moved_triangle: 8, millisecond: 70_000 };
    /// An NVIDIA H200, by its suites of `anamorph bench`; `moved_triangle` is not measured: its ratio to `triangle` is that of two cores.
    pub const GPU: Costs =
        Costs { stages: 1_900_000, pixel: 2, triangle: 15_000, moved_triangle: 2_600, millisecond: 10_000_000 };

    /// Tracing the rays of a band.
    pub fn trace(&self, plan: &Plan, band: &Band) -> u64 {
        self.pixel * band.tiles.rays.min(u64::from(band.rows) * u64::from(plan.width))
    }
}
