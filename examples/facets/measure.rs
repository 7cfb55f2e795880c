//! Frames of the examples with some keys set: how long they take, and how far they are from the truth.

use anamorph::camera::Camera;
use anamorph::compare::compare;
use anamorph::engine::{Engine, RunOptions};
use anamorph::error::{Error, Result};
use anamorph::example::EXAMPLES;
use anamorph::frame::{Channel, Frame, NO_ID};
use anamorph::gpu::Gpu;
use anamorph::gpu::device::NO_ADAPTER;
use anamorph::optics::atlas::Layout;
use anamorph::plan::Wanted;
use anamorph::scene::Scene;
use std::path::{Path, PathBuf};

/// Timed frames, after one that is not.
const RUNS: u32 = 3;

pub struct Bench {
    engine: Engine,
    folder: PathBuf,
}

/// A picture and what it took.
pub struct Shown {
    pub frame: Frame,
    /// Of one frame, the median; with the scene's caustics.
    pub ms: f64,
    /// Of the scene, without the optics' own.
    pub triangles: usize,
    /// Pieces of the optics; of a camera without any its own.
    pub cameras: usize,
}

/// What is looked at in a picture.
#[derive(Clone, Copy, PartialEq)]
pub enum Look {
    /// Every channel of a scene that stands still.
    All,
    /// Colours, and the ids that tell what is wrong.
    Colours { moving: bool },
}

impl Bench {
    pub fn open(folder: &Path) -> Result<Bench> {
        let gpu = Gpu::open(&Default::default())?.ok_or_else(|| Error::work(NO_ADAPTER))?;
        Ok(Bench { engine: Engine::new(gpu), folder: folder.to_owned() })
    }

    pub fn adapter(&self) -> &str {
        &self.engine.gpu.info.name
    }

    pub fn is_software(&self) -> bool {
        self.engine.gpu.info.device_type == wgpu::DeviceType::Cpu
    }

    /// Whether the adapter binds an atlas of so many facets and texels a side; its planes are those of the picture but the last.
    pub fn fits(&self, facets: u32, texels: u32, look: Look) -> bool {
        let (width, height) = Layout::new(facets as usize, texels).size();
        let planes = look.channels().len() as u64 - 1;
        4 * planes * u64::from(width) * u64::from(height) <= self.engine.gpu.binding_limit()
    }

    /// Writes an example's files; the path of its scene.
    pub fn example(&self, name: &str) -> Result<PathBuf> {
        let example = EXAMPLES.iter().find(|e| e.name == name);
        example.ok_or_else(|| Error::work(format!("no example {name}")))?.write(&self.folder)
    }

    /// The picture of a scene with some keys set, and its median time.
    pub fn shown(&mut self, path: &Path, keys: &[String], look: Look) -> Result<Shown> {
        let scene = Scene::load(path, keys, 0.0)?;
        let camera = scene.camera()?;
        let wanted = look.wanted(&camera);
        let (still, moving) = (
            RunOptions { repeat: RUNS, ..Default::default() },
            RunOptions { repeat: RUNS, moving: true, ..Default::default() },
        );
        let (shown, times) = if look == (Look::Colours { moving: true }) {
            let shown = self.engine.render(&scene, &camera, &wanted, &RunOptions::default())?;
            (shown, self.engine.render(&scene, &camera, &wanted, &moving)?.frame_ms)
        } else {
            let shown = self.engine.render(&scene, &camera, &wanted, &still)?;
            let times = shown.frame_ms.clone();
            (shown, times)
        };
        let lit = match shown.caustics {
            Some(_) => self.caustics_ms(path, keys, &wanted)?,
            None => 0.0,
        };
        let optics = camera.optics.as_ref().map(|o| o.camera_count());
        Ok(Shown {
            frame: shown.frame,
            ms: median(times) + lit,
            triangles: scene.mesh.triangles.len(),
            cameras: optics.unwrap_or(camera.piece_count()),
        })
    }

    /// The picture alone.
    pub fn frame(&mut self, path: &Path, keys: &[String]) -> Result<Frame> {
        let scene = Scene::load(path, keys, 0.0)?;
        let camera = scene.camera()?;
        let wanted = Look::Colours { moving: false }.wanted(&camera);
        Ok(self.engine.render(&scene, &camera, &wanted, &RunOptions::default())?.frame)
    }

    /// The median time of a scene's caustics. A scene that was loaded again has new ones.
    fn caustics_ms(&mut self, path: &Path, keys: &[String], wanted: &Wanted) -> Result<f64> {
        let mut times = Vec::new();
        for _ in 0..RUNS {
            let scene = Scene::load(path, keys, 0.0)?;
            let rendered = self.engine.render(&scene, &scene.camera()?, wanted, &RunOptions::default())?;
            times.extend(rendered.caustics.map(|c| c.ms));
        }
        Ok(median(times))
    }
}

impl Look {
    fn channels(self) -> &'static [Channel] {
        match self {
            Look::All => &Channel::ALL,
            Look::Colours { .. } => &[Channel::R, Channel::G, Channel::B, Channel::TriangleId, Channel::MirrorId],
        }
    }

    fn wanted(self, camera: &Camera) -> Wanted {
        let channels = Channel::of(camera).into_iter().filter(|c| self.channels().contains(c)).collect();
        Wanted { channels, srgb8: false, counting: false }
    }
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
}

/// How a picture differs from the truth.
pub struct Difference {
    /// Pixels that show another triangle, of those that see the mirror in the truth.
    pub wrong: usize,
    pub pixels: usize,
    pub psnr: f64,
}

impl Difference {
    pub fn of(frame: &Frame, truth: &Frame) -> Difference {
        let ids = |f: &Frame, c: Channel| f.u32(c).map(<[u32]>::to_vec).unwrap_or_default();
        let (mirror, seen, known) =
            (ids(truth, Channel::MirrorId), ids(frame, Channel::TriangleId), ids(truth, Channel::TriangleId));
        let pixels: Vec<usize> = (0..mirror.len()).filter(|&k| mirror[k] != NO_ID).collect();
        let wrong = pixels.iter().filter(|&&k| seen[k] != known[k]).count();
        let psnr = compare(frame, truth, None, None).ok().and_then(|c| c.psnr).unwrap_or(f64::NAN);
        Difference { wrong, pixels: pixels.len(), psnr }
    }

    pub fn share(&self) -> f64 {
        self.wrong as f64 / self.pixels as f64
    }
}
