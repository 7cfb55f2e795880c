//! Frames of one scene through one camera: the first, again until its lists hold everything; timed ones; and what they came to.

use super::atlas::Painter;
use super::illumination::Illuminated;
use super::pages::PageStore;
use super::resident::Resident;
use super::{Capacities, Counts, Rendered, check_outlines, check_samples, join, outlined_by, setup};
use crate::baseline::Rival;
use crate::camera::Camera;
use crate::camera::arranged::Arrangement;
use crate::error::{Error, Result};
use crate::frame::{Channel, NO_ID};
use crate::gpu::Gpu;
use crate::gpu::buffers::{read_words, wait};
use crate::gpu::kernels::LightsKind;
use crate::gpu::recorder::Recorded;
use crate::gpu::rows::{
    COUNT_BUSY, COUNT_BUSY_END, COUNT_DOUBTS, COUNT_EDGES, COUNT_FRAGMENTS_KEPT, COUNT_FRAGMENTS_TESTED, COUNT_PAIRS,
    COUNT_PAIRS_KEPT, COUNT_PAIRS_TESTED, COUNT_RECHECKED, COUNT_SAMPLE_DOUBTS, COUNT_TASKS, COUNT_WORK, COUNTERS,
};
use crate::plan::{Contents, LeftOut, Plan, Surroundings, Wanted};
use crate::scene::Scene;
use crate::scene::clusters::{Clustered, cluster};
use crate::stage::Stages;
use crate::stage::gather::Gather;
use glam::{DMat3, DVec3};
use std::borrow::Cow;
use std::sync::Arc;
use std::time::Instant;

/// Everything that is on the device for frames of one scene; as many of them may be kept as it has memory for.
pub struct Frames<'a> {
    pub(super) gpu: Arc<Gpu>,
    /// Where the images on triangles come from.
    pub(super) pages: Arc<PageStore>,
    pub(super) stages: Arc<Stages>,
    /// For rays that were turned.
    pub(super) turned: Option<Arc<Stages>>,
    pub(super) scene: Cow<'a, Scene>,
    pub(super) camera: Cow<'a, Camera>,
    pub(super) plan: Plan,
    pub(super) wanted: Wanted,
    pub(super) resident: Resident,
    /// The scene's caustics, where the frame shows them.
    pub(super) caustics: Option<(Arc<Illuminated>, Arc<Gather>)>,
    /// The order of the camera's pixels, where it is not their own.
    pub(super) arrangement: Option<Arrangement>,
    /// Makes the atlas before each frame.
    pub(super) painter: Option<Painter<'a>>,
    /// Finds what is seen instead of the stages from cull to recheck.
    pub(super) rival: Option<Box<dyn Rival>>,
    /// Where the planes go too, 4 bytes a channel and pixel, as one image.
    pub(super) kept: Option<wgpu::Buffer>,
    /// The triangles as they are on the device, where every vertex is new in each timed frame.
    pub(super) moving: Option<Clustered>,
    /// The camera is not that of the first frame any more.
    pub(super) is_aimed: bool,
    /// What the picture does not show yet.
    pub(super) due: Due,
    pub(super) timed: Timed,
}

/// What changed since the picture was made, and so which stages are to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Due {
    Nothing,
    /// Lights or materials: what follows the visibility buffer.
    Look,
    All,
}

/// What frames took so far.
#[derive(Default)]
pub struct Timed {
    /// The picture, which is read in the end.
    first: Option<Submitted>,
    first_ms: f64,
    frame_ms: Vec<f64>,
    stages: Vec<Vec<(&'static str, f64)>>,
    grown: u32,
    /// Moved frames.
    moved: u32,
}

/// One submitted frame: its counters by job, and its image by band where it is read.
pub(super) struct Submitted {
    pub status: wgpu::Buffer,
    pub planes: Vec<wgpu::Buffer>,
    pub srgb8: Vec<wgpu::Buffer>,
    /// Rows of the pixels that hold an edge, and what their samples see: where that is asked for.
    pub edge_of: Vec<wgpu::Buffer>,
    pub samples: Vec<wgpu::Buffer>,
    pub recorded: Recorded,
}

impl Frames<'_> {
    /// The picture by all stages, again until its lists hold everything.
    pub(super) fn warm_up(&mut self) -> Result<()> {
        if let Some(painter) = &mut self.painter {
            painter.frames.warm_up()?;
        }
        loop {
            self.compile_samples();
            let started = Instant::now();
            let submitted = self.submit(true, Due::All)?;
            wait(&self.gpu)?;
            let painted_ms = self.painter.as_ref().map_or(0.0, |p| p.frames.timed.first_ms);
            self.timed.first_ms = painted_ms + started.elapsed().as_secs_f64() * 1e3;
            let fits = self.fits(&submitted)?;
            self.timed.first = Some(submitted);
            if fits {
                self.due = Due::Nothing;
                return Ok(());
            }
        }
    }

    /// One more frame by all stages, whatever changed; its wall time, from the first upload until its results are complete on the device, ms.
    pub fn frame(&mut self) -> Result<f64> {
        loop {
            self.compile_samples();
            let moved = [self.painter.as_mut().and_then(|p| p.frames.next_move()), self.next_move()];
            let started = Instant::now();
            let [painted, own] = moved;
            let painted = self.painter.as_mut().map(|p| p.frames.draw(painted)).transpose()?;
            let drawn = self.draw(own)?;
            wait(&self.gpu)?;
            let ms = started.elapsed().as_secs_f64() * 1e3;
            // only what moves may come to need more
            let mut fits = !(self.moving.is_some() || self.is_aimed) || self.fits(&drawn)?;
            if let (Some(painter), Some(painted)) = (&mut self.painter, &painted) {
                fits &= self.moving.is_none() || painter.frames.fits(painted)?;
                let stages = painted.recorded.stage_ms(&self.gpu)?;
                painter.frames.timed.stages.push(stages);
            }
            if fits {
                self.timed.frame_ms.push(ms);
                self.timed.stages.push(drawn.recorded.stage_ms(&self.gpu)?);
                return Ok(ms);
            }
        }
    }

    /// The wall time of the first frame, ms.
    pub fn first_ms(&self) -> f64 {
        self.timed.first_ms
    }

    /// The time on the device of each stage of the last frame that [`Frames::frame`] took, ms; empty without timestamps.
    pub fn stages(&self) -> &[(&'static str, f64)] {
        self.timed.stages.last().map_or(&[], Vec::as_slice)
    }

    /// Shows the scene through `camera` from the next frame on, and in the end: plans anew and uploads what depends on the camera
    /// alone. Positions stay relative to where the first camera had them.
    ///
    /// # Errors
    /// [`Error::Input`] where the camera is not of the same kind and size as the one before, or turns rays.
    pub fn aim(&mut self, camera: &Camera) -> Result<()> {
        check_samples(&self.scene, camera, &self.wanted, self.rival.is_some())?;
        let around = Surroundings { anchor: self.plan.anchor, middle: self.plan.middle };
        let arrangement = Arrangement::of(camera, around.middle);
        let camera = arrangement.as_ref().map_or_else(|| camera.clone(), |a| a.camera(camera));
        let wanted = Wanted { channels: self.plan.planes.clone(), ..self.wanted.clone() };
        let limit = self.gpu.binding_limit();
        let mut plan = Plan::new(&camera, Contents::of(&self.scene), around, &wanted, self.gpu.has, limit);
        (plan.variant.culling, plan.variant.by_tile) = (self.plan.variant.culling, self.plan.variant.by_tile);
        let is_as_large = (camera.width, plan.rows_max()) == (self.camera.width, self.plan.rows_max());
        if plan.variant != self.plan.variant || !is_as_large || camera.optics.is_some() {
            let (old, new) = (self.camera.kind, camera.kind);
            return Err(Error::input(format!("frames of {old} cannot be taken by this {new}; prepare them anew")));
        }
        check_outlines(&plan, arrangement.as_ref())?;
        self.resident.aim(&self.gpu, &camera, &plan)?;
        if let Some(rival) = &mut self.rival {
            rival.aim(&self.gpu, &setup(&camera, &plan))?;
        }
        (self.camera, self.plan, self.arrangement, self.is_aimed) = (Cow::Owned(camera), plan, arrangement, true);
        self.due = Due::All;
        Ok(())
    }

    /// Shows the triangles that are there in the lights, the materials, the normals and before the background of `scene` from the
    /// next frame on, and in the end.
    ///
    /// # Errors
    /// [`Error::Input`] where `scene` has other numbers of triangles, vertices, normals or materials, other kinds of these (images, gloss, a
    /// sky), or caustics are shown.
    pub fn light(&mut self, scene: &Scene) -> Result<()> {
        if self.caustics.is_some() {
            return Err(Error::input("caustics follow the light; prepare the frames anew"));
        }
        if let Some(painter) = &mut self.painter {
            painter.frames.light(scene)?;
        }
        let scene = scene.with_optics(&self.camera);
        let sizes =
            |s: &Scene| [s.mesh.triangles.len(), s.mesh.positions.len(), s.mesh.normals.len(), s.mesh.materials.len()];
        if sizes(&scene) != sizes(&self.scene) {
            return Err(Error::input("other triangles or materials than those that are lit; prepare the frames anew"));
        }
        let (lit, contents) = (Contents::of(&self.scene), Contents::of(&scene));
        let outlined = |s: &Scene| outlined_by(&s.style, &self.camera);
        if lit != contents || outlined(&self.scene) != outlined(&scene) {
            return Err(Error::input(
                "other kinds of materials or light than those that are lit; prepare the frames anew",
            ));
        }
        let (lit, own) = (&self.scene.mesh, &scene.mesh);
        if self.plan.variant.textured && (&lit.uvs, &lit.corner_uvs) != (&own.uvs, &own.corner_uvs) {
            return Err(Error::input("other texture coordinates than those that are lit; prepare the frames anew"));
        }
        let keeps_holes = if self.moving.is_some() {
            // where things have moved to, and in this light from then on
            let mut lit = scene.into_owned();
            Arc::make_mut(&mut lit.mesh).positions.clone_from(&self.scene.mesh.positions);
            self.scene = Cow::Owned(lit);
            let now = moved(&self.scene, self.fixed_vertices(), self.timed.moved);
            self.resident.upload_look(&self.gpu, &self.pages, &now, &self.plan)?
        } else {
            self.resident.upload_look(&self.gpu, &self.pages, &scene, &self.plan)?
        };
        // of bands and passes, and of moving triangles, only the last ones are still there
        let is_there = self.plan.bands.len() == 1 && self.resident.passes.len() == 1 && self.moving.is_none();
        self.due = self.due.max(if is_there && keeps_holes { Due::Look } else { Due::All });
        Ok(())
    }

    /// Brings the picture up to date, by the stages alone that follow what changed since it was made: none, `shade` and `resolve` after
    /// [`Frames::light`], all after [`Frames::aim`]. How many compute passes it took.
    pub fn refresh(&mut self) -> Result<u32> {
        if self.due == Due::All {
            // makes the atlas too
            self.warm_up()?;
            return Ok(self.timed.first.as_ref().map_or(0, |first| first.recorded.passes));
        }
        let painted = self.painter.as_mut().map_or(Ok(0), |p| p.frames.refresh())?;
        if self.due == Due::Look {
            let drawn = self.submit(true, Due::Look)?;
            wait(&self.gpu)?;
            if let Some(first) = &mut self.timed.first {
                (first.planes, first.srgb8) = (drawn.planes, drawn.srgb8);
            }
            self.due = Due::Nothing;
            return Ok(painted + drawn.recorded.passes);
        }
        Ok(painted)
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
    fn draw(&mut self, moved: Option<Scene>) -> Result<Submitted> {
        if let Some(moved) = moved {
            self.put(&moved)?;
            if let Some(rival) = &mut self.rival {
                rival.upload(&self.gpu, &moved)?;
            }
        }
        self.submit(false, Due::All)
    }

    /// The triangles of a scene that has moved, in their clusters as long as these hold them well.
    fn put(&mut self, moved: &Scene) -> Result<()> {
        let Some(clustered) = &mut self.moving else { return Ok(()) };
        if self.plan.variant.lights == LightsKind::Hidden {
            self.resident.refit_obstacles(moved);
            self.resident.upload_look(&self.gpu, &self.pages, moved, &self.plan)?;
        }
        if clustered.refit(&moved.mesh) {
            return self.resident.place_scene(&self.gpu, clustered);
        }
        *clustered = cluster(&moved.mesh, self.plan.anchor, self.plan.variant.textured, self.gpu.binding_limit());
        self.resident.upload_scene(&self.gpu, clustered)?;
        self.resident.write_params(&self.gpu, &self.camera, &self.plan)
    }

    /// The picture, and what all frames took.
    pub fn finish(mut self) -> Result<Rendered> {
        self.refresh()?;
        let painter = self.painter.take();
        let Timed { first, first_ms, mut frame_ms, mut stages, grown, .. } = std::mem::take(&mut self.timed);
        let Some(first) = first else { return Err(Error::work("no frame was taken")) };
        if frame_ms.is_empty() {
            frame_ms.push(first_ms);
            stages = vec![first.recorded.stage_ms(&self.gpu)?];
        }
        if let Some(rival) = &self.rival {
            rival.check(&self.gpu)?;
        }
        let bands = first.planes.iter().map(|b| read_words(&self.gpu, b)).collect::<Result<Vec<_>>>()?;
        let arrangement = self.arrangement.as_ref();
        let frame = join(&self.camera, &self.plan, &self.wanted, arrangement, &bands);
        let mut srgb8: Vec<[u8; 4]> = Vec::new();
        for (buffer, band) in first.srgb8.iter().zip(&self.plan.bands) {
            let words = read_words(&self.gpu, buffer)?;
            let pixels = band.rows as usize * self.camera.width as usize;
            srgb8.extend_from_slice(bytemuck::cast_slice(&words[..pixels]));
        }
        let srgb8 = match arrangement {
            Some(a) => a.restored(&srgb8),
            None => srgb8,
        };
        let mut left_out = self.plan.left_out.clone();
        if self.resident.without_area > 0 {
            let what = format!("{} triangles", self.resident.without_area);
            left_out.push(LeftOut { what, why: "they have no area".into() });
        }
        let mut sample_ids = self.sample_ids(&first, &bands)?;
        if let Some(a) = arrangement {
            sample_ids.iter_mut().for_each(|ids| *ids = a.restored(ids));
        }
        let own = Rendered {
            frame,
            sample_ids,
            srgb8: self.wanted.srgb8.then_some(srgb8.into_flattened()),
            frame_ms,
            stages: medians(stages),
            counts: self.counts(&first)?,
            bytes: self.resident.bytes()
                + self.rival.as_ref().map_or(0, |r| r.bytes())
                + self.caustics.as_ref().map_or(0, |(lit, _)| lit.buffers.bytes()),
            left_out,
            grown,
            passes: first.recorded.passes,
            caustics: self.caustics.as_ref().map(|(lit, _)| lit.account),
        };
        match painter {
            Some(painter) => painter.joined(own),
            None => Ok(own),
        }
    }

    /// The kernels of samples that this frame takes, before its time is.
    fn compile_samples(&self) {
        for (band, pass) in
            (0..self.plan.bands.len()).flat_map(|b| (0..self.resident.passes.len()).map(move |p| (b, p)))
        {
            let by_tile = self.resident.is_alone(band, pass) && self.resident.samples_by_tile(&self.plan);
            self.stages.compile_samples(&self.gpu, by_tile);
        }
    }

    /// Of each sample the triangles that all pixels see there: those of the pixels that hold no edge are their centres'.
    fn sample_ids(&self, first: &Submitted, bands: &[Vec<u32>]) -> Result<Vec<Vec<u32>>> {
        let samples = self.plan.variant.samples as usize;
        if !self.wanted.sample_ids {
            return Ok(Vec::new());
        }
        let mut all = vec![Vec::new(); samples];
        let plane = self.plan.planes.iter().position(|c| *c == Channel::TriangleId).unwrap_or_default();
        let id_mask = (1 << self.plan.id_bits) - 1;
        for (k, (band, planes)) in self.plan.bands.iter().zip(bands).enumerate() {
            let pixels = band.rows as usize * self.camera.width as usize;
            let centres = &planes[plane * pixels..(plane + 1) * pixels];
            let (Some(edge_of), Some(rows)) = (first.edge_of.get(k), first.samples.get(k)) else {
                all.iter_mut().for_each(|ids| ids.extend_from_slice(centres));
                continue;
            };
            let (edge_of, rows) = (read_words(&self.gpu, edge_of)?, read_words(&self.gpu, rows)?);
            for (n, ids) in all.iter_mut().enumerate() {
                let id = |(centre, row): (&u32, &u32)| {
                    if *row == 0 {
                        return *centre;
                    }
                    let at = 2 * ((*row as usize - 1) * (samples + 1) + 1 + n);
                    if rows[at] == 0 && rows[at + 1] == 0 { NO_ID } else { !rows[at] & id_mask }
                };
                ids.extend(centres.iter().zip(&edge_of).map(id));
            }
        }
        Ok(all)
    }

    /// Makes room for what the counters of a frame demanded; whether there was enough.
    fn fits(&mut self, submitted: &Submitted) -> Result<bool> {
        let words = read_words(&self.gpu, &submitted.status)?;
        let most =
            |counter: u32| words.chunks_exact(COUNTERS as usize).map(|s| s[counter as usize]).max().unwrap_or(0) as u64;
        let need = Capacities {
            queue: (0..COUNT_WORK).map(most).max().unwrap_or(0),
            work: most(COUNT_WORK),
            tasks: most(COUNT_TASKS),
            pairs: most(COUNT_PAIRS),
            doubts: most(COUNT_DOUBTS).max(2 * most(COUNT_SAMPLE_DOUBTS)),
            edges: most(COUNT_EDGES),
        };
        let have = self.resident.capacities;
        let fits =
            need.queue <= have.queue && need.work <= have.work && need.tasks <= have.tasks && need.pairs <= have.pairs;
        let is_left = |job: &[u32]| job[COUNT_BUSY as usize] > job[COUNT_BUSY_END as usize];
        let is_done = !self.plan.variant.by_tile || !words.chunks_exact(COUNTERS as usize).any(is_left);
        if fits && need.doubts <= have.doubts && need.edges <= have.edges && is_done {
            return Ok(true);
        }
        self.timed.grown += 1;
        if !is_done {
            self.resident.raster_rounds *= 2;
        }
        self.resident.grow(&self.gpu, &self.camera, &self.plan, need)?;
        Ok(false)
    }

    fn counts(&self, submitted: &Submitted) -> Result<Counts> {
        let words = read_words(&self.gpu, &submitted.status)?;
        let sum = |counter: u32| words.chunks_exact(COUNTERS as usize).map(|s| s[counter as usize] as u64).sum();
        Ok(Counts {
            pairs_tested: sum(COUNT_PAIRS_TESTED),
            pairs_kept: sum(COUNT_PAIRS_KEPT),
            fragments_tested: sum(COUNT_FRAGMENTS_TESTED),
            fragments_kept: sum(COUNT_FRAGMENTS_KEPT),
            rechecked: sum(COUNT_RECHECKED),
            edges: sum(COUNT_EDGES),
        })
    }
}

/// The median of every stage over the runs.
fn medians(runs: Vec<Vec<(&'static str, f64)>>) -> Vec<(&'static str, f64)> {
    let Some(first) = runs.first() else { return Vec::new() };
    let median = |name: &str| {
        let mut ms: Vec<f64> = runs.iter().flatten().filter(|s| s.0 == name).map(|s| s.1).collect();
        ms.sort_by(f64::total_cmp);
        ms[ms.len() / 2]
    };
    first.iter().map(|&(name, _)| (name, median(name))).collect()
}

/// The scene with every vertex but the last `fixed`, which are a mirror's, turned about its middle by a little more each
/// frame.
fn moved(scene: &Scene, fixed: usize, frame: u32) -> Scene {
    let mut scene = scene.clone();
    let (lo, hi) = scene.bounds().unwrap_or((DVec3::ZERO, DVec3::ZERO));
    let (middle, turn) = ((lo + hi) / 2.0, DMat3::from_rotation_y(frame as f64 * MOVING_STEP_RAD));
    let moving = scene.mesh.positions.len() - fixed;
    let positions = &mut Arc::make_mut(&mut scene.mesh).positions;
    positions[..moving].iter_mut().for_each(|p| *p = middle + turn * (*p - middle));
    scene
}

/// How far a moving scene turns a frame.
const MOVING_STEP_RAD: f64 = 0.01;
