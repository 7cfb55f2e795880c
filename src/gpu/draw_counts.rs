//! What the adapter's rasterizer did in the render passes of a submission, counted by it.

use super::device::Gpu;
use super::queries::{Queries, answered};
use super::readback::PendingRead;
use crate::input::Result;
use std::ops::AddAssign;
use wgpu::PipelineStatisticsTypes as Counted;

/// Of some render passes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct DrawCounts {
    /// Runs of vertex shaders.
    pub vertices: u64,
    /// Triangles that are left once those outside are clipped off.
    pub triangles: u64,
    /// Runs of fragment shaders. Some adapters count those beside a triangle that they need for derivatives too.
    pub fragments: u64,
}

impl AddAssign for DrawCounts {
    fn add_assign(&mut self, other: DrawCounts) {
        self.vertices += other.vertices;
        self.triangles += other.triangles;
        self.fragments += other.fragments;
    }
}

/// In the order in which adapters write them.
const COUNTED: [Counted; 3] =
    [Counted::VERTEX_SHADER_INVOCATIONS, Counted::CLIPPER_PRIMITIVES_OUT, Counted::FRAGMENT_SHADER_INVOCATIONS];

/// Counts of render passes while they are recorded.
pub struct DrawQueries {
    queries: Queries,
    passes: u32,
    /// How many fit.
    capacity: u32,
}

impl DrawQueries {
    /// For at most `passes_max` passes; `None` where they are too many, or the adapter does not count.
    pub fn new(gpu: &Gpu, passes_max: u32) -> Option<DrawQueries> {
        if !gpu.has.draw_counts {
            return None;
        }
        let counted = wgpu::QueryType::PipelineStatistics(COUNTED.into_iter().collect());
        let queries = Queries::new(gpu, counted, passes_max, COUNTED.len() as u64)?;
        Some(DrawQueries { queries, passes: 0, capacity: passes_max })
    }

    /// The query of one more pass; `None` where they are full.
    #[cfg(feature = "internals")]
    pub fn add_pass(&mut self) -> Option<u32> {
        let query = self.passes;
        self.passes += 1;
        (query < self.capacity).then_some(query)
    }

    #[cfg(feature = "internals")]
    pub fn set(&self) -> &wgpu::QuerySet {
        &self.queries.set
    }

    pub fn resolve(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) {
        self.queries.resolve(gpu, encoder, self.counted());
    }

    /// Starts to read them, for [`DrawQueries::read`].
    pub fn start(&self) -> PendingRead {
        self.queries.start()
    }

    /// Their sum, once the submission is done.
    pub fn read(&self, gpu: &Gpu, pending: PendingRead) -> Result<DrawCounts> {
        let numbers = answered(gpu, pending)?;
        let mut sum = DrawCounts::default();
        for pass in numbers.chunks_exact(COUNTED.len()).take(self.counted() as usize) {
            sum += DrawCounts { vertices: pass[0], triangles: pass[1], fragments: pass[2] };
        }
        Ok(sum)
    }

    /// Passes that have a query.
    fn counted(&self) -> u32 {
        self.passes.min(self.capacity)
    }
}
