//! The compute engine: plan, upload, stages, status, grow, image.

pub mod accumulation;
mod atlas;
mod bounce_tables;
pub mod bounces;
pub mod buffer_table;
pub mod call_ms;
mod caustics;
pub mod changes;
pub mod clusters;
pub mod combinations;
mod composition;
mod counts;
mod encode;
mod frames;
pub mod in_view;
pub mod left_out;
mod medium;
pub mod pages;
pub mod plan;
pub mod planned;
pub mod readback;
pub mod report;
mod resident;
// techniques are outside: without them much of what they are given is unread
#[cfg_attr(not(feature = "internals"), expect(dead_code))]
pub mod rival;
mod running;
pub mod sequence;
pub mod stage;
pub mod steps;
pub mod surface;
pub mod tables;

use crate::camera::Camera;
use crate::engine::call_ms::{CallMs, ms_since};
use crate::engine::left_out::LeftOut;
use crate::engine::plan::{Plan, Wanted};
use crate::engine::rival::{Choice, Setup};
use crate::engine::stage::Stages;
use crate::gpu::Gpu;
use crate::gpu::device::GpuOptions;
use crate::gpu::draw_counts::DrawCounts;
use crate::gpu::kernels::Variant;
pub use crate::gpu::kernels::{Arithmetic, Method};
use crate::gpu::recorder::Passes;
use crate::image::frame::{Channel, Frame};
use crate::input::{Error, Result};
use crate::parallel::share::Share;
use crate::scene::Scene;
use crate::scene::caustics::CausticsReport;
use caustics::DeviceCaustics;
use changes::Dirty;
use combinations::Asked;
pub use counts::Counts;
pub use frames::Frames;
use frames::{Timed, medians, moved};
use pages::PageStore;
use planned::{Planned, Planner};
use resident::Resident;
use std::sync::{Arc, Mutex};
use std::time::Instant;

/// Capacities of the queues between stages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Capacities {
    /// (cluster, node) items of one cull step.
    pub queue: u64,
    /// (cluster, node) items that `split` takes.
    pub work: u64,
    /// (triangle group, node) items that `small` takes, or `bin` where there is no `small`.
    pub tasks: u64,
    /// (triangle, tile) pairs, and as many (triangle, node) items that `small` leaves to `bin`.
    pub pairs: u64,
    /// Pixels of triangles that `recheck` takes; `recheck_samples` takes half as many items, each of up to four samples of a pixel.
    pub recheck_items: u64,
    /// Edge pixels, whose samples `sample` computes.
    pub edges: u64,
}

/// How to run frames.
#[derive(Debug, Clone, Default)]
pub struct RunOptions {
    /// Timed frames after the first one.
    pub repeat: u32,
    /// Every vertex moves before each timed frame.
    pub moving: bool,
    /// The rival that replaces the stages from cull to recheck, if any.
    pub rival: Option<Choice>,
    /// Disable culling: `cull` keeps every cluster, and rivals do not clip at the edges of pieces.
    pub no_cull: bool,
    /// How the triangle of each pixel is found.
    pub method: Method,
    /// Arithmetic of the coverage tests.
    pub arithmetic: Arithmetic,
    /// Triangles that a rival may draw a frame.
    pub draws_max: Option<u64>,
    /// Where the lists start; `None`: from the scene's size. They grow as needed.
    pub capacities: Option<Capacities>,
    /// Told of each frame that is done, or row of the reference.
    pub share: Share,
}

/// Raster or trace, and why.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize)]
pub struct MethodUsed {
    pub name: &'static str,
    pub why: String,
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
    /// Wall times of the parts of the call that rendered it.
    pub call: CallMs,
    /// Median GPU time of each stage, ms; empty without timestamps.
    pub stages: Vec<(&'static str, f64)>,
    pub counts: Counts,
    /// What the rasterizer did for a rival that draws, where that was counted.
    pub draws: Option<DrawCounts>,
    /// Device memory held, bytes.
    pub bytes: u64,
    pub left_out: Vec<LeftOut>,
    /// How the triangle of each pixel was found.
    pub method: MethodUsed,
    /// How many times the lists had to grow.
    pub grown: u32,
    /// Passes of one frame.
    pub passes: Passes,
    /// Where the light of the scene's caustics went, where the frame shows them.
    pub caustics: Option<CausticsReport>,
}

impl Rendered {
    /// Adds what a later frame took.
    pub fn add_costs(&mut self, next: &Rendered) {
        self.frame_ms.iter_mut().zip(&next.frame_ms).for_each(|(sum, ms)| *sum += ms);
        self.call += next.call;
        add_stages(&mut self.stages, &next.stages);
        self.bytes = self.bytes.max(next.bytes);
        self.grown += next.grown;
        self.counts += next.counts;
        self.passes.add(&next.passes);
    }
}

/// Adds the times of stages to those of the same names.
pub fn add_stages(sums: &mut Vec<(&'static str, f64)>, more: &[(&'static str, f64)]) {
    for &(name, ms) in more {
        match sums.iter_mut().find(|stage| stage.0 == name) {
            Some(stage) => stage.1 += ms,
            None => sums.push((name, ms)),
        }
    }
}

/// An open adapter with the kernels that were compiled for it.
pub struct Engine {
    pub gpu: Arc<Gpu>,
    stages: Vec<Arc<Stages>>,
    /// The caustics of the last scene that had some.
    caustics: Option<Arc<DeviceCaustics>>,
    pages: Arc<PageStore>,
}

impl Engine {
    pub fn new(gpu: Gpu) -> Engine {
        Engine { gpu: Arc::new(gpu), stages: Vec::new(), caustics: None, pages: Arc::default() }
    }

    /// On the adapter asked for; `None` on a machine without any.
    ///
    /// # Errors
    /// Those of [`Gpu::open`].
    pub fn open(options: &GpuOptions) -> Result<Option<Engine>> {
        Ok(Gpu::open(options)?.map(Engine::new))
    }

    /// Renders `scene` through `camera`.
    pub fn render(
        &mut self,
        scene: &Scene,
        camera: impl Into<Arc<Camera>>,
        wanted: &Wanted,
        run: &RunOptions,
    ) -> Result<Rendered> {
        let mut sample_ids = Vec::new();
        let rendered = self.render_with_ids(scene, camera, wanted, run, &mut |ids| sample_ids.push(ids))?;
        Ok(Rendered { sample_ids, ..rendered })
    }

    /// Renders `scene` through `camera`, and hands the triangle ids of each sample to `ids`, if these are wanted.
    pub fn render_with_ids(
        &mut self,
        scene: &Scene,
        camera: impl Into<Arc<Camera>>,
        wanted: &Wanted,
        run: &RunOptions,
        ids: &mut dyn FnMut(Vec<u32>),
    ) -> Result<Rendered> {
        let camera: Arc<Camera> = camera.into();
        if Asked::of(scene, &camera, wanted, run).is_separate() {
            return self.accumulate(scene, &camera, wanted, run, ids);
        }
        let mut rendered = match camera.layered() {
            Some(composition) => self.compose(scene, &camera, composition, wanted, run)?,
            None if run.moving && is_made_anew(scene) => self.render_moved(scene, &camera, wanted, run)?,
            None => {
                let mut frames = self.prepare(scene, camera, wanted, run)?;
                for _ in 0..run.repeat {
                    frames.frame()?;
                }
                let rendered = frames.finish()?;
                run.share.add();
                rendered
            }
        };
        rendered.sample_ids.drain(..).for_each(ids);
        Ok(rendered)
    }

    /// Renders a frame, then times further ones, each prepared from scratch: caustics and time steps depend on where objects are.
    fn render_moved(
        &mut self,
        scene: &Scene,
        camera: &Arc<Camera>,
        wanted: &Wanted,
        run: &RunOptions,
    ) -> Result<Rendered> {
        let still = &RunOptions { moving: false, ..run.clone() };
        let mut rendered = self.prepare(scene, camera.clone(), wanted, still)?.finish()?;
        let (mut frame_ms, mut stages) = (Vec::new(), Vec::new());
        for number in 1..=run.repeat {
            let moved = moved(scene, 0, number);
            let started = Instant::now();
            let frames = self.prepare(&moved, camera.clone(), wanted, still)?;
            frame_ms.push(ms_since(started));
            stages.push(frames.finish()?.stages);
        }
        if !frame_ms.is_empty() {
            (rendered.frame_ms, rendered.stages) = (frame_ms, medians(stages));
        }
        run.share.add();
        Ok(rendered)
    }

    /// Works out what frames of a scene take on this adapter; see [`Planner::plan`].
    pub fn planner(&self) -> Planner {
        let (limit, table_limit) = (self.gpu.binding_limit(), self.gpu.table_limit);
        Planner { name: self.gpu.info.name.clone(), has: self.gpu.has, limit, table_limit }
    }

    /// Uploads everything that frames of `scene` through `camera` need, and runs one frame. Uses all of `run` except `repeat`.
    pub fn prepare(
        &mut self,
        scene: &Scene,
        camera: impl Into<Arc<Camera>>,
        wanted: &Wanted,
        run: &RunOptions,
    ) -> Result<Frames> {
        let camera: Arc<Camera> = camera.into();
        if run.moving && is_made_anew(scene) {
            return Err(Error::input("each frame of this scene is made anew when vertices move; call Engine::render"));
        }
        let planned = self.planner().plan(scene, camera, wanted, run, None)?;
        let mut call = planned.call;
        let started = Instant::now();
        let mut frames = self.upload(planned.clone(), run)?;
        call.upload = ms_since(started);
        if let Err(error) = frames.warm_up() {
            let by_raster = if frames.is_lost() { self.planner().rasterized(&planned, run) } else { None };
            let Some(by_raster) = by_raster else { return Err(error) };
            drop(frames);
            frames = self.upload(by_raster, &RunOptions { method: Method::Raster, ..run.clone() })?;
            frames.warm_up()?;
        }
        frames.timed.call += call;
        Ok(frames)
    }

    /// Uploads what was planned. No frame is rendered yet.
    fn upload(&mut self, planned: Planned, run: &RunOptions) -> Result<Frames> {
        let own_scene = planned.scene_without_optics();
        let Planned { scene, camera, whole, plan, clustered, wanted, .. } = planned;
        let mut atlas = self.atlas_renderer(&own_scene, &camera, &wanted, run)?;
        let caustics = if wanted.has_colour() { self.device_caustics(&own_scene)? } else { None };
        run.share.enter("compiling kernels");
        let stages = self.stages(plan.variant, &plan.planes)?;
        let after_bounce =
            plan.variant.bounces_rays().then(|| self.stages(plan.variant.after_bounce(), &plan.planes)).transpose()?;
        let rival = run.rival.map(|choice| choice.make(&self.gpu, &scene, setup(&camera, &plan))).transpose()?;
        run.share.enter("uploading triangles");
        let mut resident = Resident::new(&self.gpu, &scene, &clustered, &camera, &plan, run.capacities)?;
        resident.take_pictures(whole.facts.beams.pictures());
        resident.upload_appearance(&self.gpu, &self.pages, &scene, &plan)?;
        let draws = rival.as_ref().map_or(0, |r| resident.chunks.iter().map(|c| r.draws(c.slots)).sum::<u64>());
        if let Some(most) = run.draws_max.filter(|most| draws > *most) {
            return Err(Error::input(format!("{draws} triangles to draw a frame; {most} are the most here")));
        }
        if let Some(atlas) = &mut atlas {
            atlas.render_into(&self.gpu, &mut resident.shared)?;
        }
        // the frames, by the name of their step
        run.share.enter("");
        Ok(Frames {
            gpu: self.gpu.clone(),
            #[cfg(feature = "internals")]
            planner: self.planner(),
            #[cfg(feature = "internals")]
            whole,
            run: run.clone(),
            pages: self.pages.clone(),
            stages,
            after_bounce,
            scene,
            camera,
            plan,
            wanted,
            resident,
            caustics,
            atlas,
            rival,
            planes_copy: None,
            slots: clustered.slots.clone(),
            places: clustered.places.clone(),
            savings: Default::default(),
            fit_cost: 0,
            trial: Default::default(),
            shown: Arc::downgrade(&clustered),
            moving: run.moving.then(|| Arc::unwrap_or_clone(clustered)),
            bind_groups: Mutex::default(),
            is_partly_uploaded: false,
            is_lost: false,
            is_aimed: false,
            dirty: Dirty::All,
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
}

/// Caustics and time steps are made anew when vertices move.
fn is_made_anew(scene: &Scene) -> bool {
    scene.caustics.is_some() || scene.steps.is_some()
}

/// What a rival needs to know of a plan.
fn setup<'a>(camera: &'a Camera, plan: &Plan) -> Setup<'a> {
    let rows = plan.rows_max();
    Setup { camera, variant: plan.variant, rows, centre: plan.centre, anchor: plan.anchor, parameter: 0 }
}
