//! The compute engine: plan, upload, stages, status, grow, image.

mod atlas;
mod frames;
mod illumination;
pub mod passes;
mod resident;
pub mod surface;
pub mod tables;
mod turns;

use crate::camera::Camera;
use crate::caustics::Account;
use crate::error::{Error, Result};
use crate::frame::{Channel, Frame, Plane};
use crate::gpu::Gpu;
use crate::gpu::kernels::Variant;
use crate::plan::{LeftOut, Plan, Surroundings, Wanted};
use crate::scene::Scene;
use crate::stage::Stages;
use crate::stage::gather::Gather;
use illumination::Illuminated;
use resident::Resident;

/// Items that the lists between the stages can hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Capacities {
    /// (cluster, node) items of one cull step.
    pub queue: u64,
    /// (cluster, node) items that `bin` takes.
    pub work: u64,
    /// (triangle, cell) pairs.
    pub pairs: u64,
}

/// How to run frames.
#[derive(Debug, Clone, Default)]
pub struct RunOptions {
    /// Timed frames after the first one.
    pub repeat: u32,
    /// Every vertex is new in each timed frame.
    pub moving: bool,
    /// Where the lists start; `None`: from the scene's size. They grow as needed.
    pub capacities: Option<Capacities>,
}

/// What the stages counted in one frame.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    pub pairs_tested: u64,
    pub pairs_kept: u64,
    pub fragments_tested: u64,
    pub fragments_kept: u64,
    pub rechecked: u64,
}

/// A frame and what it took.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// The wanted channels.
    pub frame: Frame,
    /// RGBA, 8-bit sRGB, where asked for.
    pub srgb8: Option<Vec<u8>>,
    /// Wall time of each timed frame, ms; of the first one where none was asked for.
    pub frame_ms: Vec<f64>,
    /// Median GPU time of each stage, ms; empty without timestamps.
    pub stages: Vec<(&'static str, f64)>,
    pub counts: Counts,
    /// Device memory held, bytes.
    pub bytes: u64,
    pub left_out: Vec<LeftOut>,
    /// How many times the lists had to grow.
    pub grown: u32,
    /// Compute passes of one frame.
    pub passes: u32,
    /// Where the light of the scene's caustics went, where the frame shows them.
    pub caustics: Option<Account>,
}

/// An open adapter with its compiled kernels.
pub struct Engine {
    pub gpu: Gpu,
    stages: Option<Stages>,
    /// For rays that were turned.
    turned: Option<Stages>,
    /// The caustics of the last scene that had some.
    lit: Option<Illuminated>,
    gather: Option<Gather>,
}

impl Engine {
    pub fn new(gpu: Gpu) -> Engine {
        Engine { gpu, stages: None, turned: None, lit: None, gather: None }
    }

    /// Renders `scene` through `camera`.
    pub fn render(&mut self, scene: &Scene, camera: &Camera, wanted: &Wanted, run: &RunOptions) -> Result<Rendered> {
        let atlas = self.atlas(scene, camera, wanted, run)?;
        let mut planned = wanted.clone();
        let shows_caustics = scene.caustics.is_some() && wanted.has_colour();
        if shows_caustics {
            self.illuminated(scene)?;
            planned.channels.extend([Channel::BaryU, Channel::BaryV]);
        }
        let scene = &*scene.with_optics(camera);
        let around = Surroundings::of(camera, scene.bounds());
        let has_normals = !scene.mesh.normals.is_empty();
        let limit = self.gpu.binding_limit();
        let triangles = scene.mesh.triangles.len();
        let plan = Plan::new(camera, triangles, has_normals, around, &planned, self.gpu.has, limit);
        let compile = |stages: &mut Option<Stages>, variant: Variant| {
            if stages.as_ref().is_none_or(|s| s.variant != variant || s.planes != plan.planes) {
                *stages = Some(Stages::new(&self.gpu, variant, &plan.planes)?);
            }
            Ok(())
        };
        compile(&mut self.stages, plan.variant)?;
        if plan.variant.turns_rays() {
            compile(&mut self.turned, plan.variant.after_turn())?;
        }
        if shows_caustics && self.gather.as_ref().is_none_or(|g| !g.suits(plan.variant, &plan.planes)) {
            self.gather = Some(Gather::new(&self.gpu, plan.variant, &plan.planes));
        }
        let caustics = self.lit.as_ref().zip(self.gather.as_ref()).filter(|_| shows_caustics);
        let Some(stages) = &self.stages else { return Err(Error::work("no kernels")) };
        let turned = self.turned.as_ref();
        let mut resident = Resident::new(&self.gpu, scene, camera, &plan, wanted, run.capacities)?;
        if let Some(atlas) = &atlas {
            atlas.upload(&self.gpu, &mut resident.shared)?;
        }
        let frames =
            frames::Frames { gpu: &self.gpu, stages, turned, scene, camera, plan: &plan, wanted, resident, caustics };
        let rendered = frames.run(run)?;
        Ok(match atlas {
            Some(atlas) => atlas.joined(rendered),
            None => rendered,
        })
    }
}

/// Joins the planes of all bands to the wanted channels of one frame.
fn join(camera: &Camera, plan: &Plan, wanted: &Wanted, bands: &[Vec<u32>]) -> Frame {
    let mut planes = Vec::new();
    for (k, &channel) in plan.planes.iter().enumerate() {
        if !wanted.channels.contains(&channel) {
            continue;
        }
        let mut words: Vec<u32> = Vec::with_capacity(camera.width as usize * camera.height as usize);
        for (band, data) in plan.bands.iter().zip(bands) {
            let pixels = band.rows as usize * camera.width as usize;
            words.extend_from_slice(&data[k * pixels..(k + 1) * pixels]);
        }
        let plane = match channel {
            c if c.is_id() => Plane::U32(words),
            _ => Plane::F32(words.into_iter().map(f32::from_bits).collect()),
        };
        planes.push((channel, plane));
    }
    Frame { width: camera.width, height: camera.height, planes }
}
