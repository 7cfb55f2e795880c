//! Runs one kernel by itself, and reads a buffer.

use super::Gpu;
use super::buffers::{Buffers, Pipeline, wait};
use super::readback::{read_words, readback};
use super::recorder::{Recorded, Recorder};
use crate::input::Result;

/// Submits so many workgroups of a kernel.
///
/// # Errors
/// [`crate::input::Error::Work`] if the device fails.
pub fn run(gpu: &Gpu, name: &'static str, pipeline: &Pipeline, buffers: &Buffers, groups: u32) -> Result<Recorded> {
    let group = pipeline.bind(gpu, &[buffers])?;
    let mut recorder = Recorder::new(gpu, 1);
    let mut pass = recorder.compute(name);
    pass.set_pipeline(pipeline.raw());
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(groups, 1, 1);
    drop(pass);
    let recorded = recorder.submit(gpu)?;
    // without timestamps nothing else waits
    wait(gpu)?;
    Ok(recorded)
}

/// The words of a buffer.
///
/// # Errors
/// [`crate::input::Error::Work`] if the device fails.
pub fn words(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u32>> {
    let list = readback(gpu, buffer.size());
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &list, 0, buffer.size());
    gpu.queue.submit([encoder.finish()]);
    read_words(gpu, &list)
}
