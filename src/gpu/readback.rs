//! Buffers that the host reads.

use super::buffers::{SMALLEST, wait};
use super::device::{Gpu, one_line};
use crate::input::Result;
use crate::parallel;
use std::ops::Range;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Readback buffers of a device that are free again. A new one costs a page fault for each 4 KiB that is copied into it.
#[derive(Default)]
pub struct SpareBuffers(Mutex<Vec<wgpu::Buffer>>);

/// Spare buffers that are kept: for the frames in flight, and of two sizes in turn.
const SPARE_MAX: usize = 4;

impl SpareBuffers {
    fn take(&self, bytes: u64) -> Option<wgpu::Buffer> {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let at = all.iter().position(|buffer| buffer.size() == bytes)?;
        Some(all.remove(at))
    }

    fn add(&self, buffer: wgpu::Buffer) {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.push(buffer);
        if all.len() > SPARE_MAX {
            all.remove(0);
        }
    }
}

/// A buffer that the host can read once the copies into it are done. All of its bytes must be written before.
pub fn readback(gpu: &Gpu, bytes: u64) -> wgpu::Buffer {
    let bytes = bytes.max(SMALLEST);
    let new = || {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size: bytes,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
    };
    gpu.spare_buffers.take(bytes).unwrap_or_else(new)
}

/// The words of a readback buffer, after waiting.
pub fn read_words(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u32>> {
    let pending = PendingRead::start(buffer);
    wait(gpu)?;
    pending.words(gpu)
}

/// How long an answer may take from one thread that waits on the device to another: far more than it does, so that a read
/// that is never answered is an error and no endless wait.
const PASSED_ON: Duration = Duration::from_secs(10);

/// A readback buffer that is being read once what was submitted is done.
pub struct PendingRead {
    buffer: wgpu::Buffer,
    done: Receiver<std::result::Result<(), wgpu::BufferAsyncError>>,
}

impl PendingRead {
    pub fn start(buffer: &wgpu::Buffer) -> PendingRead {
        let (send, done) = channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |r| {
            // nobody waits for what is not needed any more
            let _ = send.send(r);
        });
        PendingRead { buffer: buffer.clone(), done }
    }

    /// Its words, after waiting for the submission.
    pub fn words(self, gpu: &Gpu) -> Result<Vec<u32>> {
        let view = self.view(gpu)?;
        let words = bytemuck::pod_collect_to_vec::<u8, u32>(&view);
        drop(view);
        self.buffer.unmap();
        Ok(words)
    }

    /// Maps the buffer, after waiting for the submission. Dropping the [`Mapped`] makes the buffer spare; no other read of it may follow.
    pub fn mapped(self, gpu: &Gpu) -> Result<Mapped> {
        let view = self.view(gpu)?;
        Ok(Mapped { view: Some(view), buffer: self.buffer, spare: gpu.spare_buffers.clone() })
    }

    /// Where several threads wait on one device, wgpu may hand this read's answer to another of them, which passes it on a moment after this
    /// one's wait has ended.
    fn view(&self, gpu: &Gpu) -> Result<wgpu::BufferView> {
        let failed = |e: String| gpu.failed(format!("cannot read back: {e}"));
        self.done.recv_timeout(PASSED_ON).map_err(|e| failed(one_line(e)))?.map_err(|e| failed(one_line(e)))?;
        self.buffer.get_mapped_range(..).map_err(|e| failed(one_line(e)))
    }
}

/// A readback buffer that the host sees.
pub struct Mapped {
    /// Always there until it is dropped.
    view: Option<wgpu::BufferView>,
    buffer: wgpu::Buffer,
    spare: Arc<SpareBuffers>,
}

impl Mapped {
    /// Some of its values, each of 4 bytes.
    pub fn values<T: bytemuck::Pod>(&self, range: Range<usize>) -> &[T] {
        let bytes: &[u8] = self.view.as_deref().unwrap_or_default();
        &bytemuck::cast_slice(bytes)[range]
    }
}

impl Drop for Mapped {
    fn drop(&mut self) {
        self.view = None;
        self.buffer.unmap();
        self.spare.add(self.buffer.clone());
    }
}

/// Values that are copied by one task: 256 KiB.
const TASK: usize = 1 << 16;

/// A copy of values that lie in several places, one after another, by all cores.
pub fn joined<T: bytemuck::Pod + Send + Sync>(parts: &[&[T]]) -> Vec<T> {
    // memory of zeros costs nothing until it is written
    let mut all = vec![T::zeroed(); parts.iter().map(|part| part.len()).sum()];
    let mut rest = all.as_mut_slice();
    for part in parts {
        let (own, next) = rest.split_at_mut(part.len());
        parallel::for_each(own.chunks_mut(TASK).zip(part.chunks(TASK)), |(to, from)| to.copy_from_slice(from));
        rest = next;
    }
    all
}
