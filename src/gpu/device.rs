//! Adapter selection, its abilities, and the code paths that they select.

use super::buffers::{Pipelines, table_limit};
use super::compile::Dump;
use super::exact;
use super::kernels::File;
use super::layout::LANES;
use super::needs::{STORAGE_BUFFERS_BY_TILE, lacks};
use super::readback::SpareBuffers;
use crate::input::limits::free_addresses;
use crate::input::{Error, Result};
use serde::Serialize;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};

/// The user's choice of adapter and features.
#[derive(Debug, Clone, Default)]
pub struct GpuOptions {
    /// Part of the wanted adapter's [`label`], any case.
    pub adapter: Option<String>,
    /// How many of these to skip: a machine may have several of one name.
    pub skipped: usize,
    /// Do not use 64-bit atomics even if available.
    pub no_int64: bool,
    /// Do not use the adapter's f64 even if available: emulate it in 32-bit words.
    pub no_f64: bool,
    /// A folder into which the source of every compiled kernel is written.
    pub dump_kernels: Option<PathBuf>,
}

/// An open device and the abilities of its adapter.
pub struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub info: wgpu::AdapterInfo,
    pub limits: wgpu::Limits,
    /// The largest texture that holds a table of triangles or vertices, bytes.
    pub table_limit: u64,
    pub has: AdapterFeatures,
    /// Files that kernels are compiled with instead of those of the same paths: tests plant errors by them.
    pub replaced: Vec<&'static File>,
    /// What wgpu adds to kernels, see [`Gpu::with_checks`].
    checks: wgpu::ShaderRuntimeChecks,
    /// Writes the kernels' sources.
    pub(super) dump: Option<Dump>,
    pub(super) pipelines: Arc<Pipelines>,
    pub(super) spare_buffers: Arc<SpareBuffers>,
    /// The first error that the device reported outside a call.
    failed: Arc<Mutex<Option<String>>>,
}

/// Abilities of an adapter that select code paths.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct AdapterFeatures {
    /// f64 and 64-bit integers: rechecks, depths and shading in the adapter's own f64; without them in 32-bit words.
    pub f64: bool,
    /// A CPU runs the kernels: a subgroup is one of its threads, and f64 takes it at most some times as long as f32.
    pub software: bool,
    /// Its f64 failed the test at opening: see [`super::exact`].
    #[serde(skip)]
    pub f64_is_wrong: bool,
    /// 64-bit atomic minimum and maximum: one dispatch for the depth test instead of two.
    pub atomics64: bool,
    /// Subgroups of at least as many threads as a tile has columns: `raster` can go tile by tile, and on a CPU `small` can draw
    /// small triangles.
    pub lanes: bool,
    /// Some subgroups have more threads than that.
    pub wide: bool,
    /// Raster rather goes pair by pair where the adapter has f64 and 64-bit atomics too: so more of a GPU's threads are busy.
    pub by_pair: bool,
    /// Times of single stages.
    pub timestamps: bool,
    /// Clip distances: rivals clip at the edges of a camera's pieces.
    pub clip_distances: bool,
    /// The rasterizer counts what it does.
    #[serde(skip)]
    pub draw_counts: bool,
}

impl AdapterFeatures {
    pub fn of(features: wgpu::Features, info: &wgpu::AdapterInfo, limits: &wgpu::Limits) -> AdapterFeatures {
        let int64 = features.contains(wgpu::Features::SHADER_INT64);
        let lanes = features.contains(wgpu::Features::SUBGROUP)
            && info.subgroup_min_size >= LANES
            && limits.max_storage_buffers_per_shader_stage >= STORAGE_BUFFERS_BY_TILE;
        AdapterFeatures {
            f64: int64 && features.contains(wgpu::Features::SHADER_F64),
            software: info.device_type == wgpu::DeviceType::Cpu,
            f64_is_wrong: false,
            atomics64: int64 && features.contains(wgpu::Features::SHADER_INT64_ATOMIC_MIN_MAX),
            lanes,
            wide: lanes && info.subgroup_max_size > LANES,
            by_pair: info.device_type != wgpu::DeviceType::Cpu,
            timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
            clip_distances: features.contains(wgpu::Features::CLIP_DISTANCES),
            draw_counts: features.contains(wgpu::Features::PIPELINE_STATISTICS_QUERY),
        }
    }

    /// Raster goes tile by tile.
    pub fn by_tile(self) -> bool {
        self.lanes && !(self.by_pair && self.f64 && self.atomics64)
    }

    /// The features that these abilities need.
    pub fn features(self) -> wgpu::Features {
        let mut features = wgpu::Features::empty();
        features.set(wgpu::Features::SHADER_INT64, self.f64 || self.atomics64);
        features.set(wgpu::Features::SHADER_F64, self.f64);
        features.set(wgpu::Features::SHADER_INT64_ATOMIC_MIN_MAX, self.atomics64);
        features.set(wgpu::Features::SUBGROUP, self.lanes);
        features.set(wgpu::Features::TIMESTAMP_QUERY, self.timestamps);
        features.set(wgpu::Features::CLIP_DISTANCES, self.clip_distances);
        features.set(wgpu::Features::PIPELINE_STATISTICS_QUERY, self.draw_counts);
        features
    }
}

/// All checks, but on a GPU a count of each loop's rounds, which would end it after 2^64 of them: it takes a tenth of the time of raster and
/// trace on an NVIDIA H200, and the loops of all kernels go over lists, levels and rows, or have a largest number of rounds. Without it
/// lavapipe of Mesa 22.3.6 loses pixels in `small`.
fn default_checks(has: AdapterFeatures) -> wgpu::ShaderRuntimeChecks {
    wgpu::ShaderRuntimeChecks { force_loop_bounding: has.software, ..wgpu::ShaderRuntimeChecks::checked() }
}

/// Backends whose adapters are opened where this build has them, the best one of an adapter first: of all that wgpu drives, Vulkan
/// alone offers f64 to kernels.
const BACKENDS: [wgpu::Backends; 3] = [wgpu::Backends::VULKAN, wgpu::Backends::METAL, wgpu::Backends::DX12];

/// The adapters of this machine under every backend: those that can run the kernels first, of these the fastest kind. A GPU with drivers
/// for two backends is there twice.
pub fn adapters() -> Vec<wgpu::Adapter> {
    let mut adapters: Vec<wgpu::Adapter> = BACKENDS.into_iter().flat_map(of_backend).collect();
    // stable: the better backend stays first
    adapters.sort_by_key(|a| {
        let kind = match a.get_info().device_type {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Other => 3,
            wgpu::DeviceType::Cpu => 4,
        };
        (lacks(&a.limits()).is_some(), kind)
    });
    adapters
}

fn of_backend(backends: wgpu::Backends) -> Vec<wgpu::Adapter> {
    let flags = match backends {
        // without it `num_workgroups` is 0 in an indirect dispatch there
        wgpu::Backends::DX12 => wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL,
        // `args` bounds every indirect dispatch itself: no second check
        _ => wgpu::InstanceFlags::empty(),
    };
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        flags,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    pollster::block_on(instance.enumerate_adapters(backends))
}

/// An adapter's name, and its backend in brackets.
pub fn label(info: &wgpu::AdapterInfo) -> String {
    format!("{} ({})", info.name, info.backend)
}

/// Advice for a machine without adapters.
pub const NO_ADAPTER: &str = if cfg!(target_vendor = "apple") {
    "no Metal adapter found"
} else if cfg!(windows) {
    "no Vulkan or DirectX 12 adapter found; install the driver of a GPU"
} else {
    "no Vulkan adapter found; install a driver (on Debian or Ubuntu the software one: apt-get install mesa-vulkan-drivers)"
};

/// Address space that a software driver takes to compile and run a frame's kernels. Frames with caustics on lavapipe (Mesa 22.3.6, two cores)
/// work with 433 MiB; with 336 MiB the driver fails, and with less it may end the process by a signal.
const SOFTWARE_ADDRESSES: u64 = 400 << 20;

impl Gpu {
    /// Opens the chosen adapter, or the first; `Ok(None)` if the machine has none.
    pub fn open(options: &GpuOptions) -> Result<Option<Gpu>> {
        let adapters = adapters();
        let names: Vec<String> = adapters.iter().map(|a| label(&a.get_info())).collect();
        let wanted = options.adapter.as_deref().map(str::to_lowercase);
        let adapter = match &wanted {
            None if options.skipped >= adapters.len() && !adapters.is_empty() => {
                let (number, count) = (options.skipped, adapters.len());
                return Err(Error::input(format!(
                    "no adapter number {number}: there are {count}, from 0: {}",
                    names.join(", ")
                )));
            }
            None => adapters.into_iter().nth(options.skipped),
            Some(w) => {
                let named = |a: &wgpu::Adapter| label(&a.get_info()).to_lowercase().contains(w);
                let found = adapters.into_iter().filter(named).nth(options.skipped);
                if found.is_none() {
                    let names = if names.is_empty() { "none".into() } else { names.join(", ") };
                    return Err(Error::input(format!("--adapter {w}: no such adapter; there is: {names}")));
                }
                found
            }
        };
        adapter.map(|a| Gpu::from_adapter(&a, options)).transpose()
    }

    /// Opens an adapter; without its f64, if that is wrong.
    pub fn from_adapter(adapter: &wgpu::Adapter, options: &GpuOptions) -> Result<Gpu> {
        let info = adapter.get_info();
        let limits = adapter.limits();
        let mut has = AdapterFeatures::of(adapter.features(), &info, &limits);
        has.atomics64 &= !options.no_int64;
        has.f64 &= !options.no_f64;
        if let Some(lack) = lacks(&limits) {
            return Err(Error::work(format!("adapter {}: {lack}; use --engine reference", label(&info))));
        }
        let free = free_addresses().unwrap_or(u64::MAX);
        if info.device_type == wgpu::DeviceType::Cpu && free < SOFTWARE_ADDRESSES {
            let mib = |bytes: u64| bytes >> 20;
            return Err(Error::work(format!(
                "adapter {}: {} MiB of the address space are left (ulimit -v), and a software driver takes {} MiB; raise the limit, or use \
                 --engine reference",
                label(&info),
                mib(free),
                mib(SOFTWARE_ADDRESSES)
            )));
        }
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("anamorph"),
            required_features: has.features(),
            required_limits: limits.clone(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|e| Error::work(format!("adapter {}: cannot open it: {}", label(&info), one_line(e))))?;
        let failed = Arc::new(Mutex::new(None));
        let (uncaptured, lost) = (failed.clone(), failed.clone());
        device.on_uncaptured_error(Arc::new(move |e| note(&uncaptured, described(&e))));
        device.set_device_lost_callback(move |reason, text| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                note(&lost, format!("device lost: {}", one_line(text)));
            }
        });
        let dump = options.dump_kernels.as_deref().map(Dump::new).transpose()?;
        let mut gpu = Gpu {
            device,
            queue,
            info,
            table_limit: table_limit(&limits),
            limits,
            has,
            replaced: Vec::new(),
            checks: default_checks(has),
            dump,
            pipelines: Arc::default(),
            spare_buffers: Arc::default(),
            failed,
        };
        // that backend runs nothing
        if gpu.info.backend != wgpu::Backend::Noop {
            exact::check(&mut gpu)?;
        }
        Ok(gpu)
    }

    /// The same open device once more: what the one compiles the other need not, and what fails has failed for both. The sources of its
    /// kernels are not written.
    #[cfg(feature = "internals")]
    pub fn shared(&self) -> Gpu {
        Gpu {
            device: self.device.clone(),
            queue: self.queue.clone(),
            info: self.info.clone(),
            table_limit: self.table_limit,
            limits: self.limits.clone(),
            has: self.has,
            replaced: self.replaced.clone(),
            checks: self.checks,
            dump: None,
            pipelines: self.pipelines.clone(),
            spare_buffers: Arc::default(),
            failed: self.failed.clone(),
        }
    }

    /// Compiles kernels from here on with these checks. No kernel should need any; the tests render the same frames with all and none.
    ///
    /// # Safety
    ///
    /// Without checks, a kernel that reads or writes beyond a buffer, divides by 0 or does not end does so.
    #[cfg(feature = "internals")]
    pub unsafe fn with_checks(&mut self, checks: wgpu::ShaderRuntimeChecks) {
        (self.checks, self.pipelines) = (checks, Arc::default());
    }

    /// A module, with those checks.
    pub(super) fn create_module(&self, descriptor: wgpu::ShaderModuleDescriptor<'_>) -> wgpu::ShaderModule {
        // SAFETY: every loop of the kernels ends, see [`default_checks`]; for fewer checks, whoever asked vouches
        unsafe { self.device.create_shader_module_trusted(descriptor, self.checks) }
    }

    /// The first error that the device reported, if any.
    pub fn failure(&self) -> Result<()> {
        match self.failed.lock().unwrap_or_else(|e| e.into_inner()).clone() {
            Some(text) => Err(self.error(&text)),
            None => Ok(()),
        }
    }

    /// The device has failed: has [`Gpu::failure`] report this too, unless something failed before.
    pub fn failed(&self, text: String) -> Error {
        let error = self.error(&text);
        note(&self.failed, text);
        error
    }

    fn error(&self, text: &str) -> Error {
        Error::work(format!("adapter {}: {text}", self.info.name))
    }

    /// The largest buffer that one kernel can see whole, bytes.
    pub fn binding_limit(&self) -> u64 {
        self.limits.max_storage_buffer_binding_size.min(self.limits.max_buffer_size)
    }
}

/// Keeps the first.
fn note(failed: &Mutex<Option<String>>, text: String) {
    failed.lock().unwrap_or_else(|e| e.into_inner()).get_or_insert(text);
}

/// The device's error, with advice if its memory is full.
fn described(e: &wgpu::Error) -> String {
    match e {
        wgpu::Error::OutOfMemory { .. } => {
            "its memory is full; make the image smaller, ask for fewer --channels, or end other programs that use it"
                .into()
        }
        other => one_line(other),
    }
}

/// An error's text on one line.
pub fn one_line(e: impl std::fmt::Display) -> String {
    e.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}
