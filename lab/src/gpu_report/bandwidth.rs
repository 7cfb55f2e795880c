//! Achieved bandwidth: of control kernels, and of the stages whose bytes are known.

use crate::control::bandwidths;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::gpu::device::NO_ADAPTER;
use anamorph::internals::gpu::{Gpu, GpuOptions};
use anamorph::internals::image::frame::Channel;
use anamorph::internals::input::{Error, Loading, Result};
use anamorph::internals::scene::Scene;
use anamorph::internals::tools::example::EXAMPLES;
use serde::{Deserialize, Serialize};

/// The scene whose stages are measured.
const SCENE: &str = "city-cross-slit";

/// Pixels a side: planes that no cache holds; of a software adapter fewer, whose frames take long.
const SIDE: u64 = 2048;
const SIDE_SOFTWARE: u64 = 1024;

const FRAMES: u32 = 5;

/// Bytes of a visibility key.
const KEY_BYTES: u64 = 8;

/// Bytes of a value of a plane, and of a pixel in 8-bit sRGB.
const WORD_BYTES: u64 = 4;

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Bandwidth {
    pub kernel: String,
    /// What is counted.
    pub counted: String,
    pub bytes: u64,
    pub ms: f64,
}

impl Bandwidth {
    pub fn gb_a_second(&self) -> f64 {
        self.bytes as f64 / (1e6 * self.ms)
    }
}

/// On a device of its own, so that full memory leaves others alone. Without timestamps there are no stages.
pub fn measure(options: &GpuOptions) -> Result<Vec<Bandwidth>> {
    let gpu = Gpu::open(options)?.ok_or_else(|| Error::work(NO_ADAPTER))?;
    let control = bandwidths(&gpu)?.into_iter().map(|t| Bandwidth {
        kernel: t.kernel.into(),
        counted: format!("a list, once{}", if gpu.has.timestamps { "" } else { "; with its submission" }),
        bytes: t.bytes,
        ms: t.ms,
    });
    let control: Vec<Bandwidth> = control.collect();
    Ok(control.into_iter().chain(of_stages(Engine::new(gpu))?).collect())
}

/// What the stages that take each pixel once must read and write of it.
fn of_stages(mut engine: Engine) -> Result<Vec<Bandwidth>> {
    let folder = tempfile::tempdir().map_err(|e| Error::work(format!("no temporary folder: {e}")))?;
    let example = EXAMPLES.iter().find(|e| e.name == SCENE);
    let path = example.ok_or_else(|| Error::input(format!("there is no example {SCENE}")))?.write(folder.path())?;
    let is_software = engine.gpu.info.device_type == wgpu::DeviceType::Cpu;
    let side = if is_software { SIDE_SOFTWARE } else { SIDE };
    let size = [format!("image.width={side}"), format!("image.height={side}")];
    let scene = Scene::load(&path, &size, 0.0, &Loading::default())?;
    let camera = scene.camera()?;
    let wanted = Wanted { srgb8: true, ..Wanted::of(Channel::ALL[..10].to_vec()) };
    let run = RunOptions { repeat: FRAMES, ..Default::default() };
    let rendered = engine.render(&scene, camera, &wanted, &run)?;
    let planes = rendered.frame.planes.len() as u64;
    let stage = |name: &str, a_pixel: u64, counted: String| {
        let (_, ms) = rendered.stages.iter().find(|s| s.0 == name)?;
        Some(Bandwidth { kernel: name.into(), counted, bytes: a_pixel * side * side, ms: *ms })
    };
    let shade = stage(
        "shade",
        KEY_BYTES + planes * WORD_BYTES,
        format!("of each pixel the visibility key and {planes} channels; no triangles"),
    );
    let write = stage("write", 4 * WORD_BYTES, "of each pixel R, G, B and its 8-bit colour".into());
    Ok(shade.into_iter().chain(write).collect())
}
