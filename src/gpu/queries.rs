//! Queries: numbers that an adapter writes while a submission runs, and how they are read.

use super::device::Gpu;
use super::readback::{PendingRead, readback};
use crate::input::Result;

/// Queries of one kind.
pub struct Queries {
    pub set: wgpu::QuerySet,
    /// Numbers that each answers.
    numbers: u64,
    /// What they answered, for the host.
    answers: wgpu::Buffer,
}

impl Queries {
    /// `count` queries of `numbers` numbers each; `None` if `count` is 0, or more than one set holds.
    pub fn new(gpu: &Gpu, ty: wgpu::QueryType, count: u32, numbers: u64) -> Option<Queries> {
        (1..=wgpu::QUERY_SET_MAX_QUERIES).contains(&count).then(|| Queries {
            set: gpu.device.create_query_set(&wgpu::QuerySetDescriptor { label: Some("queries"), ty, count }),
            numbers,
            answers: readback(gpu, 8 * numbers * u64::from(count)),
        })
    }

    /// Copies the answers of the first `count` to where [`Queries::start`] reads them.
    pub fn resolve(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, count: u32) {
        if count == 0 {
            return;
        }
        let bytes = 8 * self.numbers * u64::from(count);
        let resolved = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("queries"),
            size: bytes,
            usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        encoder.resolve_query_set(&self.set, 0..count, &resolved, 0);
        encoder.copy_buffer_to_buffer(&resolved, 0, &self.answers, 0, bytes);
    }

    /// Starts to read them, for [`answered`].
    pub fn start(&self) -> PendingRead {
        PendingRead::start(&self.answers)
    }
}

/// The numbers, query after query, once the submission is done.
pub fn answered(gpu: &Gpu, pending: PendingRead) -> Result<Vec<u64>> {
    let words = pending.words(gpu)?;
    Ok(words.chunks_exact(2).map(|pair| u64::from(pair[0]) | u64::from(pair[1]) << 32).collect())
}
