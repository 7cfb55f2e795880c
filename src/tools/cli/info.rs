//! `anamorph info`: the adapters, what they can do, and which code paths that selects.

mod contents;
mod lens;

use super::args::InfoArgs;
use crate::gpu::device::{AdapterFeatures, NO_ADAPTER, adapters};
use crate::gpu::needs::lacks;
use crate::input::Result;
use serde::Serialize;
use std::fmt;

#[derive(Serialize)]
struct Info {
    version: &'static str,
    /// The engine that `render` takes by default.
    engine: &'static str,
    adapters: Vec<AdapterInfo>,
}

#[derive(Serialize)]
struct AdapterInfo {
    name: String,
    driver: String,
    kind: String,
    backend: String,
    /// Whether `render` uses this one by default.
    chosen: bool,
    abilities: AdapterFeatures,
    limits: Limits,
    paths: Paths,
}

/// Limits that determine bands and chunks of a frame.
#[derive(Serialize)]
struct Limits {
    /// Bytes of one list or table, and of a band of the image.
    max_storage_buffer_binding_size: u64,
    max_buffer_size: u64,
    max_storage_buffers_per_shader_stage: u32,
    max_compute_workgroups_per_dimension: u32,
    max_compute_workgroup_storage_size: u32,
    /// Threads of a subgroup, least and most.
    subgroup_size: [u32; 2],
}

/// The code path that each ability selects.
#[derive(Serialize)]
struct Paths {
    arithmetic: &'static str,
    depth_test: &'static str,
    mapping: &'static str,
    stage_times: &'static str,
    clipping: &'static str,
    usable: String,
}

pub fn run(args: &InfoArgs) -> Result<()> {
    if let Some(file) = &args.file {
        return contents::run(file, args.json, args.caps.limits());
    }
    let of_adapter = |(k, adapter): (usize, &wgpu::Adapter)| {
        let (info, limits) = (adapter.get_info(), adapter.limits());
        about(&info, &limits, AdapterFeatures::of(adapter.features(), &info, &limits), k == 0)
    };
    let adapters: Vec<AdapterInfo> = adapters().iter().enumerate().map(of_adapter).collect();
    let engine = if adapters.is_empty() { "reference" } else { "compute" };
    contents::show(&Info { version: env!("CARGO_PKG_VERSION"), engine, adapters }, args.json)
}

/// An open device's adapter, in lines.
#[cfg(feature = "internals")]
pub fn lines(gpu: &crate::gpu::Gpu) -> String {
    about(&gpu.info, &gpu.limits, gpu.has, false).to_string().trim_start().to_owned()
}

fn about(info: &wgpu::AdapterInfo, limits: &wgpu::Limits, has: AdapterFeatures, chosen: bool) -> AdapterInfo {
    let either = |ability: bool, yes: &'static str, no: &'static str| if ability { yes } else { no };
    AdapterInfo {
        name: info.name.clone(),
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        kind: format!("{:?}", info.device_type),
        backend: info.backend.to_string(),
        chosen,
        abilities: has,
        limits: Limits {
            max_storage_buffer_binding_size: limits.max_storage_buffer_binding_size,
            max_buffer_size: limits.max_buffer_size,
            max_storage_buffers_per_shader_stage: limits.max_storage_buffers_per_shader_stage,
            max_compute_workgroups_per_dimension: limits.max_compute_workgroups_per_dimension,
            max_compute_workgroup_storage_size: limits.max_compute_workgroup_storage_size,
            subgroup_size: [info.subgroup_min_size, info.subgroup_max_size],
        },
        paths: Paths {
            arithmetic: either(
                has.f64,
                "f32 with f64 where a sign is uncertain; depth and shading in f64 (--no-f64: as without)",
                "f32 with f64 in 32-bit words where a sign is uncertain; so are depth and shading",
            ),
            depth_test: either(
                has.atomics64,
                "one dispatch, 64-bit atomics (--no-int64: two)",
                "two dispatches, 32-bit atomics",
            ),
            mapping: match has.by_tile() {
                true if has.wide => "tile by tile, a column a thread, several tiles a subgroup",
                true => "tile by tile, a column a thread",
                false => "pair by pair",
            },
            stage_times: either(has.timestamps, "GPU timestamps", "none"),
            clipping: either(
                has.clip_distances,
                "yes",
                "none: raster-* are refused but raster-cubemap and raster-image",
            ),
            usable: lacks(limits).map_or("yes".into(), |lack| format!("no: {lack}; use --engine reference")),
        },
    }
}

impl fmt::Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "anamorph {}", self.version)?;
        if self.adapters.is_empty() {
            return writeln!(f, "{NO_ADAPTER}\nrender uses the CPU: --engine reference");
        }
        self.adapters.iter().try_for_each(|a| a.fmt(f))
    }
}

impl fmt::Display for AdapterInfo {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let chosen = if self.chosen { ", chosen by default" } else { "" };
        let yes = |ability: bool| if ability { "yes" } else { "no" };
        let (has, limits, paths) = (&self.abilities, &self.limits, &self.paths);
        writeln!(f, "\n{} ({}, {}{chosen})", self.name, self.backend, self.kind)?;
        writeln!(f, "  driver            {}", self.driver)?;
        writeln!(f, "  usable            {}", paths.usable)?;
        writeln!(f, "  f64               {:<4} -> {}", yes(has.f64), paths.arithmetic)?;
        writeln!(f, "  64-bit atomics    {:<4} -> {}", yes(has.atomics64), paths.depth_test)?;
        writeln!(f, "  lanes of a tile   {:<4} -> raster: {}", yes(has.lanes), paths.mapping)?;
        writeln!(f, "  timestamps        {:<4} -> stage times: {}", yes(has.timestamps), paths.stage_times)?;
        writeln!(f, "  clip distances    {:<4} -> rivals that clip: {}", yes(has.clip_distances), paths.clipping)?;
        writeln!(f, "  storage binding   {} bytes at most", limits.max_storage_buffer_binding_size)?;
        writeln!(f, "  buffer            {} bytes at most", limits.max_buffer_size)?;
        writeln!(f, "  storage buffers   {} a kernel", limits.max_storage_buffers_per_shader_stage)?;
        writeln!(f, "  workgroups        {} a dimension", limits.max_compute_workgroups_per_dimension)?;
        writeln!(f, "  workgroup memory  {} bytes", limits.max_compute_workgroup_storage_size)?;
        writeln!(f, "  subgroup          {} to {} threads", limits.subgroup_size[0], limits.subgroup_size[1])
    }
}
