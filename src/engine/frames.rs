//! Frames of one scene through one camera: the first, again until its lists hold everything; timed ones; and what they came to.

#[cfg(feature = "internals")]
mod changed;

use super::atlas::AtlasRenderer;
use super::call_ms::{CallMs, ms_since};
use super::caustics::DeviceCaustics;
use super::changes::{Changes, Dirty, Shown};
use super::pages::PageStore;
use super::planned::Planned;
use super::readback::{FrameLayout, PendingReads, RawFrame, Readback};
use super::resident::{BvhState, Resident};
use super::running::{RasterTrial, Running, Savings};
use super::{Counts, MethodUsed, Rendered, RunOptions};
use crate::camera::Camera;
use crate::engine::clusters::{Clustered, cluster_scene, cluster_shown};
use crate::engine::left_out::LeftOut;
use crate::engine::plan::{Plan, Wanted};
use crate::engine::rival::Rival;
use crate::engine::stage::Stages;
use crate::gpu::Gpu;
use crate::gpu::buffers::{BindGroups, wait};
use crate::gpu::kernels::Method;
use crate::image::frame::Frame;
use crate::input::{Error, Result};
use crate::scene::Scene;
use crate::scene::labels::Labels;
use glam::{DMat3, DVec3};
use std::sync::{Arc, Mutex, Weak};
use std::time::Instant;

/// Everything that is on the device for frames of one scene; as many of them may be kept as it has memory for.
pub struct Frames {
    pub(super) gpu: Arc<Gpu>,
    /// Plans anew when the camera changes.
    #[cfg(feature = "internals")]
    pub(super) planner: super::planned::Planner,
    /// The scene and the camera with the parts that are out of view.
    #[cfg(feature = "internals")]
    pub(super) whole: super::planned::Whole,
    pub(super) run: RunOptions,
    /// Where the images on triangles come from.
    pub(super) pages: Arc<PageStore>,
    pub(super) stages: Arc<Stages>,
    /// For rays after a bounce.
    pub(super) after_bounce: Option<Arc<Stages>>,
    pub(super) scene: Arc<Scene>,
    pub(super) camera: Arc<Camera>,
    pub(super) plan: Arc<Plan>,
    pub(super) wanted: Wanted,
    pub(super) resident: Resident,
    /// Of the last frame.
    pub(super) bind_groups: Mutex<BindGroups>,
    /// The scene's caustics, where the frame shows them.
    pub(super) caustics: Option<Arc<DeviceCaustics>>,
    /// Renders the atlas before each frame.
    pub(super) atlas: Option<AtlasRenderer>,
    /// Finds what is seen instead of the stages from cull to recheck.
    pub(super) rival: Option<Box<dyn Rival>>,
    /// A copy of the planes as one image, 4 bytes a channel and pixel.
    pub(super) planes_copy: Option<wgpu::Buffer>,
    /// The triangles that are on the device, while some plan keeps them.
    pub(super) shown: Weak<Clustered>,
    /// [`Clustered::slots`] and [`Clustered::places`] of these.
    pub(super) slots: Arc<()>,
    pub(super) places: Arc<()>,
    /// The same as they are now, where every vertex is new in each timed frame.
    pub(super) moving: Option<Clustered>,
    /// Something failed while another scene, camera or light was sent, of which a part may be there.
    pub(super) is_partly_uploaded: bool,
    /// Savings of tracing along a path.
    pub(super) savings: Savings,
    /// [`Resident::fit_cost`] of the triangles that moved before the present frame, if that was not paid by what tracing had saved.
    pub(super) fit_cost: u64,
    /// When raster is tried again in frames that are traced.
    pub(super) trial: RasterTrial,
    /// Trace could not follow all paths of a frame.
    pub(super) is_lost: bool,
    /// The camera is not that of the first frame any more.
    pub(super) is_aimed: bool,
    /// What the picture does not show yet.
    pub(super) dirty: Dirty,
    pub(super) timed: Timed,
}

/// What frames took so far.
#[derive(Default)]
pub struct Timed {
    /// The picture, which is read in the end.
    first: Option<Running>,
    first_ms: f64,
    frame_ms: Vec<f64>,
    stages: Vec<Vec<(&'static str, f64)>>,
    pub(super) grown: u32,
    /// Times of the parts of the call that prepared these frames.
    pub(super) call: CallMs,
    /// Moved frames.
    moved: u32,
    /// What raster cost in the last frame whose counters were read.
    pub(super) raster_cost: u64,
}

impl Frames {
    /// The picture by all stages, again until its lists hold everything.
    pub(super) fn warm_up(&mut self) -> Result<()> {
        if let Some(atlas) = &mut self.atlas {
            atlas.frames.warm_up()?;
        }
        loop {
            let running = self.begin(Dirty::All, true)?;
            wait(&self.gpu)?;
            let atlas_ms = self.atlas.as_ref().map_or(0.0, |p| p.frames.timed.first_ms);
            self.timed.first_ms = atlas_ms + running.ms();
            self.timed.call.compile += running.compile_ms;
            self.timed.call.wait += running.ms();
            let fits = self.fits(&running)?;
            self.timed.first = Some(running);
            if fits {
                self.dirty = Dirty::Nothing;
                return Ok(());
            }
        }
    }

    /// One more frame by all stages, whatever changed; its wall time, from the first upload until its results are complete on the device,
    /// ms.
    pub fn frame(&mut self) -> Result<f64> {
        let is_new = self.prefer_trace()?;
        loop {
            self.compile(&self.steps(false, Dirty::All))?;
            let moved = [self.atlas.as_mut().and_then(|p| p.frames.next_move()), self.next_move()];
            let started = Instant::now();
            let [atlas_frame, own] = moved;
            let atlas_frame = self.atlas.as_mut().map(|p| p.frames.draw(atlas_frame)).transpose()?;
            let drawn = self.draw(own)?;
            wait(&self.gpu)?;
            let ms = ms_since(started);
            // what moves may come to need more, and so may the first frame that is traced from its start
            let mut fits = !(self.moving.is_some() || self.is_aimed || is_new) || self.fits(&drawn)?;
            if let (Some(atlas), Some(atlas_frame)) = (&mut self.atlas, &atlas_frame) {
                fits &= self.moving.is_none() || atlas.frames.fits(atlas_frame)?;
                let stages = atlas_frame.recorded.stage_ms(&self.gpu)?;
                atlas.frames.timed.stages.push(stages);
            }
            if fits {
                self.timed.frame_ms.push(ms);
                self.timed.stages.push(drawn.recorded.stage_ms(&self.gpu)?);
                return Ok(ms);
            }
        }
    }

    /// Traces from the next frame on, where that costs less than raster, once what it would have saved is worth building a hierarchy.
    /// Returns whether it does so from now on.
    fn prefer_trace(&mut self) -> Result<bool> {
        let frames = self.timed.frame_ms.len() as u64 + 1;
        let trace = self.resident.trace_cost(&self.plan);
        let saved = self.resident.raster_cost(self.timed.raster_cost).saturating_sub(trace + trace / 8);
        let is_open =
            self.plan.variant.method() == Method::Auto && matches!(self.resident.bvh, BvhState::None | BvhState::Built);
        if !is_open || saved == 0 || saved * frames < self.resident.build_cost() {
            return Ok(false);
        }
        if self.resident.bvh == BvhState::None {
            self.build_bvh()?;
        }
        if self.resident.bvh == BvhState::Built {
            self.resident.bvh = BvhState::Preferred;
        }
        self.resident.write_params(&self.gpu, &self.camera, &self.plan)?;
        Ok(true)
    }

    /// Builds the hierarchies that trace follows.
    pub(super) fn build_bvh(&mut self) -> Result<()> {
        let Plan { anchor, origin, variant, .. } = *self.plan;
        self.run.share.enter("building a hierarchy");
        let anew = || Arc::new(cluster_scene(&self.scene, anchor, variant, self.gpu.table_limit));
        let clustered = self.shown.upgrade().unwrap_or_else(anew);
        self.resident.build_bvh(&self.gpu, (&clustered, clustered.mesh(&self.scene)), origin)?;
        self.run.share.enter("");
        Ok(())
    }

    /// The kernels that frames take.
    #[cfg(feature = "cli")]
    pub fn variant(&self) -> crate::gpu::kernels::Variant {
        self.plan.variant
    }

    /// Notes what the frame does not show yet.
    fn mark_dirty(&mut self, changes: Changes) {
        // of bands and bounces, and of moving triangles, only the last ones are still there
        let is_there = self.plan.bands.len() == 1 && self.resident.bounces.len() == 1 && self.moving.is_none();
        self.dirty = self.dirty.max(match changes.dirty() {
            Dirty::Appearance if !is_there => Dirty::All,
            dirty => dirty,
        });
    }

    /// Runs only the stages that depend on what changed: none, `shade` and `resolve` after [`Frames::light`], all after [`Frames::aim`].
    /// Returns the number of compute passes.
    pub fn refresh(&mut self) -> Result<u32> {
        if self.dirty == Dirty::All {
            // makes the atlas too
            self.warm_up()?;
            return Ok(self.timed.first.as_ref().map_or(0, |first| first.recorded.passes.total()));
        }
        let atlas_frame = self.atlas.as_mut().map_or(Ok(0), |p| p.frames.refresh())?;
        if self.dirty == Dirty::Appearance {
            let drawn = self.begin(Dirty::Appearance, true)?;
            wait(&self.gpu)?;
            if let Some(first) = &mut self.timed.first {
                (first.copies.planes, first.copies.srgb8) = (drawn.copies.planes, drawn.copies.srgb8);
            }
            self.dirty = Dirty::Nothing;
            return Ok(atlas_frame + drawn.recorded.passes.total());
        }
        Ok(atlas_frame)
    }

    /// The next of the moving scenes.
    fn next_move(&mut self) -> Option<Scene> {
        self.moving.is_some().then(|| {
            self.timed.moved += 1;
            moved(&self.scene, self.fixed_vertices(), self.timed.moved)
        })
    }

    /// Those of mirrors and lenses.
    fn fixed_vertices(&self) -> usize {
        self.camera.optics.as_ref().map_or(0, |o| o.vertex_count())
    }

    /// Submits a frame of a scene that has moved, or of that which is there.
    fn draw(&mut self, moved: Option<Scene>) -> Result<Running> {
        if let Some(moved) = moved {
            self.upload_vertices(&moved)?;
            if let Some(rival) = &mut self.rival {
                rival.upload(&self.gpu, &moved)?;
            }
        }
        self.begin(Dirty::All, false)
    }

    /// Uploads the triangles of a scene that has moved, in the same clusters as long as these stay tight.
    fn upload_vertices(&mut self, moved: &Scene) -> Result<()> {
        let Some(clustered) = &mut self.moving else { return Ok(()) };
        if self.plan.variant.appearance.lights.has_shadows() || self.plan.variant.appearance.lights.has_pictures() {
            self.resident.refit_shadow_casters(moved);
            self.resident.upload_appearance(&self.gpu, &self.pages, moved, &self.plan)?;
        }
        if clustered.refit(&moved.mesh) {
            let triangles = (&*clustered, (&*moved.mesh).into());
            return self.resident.move_scene(&self.gpu, triangles, None, self.plan.origin);
        }
        *clustered = cluster_shown(&*moved.mesh, self.plan.anchor, self.plan.variant, self.gpu.table_limit);
        self.resident.upload_scene(&self.gpu, (clustered, (&*moved.mesh).into()), self.plan.origin)?;
        self.resident.write_params(&self.gpu, &self.camera, &self.plan)
    }

    /// The picture, and what all frames took.
    pub fn finish(mut self) -> Result<Rendered> {
        self.refresh()?;
        let atlas = self.atlas.take();
        let Timed { first, first_ms, mut frame_ms, mut stages, grown, mut call, .. } = std::mem::take(&mut self.timed);
        let Some(first) = first else { return Err(Error::work("no frame was taken")) };
        let reading = Instant::now();
        let reads = PendingReads::start(&first);
        wait(&self.gpu)?;
        let mut raw = reads.finish(&self.gpu, &first)?;
        call.read_back += ms_since(reading);
        if frame_ms.is_empty() {
            frame_ms.push(first_ms);
            stages = vec![std::mem::take(&mut raw.stages)];
        }
        if let Some(rival) = &self.rival {
            rival.check(&self.gpu)?;
        }
        let frame_layout = self.frame_layout();
        let statistics = self.statistics(&frame_layout.plan, &first, &raw);
        let rest = Rendered { frame_ms, call, stages: medians(stages), grown, ..statistics };
        let own = Readback { frame_layout, raw, rest }.rendered();
        match atlas {
            Some(atlas) => atlas.merged_into(own),
            None => Ok(own),
        }
    }

    /// From the next frame on, renders another planned frame; uploads only what differs. Returns false, with nothing changed, if a new
    /// `Frames` is needed instead.
    pub(super) fn show(&mut self, planned: &Planned) -> Result<bool> {
        self.show_by(planned, true)
    }

    /// Shows another planned frame. With `chooses`, chooses anew whether raster is tried and whether hierarchies follow moved triangles.
    pub(super) fn show_by(&mut self, planned: &Planned, chooses: bool) -> Result<bool> {
        let bvh = self.resident.bvh;
        if chooses {
            self.choose_method();
        }
        let Planned { scene, camera, plan, clustered, wanted, .. } = planned;
        let is_plain = self.atlas.is_none() && self.rival.is_none() && self.caustics.is_none() && self.moving.is_none();
        let kind = |plan: &Plan, camera: &Camera| (plan.variant, plan.slabs.count(), camera.width, plan.rows_max());
        let is_as_large = kind(plan, camera) == kind(&self.plan, &self.camera) && plan.planes == self.plan.planes;
        let rows = |plan: &Plan| plan.bands.iter().map(|band| band.rows).collect::<Vec<u32>>();
        let bounces_alike = match (&camera.optics, &self.camera.optics) {
            (None, None) => true,
            (Some(_), Some(_)) => self.resident.bounces_like(camera) && rows(plan) == rows(&self.plan),
            _ => false,
        };
        let is_wanted = Wanted { rows: self.wanted.rows, ..wanted.clone() } == self.wanted;
        if !is_plain || !bounces_alike || scene.caustics.is_some() || !is_as_large || !is_wanted {
            return Ok(false);
        }
        let shown = Shown { scene: &self.scene, plan: &self.plan, slots: &self.slots, places: &self.places };
        // until all is there nothing counts as the same
        let is_partly_uploaded = std::mem::replace(&mut self.is_partly_uploaded, true);
        let changes = if is_partly_uploaded { Changes::ALL } else { Changes::between(&shown, planned) };
        let triangles = (&**clustered, clustered.mesh(scene));
        self.fit_cost = 0;
        if changes.triangles {
            (self.savings, self.trial) = Default::default();
            self.resident.upload_scene(&self.gpu, triangles, plan.origin)?;
        } else if changes.places {
            let moved = clustered.moved.as_ref().filter(|moved| Arc::ptr_eq(&moved.from, &self.places));
            let moved = moved.filter(|_| plan.anchor == self.plan.anchor);
            let fit_cost = self.resident.fit_cost(moved);
            if chooses && !self.pay_for_fit(fit_cost) {
                self.trial = RasterTrial::default();
                self.resident.forget_bvh(&self.gpu, triangles, plan.origin)?;
            }
            self.fit_cost = if self.resident.bvh == BvhState::None { fit_cost } else { 0 };
            self.resident.move_scene(&self.gpu, triangles, moved, plan.origin)?;
        } else if changes.positions {
            self.resident.anchor_scene(&self.gpu, triangles)?;
            if plan.origin != self.plan.origin {
                self.resident.upload_bvh(&self.gpu, triangles, plan.origin)?;
            }
        }
        self.shown = Arc::downgrade(clustered);
        (self.slots, self.places) = (clustered.slots.clone(), clustered.places.clone());
        if changes.plan {
            self.resident.aim(&self.gpu, scene, camera, plan)?;
        } else if changes.triangles || self.resident.bvh != bvh {
            self.resident.write_params(&self.gpu, camera, plan)?;
        }
        let casts_itself = scene.casters.is_none() && self.scene.casters.is_none();
        if changes.triangles || changes.positions && !(casts_itself && plan.anchor == self.plan.anchor) {
            self.resident.forget_shadow_casters();
        } else if changes.places {
            self.resident.refit_shadow_casters(scene);
        }
        if changes.needs_appearance() {
            self.resident.upload_appearance(&self.gpu, &self.pages, scene, plan)?;
        } else if let Some(volume) =
            scene.volume.as_ref().filter(|_| changes.plan && plan.variant.extras.volume.is_some())
        {
            self.resident.upload_medium(&self.gpu, volume, scene, plan)?;
        }
        (self.scene, self.camera) = (scene.clone(), camera.clone());
        #[cfg(feature = "internals")]
        self.whole.clone_from(&planned.whole);
        (self.plan, self.wanted) = (plan.clone(), wanted.clone());
        self.is_partly_uploaded = false;
        self.mark_dirty(changes);
        Ok(true)
    }

    pub(super) fn frame_layout(&self) -> FrameLayout {
        FrameLayout {
            camera: self.camera.clone(),
            plan: self.plan.clone(),
            wanted: self.wanted.clone(),
            labels: self.wanted.has_labels().then(|| Labels::of(&self.scene)),
            depth_range: self.scene.depth_range,
        }
    }

    /// How the triangle of each pixel was found, and why so.
    fn method_used(&self, plan: &Plan, counts: &Counts) -> MethodUsed {
        if self.rival.is_some() {
            return MethodUsed::default();
        }
        let milliseconds = |cost| self.resident.milliseconds(cost);
        let trace = milliseconds(self.resident.trace_cost(plan));
        let trace = format!("tracing every pixel is rated {trace:.2} ms");
        let raster = self.resident.raster_cost(self.timed.raster_cost.max(counts.raster_cost()));
        let raster = format!("raster is rated {:.2} ms", milliseconds(raster));
        let (name, why) = match (plan.variant.method(), counts.taken_over > 0) {
            (Method::Auto, _) if self.trial.was_in_vain() => (
                "trace",
                format!(
                    "{trace}; raster was stopped in this frame or an earlier one, as the rest of it was rated higher"
                ),
            ),
            (Method::Auto, _) if self.resident.bvh == BvhState::Preferred => {
                ("trace", format!("{raster} in the first frame, {trace}"))
            }
            (Method::Auto, true) => ("trace", format!("{trace}; what raster would still have taken is rated higher")),
            (Method::Auto, false) => ("raster", format!("{raster}, {trace}")),
            (Method::Raster, _) => ("raster", plan.method_why.to_owned()),
            (Method::Trace, _) => ("trace", plan.method_why.to_owned()),
        };
        MethodUsed { name, why }
    }

    /// What a frame of a plan counted, and the memory in use; no picture and no times.
    pub(super) fn statistics(&self, plan: &Plan, running: &Running, raw: &RawFrame) -> Rendered {
        let counts = Counts::of(&raw.status);
        let mut left_out = plan.left_out.clone();
        if self.resident.without_area > 0 {
            left_out.push(LeftOut::Triangles(self.resident.without_area));
        }
        Rendered {
            frame: Frame { width: self.camera.width, height: plan.rows(), planes: Vec::new() },
            sample_ids: Vec::new(),
            srgb8: None,
            frame_ms: Vec::new(),
            call: CallMs::default(),
            stages: Vec::new(),
            counts,
            draws: raw.draws,
            bytes: self.resident.bytes()
                + self.rival.as_ref().map_or(0, |r| r.bytes())
                + self.caustics.as_ref().map_or(0, |c| c.buffers.bytes()),
            left_out,
            method: self.method_used(plan, &counts),
            grown: 0,
            passes: running.recorded.passes.clone(),
            caustics: self.caustics.as_ref().map(|c| c.report),
        }
    }
}

/// The median of every stage over the runs.
pub(super) fn medians(runs: Vec<Vec<(&'static str, f64)>>) -> Vec<(&'static str, f64)> {
    let Some(first) = runs.first() else { return Vec::new() };
    let median = |name: &str| {
        let mut ms: Vec<f64> = runs.iter().flatten().filter(|s| s.0 == name).map(|s| s.1).collect();
        ms.sort_by(f64::total_cmp);
        ms[ms.len() / 2]
    };
    first.iter().map(|&(name, _)| (name, median(name))).collect()
}

/// The scene with every vertex but the last `fixed`, which are a mirror's, rotated about its centre by a little more each
/// frame.
pub(super) fn moved(scene: &Scene, fixed: usize, frame: u32) -> Scene {
    let mut scene = scene.clone();
    let (lo, hi) = scene.bounds().unwrap_or((DVec3::ZERO, DVec3::ZERO));
    let (center, turn) = ((lo + hi) / 2.0, DMat3::from_rotation_y(frame as f64 * MOVING_STEP_RAD));
    let moving = scene.mesh.positions.len() - fixed;
    let rotated = |p: &mut DVec3| *p = center + turn * (*p - center);
    Arc::make_mut(&mut scene.mesh).positions[..moving].iter_mut().for_each(rotated);
    if let Some(casters) = &mut scene.casters {
        Arc::make_mut(casters).positions.iter_mut().for_each(rotated);
    }
    if let Some(steps) = &mut scene.steps {
        Arc::make_mut(steps).for_each_position(rotated);
    }
    scene
}

/// How far a moving scene turns a frame.
const MOVING_STEP_RAD: f64 = 0.01;
