//! Control kernels: what memory and subgroups of an adapter do for kernels that do nothing else.

use crate::files::files;
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::buffers::{Buffers, Pipeline};
use anamorph::internals::gpu::kernels::Kernel;
use anamorph::internals::gpu::layout::GROUP;
use anamorph::internals::gpu::single::{run, words};
use anamorph::internals::input::Result;
use std::time::Instant;
use wgpu::BufferUsages;

/// Bytes of the list: more than the caches of any adapter hold.
const LIST_BYTES: u64 = 512 << 20;

/// Items of 16 bytes that a thread takes.
const ITEMS_A_THREAD: u64 = 16;

/// Runs, after one that is not timed.
const RUNS: usize = 9;

/// Reads a list, 16 bytes an item.
pub fn read_only() -> Kernel {
    alone("control/read_only.wgsl")
}

/// Writes a list, 16 bytes an item.
pub fn write_only() -> Kernel {
    alone("control/write_only.wgsl")
}

/// Asks the threads of a workgroup how wide their subgroups are.
pub fn subgroup_width() -> Kernel {
    alone("control/subgroup_width.wgsl")
}

fn alone(entry: &'static str) -> Kernel {
    Kernel::of(files(), entry, &|_| &[], &|_| None)
}

/// A control kernel's time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timed {
    pub kernel: &'static str,
    /// That it reads or writes.
    pub bytes: u64,
    /// The median of its runs: on the device with timestamps, else of the submission.
    pub ms: f64,
}

/// Times writing, then reading, a list of up to [`LIST_BYTES`].
///
/// # Errors
/// [`anamorph::internals::input::Error::Work`] if the device fails: its memory may be full.
pub fn bandwidths(gpu: &Gpu) -> Result<Vec<Timed>> {
    let bytes = LIST_BYTES.min(gpu.binding_limit() / 16 * 16);
    let mut buffers = Buffers::default();
    buffers.create(gpu, "list", bytes, BufferUsages::empty())?;
    buffers.create(gpu, "found", 4, BufferUsages::empty())?;
    [write_only(), read_only()].map(|kernel| time(gpu, kernel, &buffers, bytes)).into_iter().collect()
}

fn time(gpu: &Gpu, kernel: Kernel, buffers: &Buffers, bytes: u64) -> Result<Timed> {
    let name = kernel.name;
    let pipeline = Pipeline::new(gpu, kernel)?;
    let groups = (bytes / 16).div_ceil(ITEMS_A_THREAD * u64::from(GROUP)) as u32;
    let groups = groups.min(gpu.limits.max_compute_workgroups_per_dimension);
    let mut times = Vec::new();
    for _ in 0..=RUNS {
        let started = Instant::now();
        let stages = run(gpu, name, &pipeline, buffers, groups)?.stage_ms(gpu)?;
        let wall_ms = started.elapsed().as_secs_f64() * 1e3;
        times.push(stages.first().map_or(wall_ms, |stage| stage.1));
    }
    let mut ms = times.split_off(1);
    ms.sort_by(f64::total_cmp);
    Ok(Timed { kernel: name, bytes, ms: ms[RUNS / 2] })
}

/// The least and the most threads of the subgroups that a workgroup runs in; `None` where kernels may not ask.
///
/// # Errors
/// [`anamorph::internals::input::Error::Work`] if the device fails.
pub fn subgroup_widths(gpu: &Gpu) -> Result<Option<[u32; 2]>> {
    if !gpu.has.lanes {
        return Ok(None);
    }
    let mut buffers = Buffers::default();
    buffers.create(gpu, "found", 4 * u64::from(GROUP), BufferUsages::empty())?;
    run(gpu, "subgroup_width", &Pipeline::new(gpu, subgroup_width())?, &buffers, 1)?;
    let widths = buffers.get("found").map(|found| words(gpu, found)).transpose()?.unwrap_or_default();
    Ok(widths.iter().min().copied().zip(widths.iter().max().copied()).map(|(least, most)| [least, most]))
}
