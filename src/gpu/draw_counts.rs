//! What the adapter's rasterizer did in the render passes of a submission, counted by it.

use super::buffers::{PendingRead, readback};
use super::device::Gpu;
use crate::input::Result;
use std::ops::{AddAssign, Deref, DerefMut};
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
const BYTES_PER_PASS: u64 = 8 * COUNTED.len() as u64;

/// Counts of render passes while they are recorded.
pub struct DrawQueries {
    queries: wgpu::QuerySet,
    passes: u32,
    /// How many fit.
    capacity: u32,
    resolved: wgpu::Buffer,
}

impl DrawQueries {
    /// For at most `passes_max` passes; `None` where they are too many, or the adapter does not count.
    pub fn new(gpu: &Gpu, passes_max: u32) -> Option<DrawQueries> {
        let fits = (1..=wgpu::QUERY_SET_MAX_QUERIES).contains(&passes_max);
        (gpu.has.draw_counts && fits).then(|| DrawQueries {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("draw_counts"),
                ty: wgpu::QueryType::PipelineStatistics(COUNTED.into_iter().collect()),
                count: passes_max,
            }),
            passes: 0,
            capacity: passes_max,
            resolved: readback(gpu, BYTES_PER_PASS * u64::from(passes_max)),
        })
    }

    /// The query of one more pass; `None` where they are full.
    pub fn add_pass(&mut self) -> Option<u32> {
        let query = self.passes;
        self.passes += 1;
        (query < self.capacity).then_some(query)
    }

    pub fn set(&self) -> &wgpu::QuerySet {
        &self.queries
    }

    pub fn resolve(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) {
        let passes = self.passes.min(self.capacity);
        if passes == 0 {
            return;
        }
        let bytes = BYTES_PER_PASS * u64::from(passes);
        let resolved = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("draw_counts"),
            size: bytes,
            usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        encoder.resolve_query_set(&self.queries, 0..passes, &resolved, 0);
        encoder.copy_buffer_to_buffer(&resolved, 0, &self.resolved, 0, bytes);
    }

    /// Starts to read them, for [`DrawQueries::read`].
    pub fn start(&self) -> PendingRead {
        PendingRead::start(&self.resolved)
    }

    /// Their sum, once the submission is done.
    pub fn read(&self, gpu: &Gpu, pending: PendingRead) -> Result<DrawCounts> {
        let words = pending.words(gpu)?;
        let number = |k: usize| u64::from(words[2 * k]) | u64::from(words[2 * k + 1]) << 32;
        let mut sum = DrawCounts::default();
        for pass in 0..self.passes.min(self.capacity) as usize {
            let first = COUNTED.len() * pass;
            sum += DrawCounts { vertices: number(first), triangles: number(first + 1), fragments: number(first + 2) };
        }
        Ok(sum)
    }
}

/// A render pass that ends its count where it ends.
pub struct DrawPass<'a> {
    pass: wgpu::RenderPass<'a>,
    is_counted: bool,
}

impl<'a> DrawPass<'a> {
    /// Counted by a query of a set, if there is one.
    pub fn new(mut pass: wgpu::RenderPass<'a>, query: Option<(&wgpu::QuerySet, u32)>) -> DrawPass<'a> {
        if let Some((set, query)) = query {
            pass.begin_pipeline_statistics_query(set, query);
        }
        DrawPass { pass, is_counted: query.is_some() }
    }
}

impl<'a> Deref for DrawPass<'a> {
    type Target = wgpu::RenderPass<'a>;

    fn deref(&self) -> &wgpu::RenderPass<'a> {
        &self.pass
    }
}

impl<'a> DerefMut for DrawPass<'a> {
    fn deref_mut(&mut self) -> &mut wgpu::RenderPass<'a> {
        &mut self.pass
    }
}

impl Drop for DrawPass<'_> {
    fn drop(&mut self) {
        if self.is_counted {
            self.pass.end_pipeline_statistics_query();
        }
    }
}
