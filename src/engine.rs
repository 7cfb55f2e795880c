//! The compute engine: plan, upload, stages, status, grow, image.

mod atlas;
mod encode;
mod frames;
mod illumination;
pub mod pages;
pub mod passes;
mod resident;
pub mod surface;
pub mod tables;
mod turns;

use crate::baseline::{Choice, Setup};
use crate::camera::Camera;
use crate::camera::arranged::Arrangement;
use crate::caustics::Account;
use crate::error::{Error, Result};
use crate::frame::{Channel, Frame, Plane};
use crate::gpu::Gpu;
use crate::gpu::buffers::wait;
use crate::gpu::kernels::Variant;
use crate::gpu::recorder::Recorder;
use crate::plan::samples::at_once;
use crate::plan::{Contents, LeftOut, Plan, Surroundings, Wanted};
use crate::scene::Scene;
use crate::scene::clusters::cluster;
use crate::scene::style::Style;
use crate::stage::Stages;
use crate::stage::gather::Gather;
pub use frames::Frames;
use frames::{Due, Timed};
use illumination::Illuminated;
use pages::PageStore;
use resident::Resident;
use std::borrow::Cow;
use std::sync::Arc;
use std::time::Instant;

/// Items that the lists between the stages can hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Capacities {
    /// (cluster, node) items of one cull step.
    pub queue: u64,
    /// (cluster, node) items that `split` takes.
    pub work: u64,
    /// (bunch, node) items that `bin` takes.
    pub tasks: u64,
    /// (triangle, tile) pairs.
    pub pairs: u64,
    /// Half tiles of pixels of a pair that `recheck` takes; `settle` takes two items a doubt.
    pub doubts: u64,
    /// Pixels that hold an edge, of which `sample` takes a closer look.
    pub edges: u64,
}

/// In what the signs are found that decide what a pixel sees.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Arithmetic {
    /// f32 where its bounds prove them, and recheck arithmetic elsewhere.
    #[default]
    Rechecked,
    /// f32 alone, depths and shading too.
    Single,
    /// Recheck arithmetic everywhere.
    Double,
}

/// How to run frames.
#[derive(Debug, Clone, Default)]
pub struct RunOptions {
    /// Timed frames after the first one.
    pub repeat: u32,
    /// Every vertex is new in each timed frame.
    pub moving: bool,
    /// What finds what is seen instead of the stages from cull to recheck.
    pub by: Option<Choice>,
    /// Clusters that a part of the image does not see are not left out early: `cull` hands on everything, and rivals do not clip at
    /// the edges of pieces.
    pub no_cull: bool,
    /// In what signs are found.
    pub arithmetic: Arithmetic,
    /// Triangles that a rival may draw a frame.
    pub draws_max: Option<u64>,
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
    /// Pixels that hold an edge, where they have several samples.
    pub edges: u64,
}

/// A frame and what it took.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// The wanted channels.
    pub frame: Frame,
    /// Of each sample the triangles that all pixels see there, where asked for.
    pub sample_ids: Vec<Vec<u32>>,
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

/// An open adapter with the kernels that were compiled for it.
pub struct Engine {
    pub gpu: Arc<Gpu>,
    stages: Vec<Arc<Stages>>,
    gathers: Vec<Arc<Gather>>,
    /// The caustics of the last scene that had some.
    lit: Option<Arc<Illuminated>>,
    pages: Arc<PageStore>,
}

impl Engine {
    pub fn new(gpu: Gpu) -> Engine {
        Engine { gpu: Arc::new(gpu), stages: Vec::new(), gathers: Vec::new(), lit: None, pages: Arc::default() }
    }

    /// Renders `scene` through `camera`.
    pub fn render(&mut self, scene: &Scene, camera: &Camera, wanted: &Wanted, run: &RunOptions) -> Result<Rendered> {
        let mut frames = self.prepare(scene, camera, wanted, run)?;
        for _ in 0..run.repeat {
            frames.frame()?;
        }
        frames.finish()
    }

    /// Puts everything on the device that frames of `scene` through `camera` need, and runs a first one. Of `run` all counts but
    /// how often it is repeated.
    pub fn prepare<'a>(
        &mut self,
        scene: &'a Scene,
        camera: &'a Camera,
        wanted: &Wanted,
        run: &RunOptions,
    ) -> Result<Frames<'a>> {
        let middle = Surroundings::of(camera, scene.bounds()).middle;
        let arrangement = Arrangement::of(camera, middle);
        let arranged = arrangement.as_ref().map_or(Cow::Borrowed(camera), |a| Cow::Owned(a.camera(camera)));
        let mut frames = Frames { arrangement, ..self.on_device(scene, arranged, wanted, run)? };
        check_outlines(&frames.plan, frames.arrangement.as_ref())?;
        frames.warm_up()?;
        Ok(frames)
    }

    /// A submission of one empty pass: what a frame takes that does nothing, ms.
    pub fn empty_frame(&self) -> Result<f64> {
        let started = Instant::now();
        let mut recorder = Recorder::new(&self.gpu, 1);
        drop(recorder.compute("empty"));
        recorder.submit(&self.gpu)?;
        wait(&self.gpu)?;
        Ok(started.elapsed().as_secs_f64() * 1e3)
    }

    fn on_device<'a>(
        &mut self,
        scene: &'a Scene,
        camera: Cow<'a, Camera>,
        wanted: &Wanted,
        run: &RunOptions,
    ) -> Result<Frames<'a>> {
        if wanted.channels.contains(&Channel::Certified) {
            check_provable(scene, &camera, run)?;
        }
        check_samples(scene, &camera, wanted, run.by.is_some())?;
        if let Some(choice) = run.by.filter(|_| scene.mesh.has_holes()) {
            let name = choice.technique.name;
            return Err(Error::input(format!("{name} sees no holes that images cut into triangles; use compute")));
        }
        if wanted.has_colour() {
            scene.check_shadows()?;
        }
        let mut painter = self.painter(scene, &camera, wanted, run)?;
        let mut planned = wanted.clone();
        let lit = if wanted.has_colour() { self.illuminated(scene)? } else { None };
        if lit.is_some() {
            planned.channels.extend([Channel::BaryU, Channel::BaryV]);
            if scene.mesh.is_textured() || scene.mesh.has_patterns() {
                planned.channels.extend([Channel::AlbedoR, Channel::AlbedoG, Channel::AlbedoB]);
            }
        }
        if wanted.has_colour() {
            planned.channels.extend(outlined_by(&scene.style, &camera));
        }
        let scene = scene.with_optics(&camera);
        let around = Surroundings::of(&camera, scene.bounds());
        check_size(&scene, around)?;
        let (contents, limit) = (Contents::of(&scene), self.gpu.binding_limit());
        let mut plan = Plan::new(&camera, contents, around, &planned, self.gpu.has, limit);
        plan.variant.f64 = run.arithmetic != Arithmetic::Single;
        plan.variant.culling = !run.no_cull;
        plan.variant.doubting = run.arithmetic == Arithmetic::Double;
        if self.gpu.has.lanes && self.gpu.has.f64 {
            plan.variant = plan.variant.with_tiles();
        }
        if plan.variant.outlined && painter.is_some() {
            return Err(Error::input("outlines and borders are not drawn by way of an atlas; leave atlas out"));
        }
        let stages = self.stages(plan.variant, &plan.planes)?;
        let turned =
            plan.variant.turns_rays().then(|| self.stages(plan.variant.after_turn(), &plan.planes)).transpose()?;
        let setup = setup(&camera, &plan);
        let rival = run.by.map(|choice| choice.make(&self.gpu, &scene, setup)).transpose()?;
        let caustics = lit.map(|lit| (lit, self.gather(plan.variant, &plan.planes)));
        let clustered = cluster(&scene.mesh, plan.anchor, plan.variant.textured, limit);
        if plan.variant.analytic && clustered.chunks.len() > 1 {
            let lists = clustered.chunks.len();
            let what = "analytic coverage needs all triangles in one list";
            return Err(Error::input(format!("{what}, for which the adapter takes {lists}; count samples")));
        }
        let mut resident = Resident::new(&self.gpu, &scene, &clustered, &camera, &plan, wanted, run.capacities)?;
        resident.upload_look(&self.gpu, &self.pages, &scene, &plan)?;
        let draws = rival.as_ref().map_or(0, |r| resident.chunks.iter().map(|c| r.draws(c.slots)).sum::<u64>());
        if let Some(most) = run.draws_max.filter(|most| draws > *most) {
            return Err(Error::input(format!("{draws} triangles to draw a frame; {most} are the most here")));
        }
        if let Some(painter) = &mut painter {
            painter.paints_into(&self.gpu, &mut resident.shared)?;
        }
        Ok(Frames {
            gpu: self.gpu.clone(),
            pages: self.pages.clone(),
            stages,
            turned,
            scene,
            camera,
            plan,
            wanted: wanted.clone(),
            resident,
            caustics,
            arrangement: None,
            painter,
            rival,
            kept: None,
            moving: run.moving.then_some(clustered),
            is_aimed: false,
            due: Due::All,
            timed: Timed::default(),
        })
    }

    /// The kernels of a variant, compiled once.
    fn stages(&mut self, variant: Variant, planes: &[Channel]) -> Result<Arc<Stages>> {
        if let Some(stages) = self.stages.iter().find(|s| s.variant == variant && s.planes == planes) {
            return Ok(stages.clone());
        }
        let stages = Arc::new(Stages::new(&self.gpu, variant, planes)?);
        self.stages.push(stages.clone());
        Ok(stages)
    }

    fn gather(&mut self, variant: Variant, planes: &[Channel]) -> Arc<Gather> {
        if let Some(gather) = self.gathers.iter().find(|g| g.suits(variant, planes)) {
            return gather.clone();
        }
        let gather = Arc::new(Gather::new(&self.gpu, variant, planes));
        self.gathers.push(gather.clone());
        gather
    }
}

/// What lines between pixels follow from.
fn outlined_by(style: &Style, camera: &Camera) -> Vec<Channel> {
    use Channel::{MirrorId, NormalX, NormalY, NormalZ, PieceId, PositionX, PositionY, PositionZ, TriangleId, Z};
    let mut channels = Vec::new();
    if let Some(outline) = style.outline {
        channels.extend([TriangleId, NormalX, NormalY, NormalZ, PositionX, PositionY, PositionZ]);
        channels.extend(camera.optics.as_ref().map(|_| MirrorId));
        channels.extend(outline.line.depth.is_finite().then_some(Z));
    }
    channels.extend(style.borders.map(|_| PieceId));
    if style.is_between_pixels() {
        channels.push(TriangleId);
    }
    channels
}

/// How large a scene may be, world units: beyond, f32 and pairs of it lose all.
const SIZES: [f64; 2] = [1e-12, 1e30];

/// The engine's f32 can hold the scene.
fn check_size(scene: &Scene, around: Surroundings) -> Result<()> {
    let Some((lo, hi)) = scene.bounds() else { return Ok(()) };
    let reach = (hi - around.anchor).max(around.anchor - lo).max_element();
    let [least, most] = SIZES;
    if reach > 0.0 && !(least..=most).contains(&reach) {
        let advice = "scale the scene and its camera, or use --engine reference";
        return Err(Error::input(format!("the scene reaches {reach:.1e} far, of {least:.0e} to {most:.0e}: {advice}")));
    }
    Ok(())
}

/// What is certified are the engine's own hits of rays that nothing turned.
fn check_provable(scene: &Scene, camera: &Camera, run: &RunOptions) -> Result<()> {
    if let Some(choice) = run.by {
        return Err(Error::input(format!(
            "{} proves nothing; certified is a channel of --engine compute",
            choice.technique.name
        )));
    }
    if camera.optics.is_some() {
        let kind = camera.kind;
        return Err(Error::input(format!("{kind} turns rays without bounds; certified is a channel of other cameras")));
    }
    if scene.mesh.has_holes() {
        return Err(Error::input("nothing is proven where images cut holes into triangles; leave certified out"));
    }
    Ok(())
}

/// Several samples are found by the engine's own stages, where these know the rays between pixel centres.
fn check_samples(scene: &Scene, camera: &Camera, wanted: &Wanted, by_rival: bool) -> Result<()> {
    if wanted.samples == 0 {
        return Err(Error::input("0 samples a pixel; at least 1"));
    }
    if wanted.analytic && wanted.samples == 1 {
        return Err(Error::input("analytic coverage is of what several samples of a pixel see; take at least 2"));
    }
    let is_possible = !by_rival && at_once(scene, camera, wanted.samples);
    if wanted.samples == 1 || is_possible {
        return Ok(());
    }
    let (n, kind) = (wanted.samples, camera.kind);
    Err(Error::input(format!("{n} samples a pixel of {kind} take a frame each")))
}

/// Outlines lie between pixels that are beside each other.
fn check_outlines(plan: &Plan, arrangement: Option<&Arrangement>) -> Result<()> {
    if plan.variant.outlined && plan.bands.len() > 1 {
        let rows = plan.rows_max();
        return Err(Error::input(format!(
            "outlines and borders need the whole image at once, of which the adapter holds {rows} rows; make it smaller"
        )));
    }
    if plan.variant.outlined && arrangement.is_some() {
        return Err(Error::input(
            "outlines and borders are between pixels, of which this camera's look all over; leave them out",
        ));
    }
    Ok(())
}

/// What a rival needs to know of a plan.
fn setup<'a>(camera: &'a Camera, plan: &Plan) -> Setup<'a> {
    let rows = plan.rows_max();
    Setup { camera, variant: plan.variant, rows, middle: plan.middle, anchor: plan.anchor, knob: 0 }
}

/// Joins the planes of all bands to the wanted channels of one frame, their pixels in the camera's own order.
fn join(camera: &Camera, plan: &Plan, wanted: &Wanted, arrangement: Option<&Arrangement>, bands: &[Vec<u32>]) -> Frame {
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
        let words = match arrangement {
            Some(a) => a.restored(&words),
            None => words,
        };
        let plane = match channel {
            c if c.is_id() => Plane::U32(words),
            _ => Plane::F32(words.into_iter().map(f32::from_bits).collect()),
        };
        planes.push((channel, plane));
    }
    Frame { width: camera.width, height: camera.height, planes }
}
