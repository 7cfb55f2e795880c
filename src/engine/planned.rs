//! What frames take, worked out before a device is touched; what did not change since an earlier frame is taken from there.

use super::RunOptions;
use super::changes::{PlannedBy, same_places, same_triangles};
use super::combinations::Asked;
use super::medium::node_bytes;
use crate::camera::ray_order::reordered;
use crate::camera::{Camera, Rays};
use crate::engine::call_ms::{CallMs, ms_since};
use crate::engine::clusters::{Clustered, cluster};
use crate::engine::plan::variant::{method, variant};
use crate::engine::plan::{Plan, PlanTarget, SceneContents, SceneExtent, SceneShape, Wanted};
use crate::geometry::mesh::Mesh;
use crate::gpu::device::AdapterFeatures;
use crate::gpu::kernels::Method;
use crate::image::frame::Channel;
use crate::input::{Error, Result};
use crate::scene::Scene;
use crate::scene::style::Style;
use std::borrow::Cow;
use std::sync::{Arc, Weak};
use std::time::Instant;

/// Plans for an adapter.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Planner {
    /// The adapter's name.
    pub name: String,
    pub has: AdapterFeatures,
    /// Bytes that a kernel can see at once.
    pub limit: u64,
    /// As [`Gpu::table_limit`](crate::gpu::Gpu::table_limit).
    pub table_limit: u64,
}

/// A frame, planned.
#[derive(Clone)]
pub struct Planned {
    /// With the facets of the camera's optics, as the last triangles of its mesh.
    pub(super) scene: Scene,
    /// The scene's mesh without these facets.
    pub(super) own_mesh: Arc<Mesh>,
    /// The same of the scene without these facets.
    shape: SceneShape,
    /// With its pixels in the order of their rays, where these are incoherent.
    pub(super) camera: Arc<Camera>,
    /// The camera with its pixels in their own order; only to recognize it.
    asked: Weak<Camera>,
    pub(super) plan: Arc<Plan>,
    pub(super) clustered: Arc<Clustered>,
    pub(super) wanted: Wanted,
    /// Times of its parts `place` and `plan`.
    pub(super) call: CallMs,
}

impl Planned {
    /// The scene that was asked for.
    pub(super) fn scene_without_optics(&self) -> Scene {
        Scene { mesh: self.own_mesh.clone(), ..self.scene.clone() }
    }
}

/// Bytes that the widest table of a band has a pixel and sample: a ray of a ray map, hi or lo, or by what it differs.
const FIELD_BYTES: u64 = 24;

/// And a record of samples for each of them, and one more.
const KEY_BYTES: u64 = 8;

/// Bytes of a normal on the device.
const NORMAL_BYTES: u64 = 12;

impl Planner {
    /// Refuses an image whose smallest band does not fit the adapter.
    ///
    /// # Errors
    /// [`Error::Input`] that names the limit.
    pub fn check_size(&self, camera: &Camera, wanted: &Wanted) -> Result<()> {
        let is_field = camera.layers.iter().any(|l| matches!(l, Rays::Field(_)));
        let samples = match u64::from(wanted.samples) {
            1 => 0,
            n if is_field => FIELD_BYTES * n,
            n => KEY_BYTES * (n + 1),
        };
        let pixel = (4 * (wanted.channels.len() as u64 + 3)).max(FIELD_BYTES).max(samples);
        // one tile's rows and one more, one column more
        let row = u64::from(crate::camera::TILE + 1) * pixel;
        let widest = (self.limit / row).saturating_sub(1);
        if u64::from(camera.width) <= widest {
            return Ok(());
        }
        let (width, name, limit) = (camera.width, &self.name, self.limit);
        Err(Error::input(format!(
            "the image is {width} pixels wide; adapter {name} binds at most {limit} bytes of storage \
             (max_storage_buffer_binding_size), which holds {widest}; make it narrower or use --engine reference"
        )))
    }

    /// Plans frames of `scene` through `camera`. Of `run` all counts but how often it is repeated. Parts of `last` are taken over
    /// where they are the same: the plan for the same [`Arc`] of a camera, and the clusters for that of a mesh.
    ///
    /// # Errors
    /// [`Error::Input`] where the scene, the camera and what is wanted do not go together.
    pub fn plan(
        &self,
        scene: &Scene,
        camera: impl Into<Arc<Camera>>,
        wanted: &Wanted,
        run: &RunOptions,
        last: Option<&Planned>,
    ) -> Result<Planned> {
        let started = Instant::now();
        let asked: Arc<Camera> = camera.into();
        let shape = shape(scene, last);
        let centre = SceneExtent::of(&asked, shape).centre;
        let known = last.filter(|l| l.asked.as_ptr() == Arc::as_ptr(&asked) && l.plan.centre == centre);
        let camera = match known {
            Some(last) => last.camera.clone(),
            None => reordered(&asked, centre).map_or_else(|| asked.clone(), Arc::new),
        };
        let planned = self.plan_in_order((scene, shape), camera, wanted, run, last)?;
        let plan = ms_since(started) - planned.call.place;
        Ok(Planned { asked: Arc::downgrade(&asked), call: CallMs { plan, ..planned.call }, ..planned })
    }

    /// The same by raster, for frames that could not be traced: where tracing was this engine's own choice, and raster can show them.
    pub(super) fn rasterized(&self, planned: &Planned, run: &RunOptions) -> Option<Planned> {
        if run.method != Method::Auto {
            return None;
        }
        let run = RunOptions { method: Method::Raster, ..run.clone() };
        let scene = planned.scene_without_optics();
        let again =
            self.plan_in_order((&scene, planned.shape), planned.camera.clone(), &planned.wanted, &run, None).ok()?;
        (again.plan.variant.method == Method::Raster).then(|| Planned { asked: planned.asked.clone(), ..again })
    }

    /// The same with the camera's pixels in the order that they are in.
    pub(super) fn plan_in_order(
        &self,
        (scene, shape): (&Scene, SceneShape),
        camera: Arc<Camera>,
        wanted: &Wanted,
        run: &RunOptions,
        last: Option<&Planned>,
    ) -> Result<Planned> {
        let own_mesh = scene.mesh.clone();
        let asked_for = Asked {
            rival: run.rival,
            no_cull: run.no_cull,
            moving: run.moving,
            raster: run.method == Method::Raster,
            ..Asked::new(scene, &camera, wanted)
        };
        asked_for.check()?;
        let whole = scene.with_optics(&camera);
        let shape_of_whole = if matches!(whole, Cow::Borrowed(_)) { shape } else { SceneShape::of(&whole) };
        let scene = whole.into_owned();
        let extent = SceneExtent::of(&camera, shape_of_whole);
        check_size(shape_of_whole, extent)?;
        scene.check_depth(&wanted.channels)?;
        self.check_normals(&scene)?;
        self.check_volume(&scene)?;
        let plan = self.plan_of(&scene, &camera, extent, wanted, run, last);
        let started = Instant::now();
        let clustered = match last.filter(|l| same_places(l, &scene, &plan)) {
            Some(last) if last.plan.anchor == plan.anchor => last.clustered.clone(),
            Some(last) => Arc::new(last.clustered.anchored(scene.moving_mesh(), plan.anchor)),
            None => Arc::new(cluster(scene.moving_mesh(), plan.anchor, plan.variant.surfaces(), self.table_limit)),
        };
        let call = CallMs { place: ms_since(started), ..CallMs::default() };
        Asked { planned: Some((&plan, clustered.chunks.len())), ..asked_for }.check()?;
        let (asked, wanted) = (Arc::downgrade(&camera), wanted.clone());
        Ok(Planned { scene, own_mesh, shape, camera, asked, plan, clustered, wanted, call })
    }

    /// Refuses more normals than one binding holds, before any work on the triangles.
    fn check_normals(&self, scene: &Scene) -> Result<()> {
        let (normals, limit, name) = (scene.mesh.normals.len(), self.limit, &self.name);
        let normals = normals * scene.moving_mesh().count() as usize;
        if NORMAL_BYTES * normals as u64 <= limit {
            return Ok(());
        }
        Err(Error::input(format!(
            "the scene has {normals} normals; adapter {name} binds at most {limit} bytes of storage \
             (max_storage_buffer_binding_size), enough for {}; use a coarser mesh or --engine reference",
            limit / NORMAL_BYTES
        )))
    }

    /// Refuses a volume of more nodes than one binding holds.
    fn check_volume(&self, scene: &Scene) -> Result<()> {
        let Some(volume) = &scene.volume else { return Ok(()) };
        let (nodes, limit, name) = (volume.grid.values.len(), self.limit, &self.name);
        let most = limit / node_bytes(volume);
        if nodes as u64 <= most {
            return Ok(());
        }
        Err(Error::input(format!(
            "the volume has {nodes} nodes; adapter {name} binds at most {limit} bytes of storage \
             (max_storage_buffer_binding_size), enough for {most}; use a coarser volume or --engine reference"
        )))
    }

    fn plan_of(
        &self,
        scene: &Scene,
        camera: &Arc<Camera>,
        extent: SceneExtent,
        wanted: &Wanted,
        run: &RunOptions,
        last: Option<&Planned>,
    ) -> Arc<Plan> {
        let contents = SceneContents::of(scene);
        let written = written(scene, camera, wanted);
        let variant = variant(camera, contents, &written, self.has, run);
        let by = PlannedBy { scene, camera, extent, wanted, variant };
        match last.filter(|last| by.is_that_of(last)) {
            Some(last) => last.plan.clone(),
            None => {
                let plan = self.plan_by(run, camera, (contents, extent), &written, last.map(|last| &*last.plan));
                Arc::new(scene.moments(camera).map_or(plan.clone(), |moments| plan.with_moments(&moments)))
            }
        }
    }

    /// The plan of frames with these options, with exactly the wanted channels; what follows from the lens alone is taken from `last`.
    pub(super) fn plan_by(
        &self,
        run: &RunOptions,
        camera: &Camera,
        (contents, extent): (SceneContents, SceneExtent),
        wanted: &Wanted,
        last: Option<&Plan>,
    ) -> Plan {
        let variant = variant(camera, contents, wanted, self.has, run);
        let method_why = method(camera, contents, wanted, self.has, run).1;
        let target =
            PlanTarget { has: self.has, binding_limit: self.limit, aims: run.rival.is_none() && variant.f64, last };
        Plan { method_why, ..Plan::on(target, variant, camera, contents, extent, wanted) }
    }
}

/// `wanted` with the channels that caustics and lines between pixels follow from.
pub(super) fn written(scene: &Scene, camera: &Camera, wanted: &Wanted) -> Wanted {
    let mut channels = wanted.channels.clone();
    if scene.caustics.is_some() && wanted.has_colour() {
        channels.extend([Channel::BaryU, Channel::BaryV]);
        if scene.mesh.has_changing_colors() {
            channels.extend([Channel::AlbedoR, Channel::AlbedoG, Channel::AlbedoB]);
        }
    }
    if wanted.has_colour() {
        channels.extend(outlined_by(&scene.style, camera));
    }
    Wanted { channels, ..wanted.clone() }
}

/// What lines between pixels follow from.
pub(super) fn outlined_by(style: &Style, camera: &Camera) -> Vec<Channel> {
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

/// The shape of a scene, taken over where it is that of `last`.
fn shape(scene: &Scene, last: Option<&Planned>) -> SceneShape {
    last.filter(|last| same_triangles(last, scene)).map_or_else(|| SceneShape::of(scene), |last| last.shape)
}

/// Supported scene sizes, world units: outside them f32 and pairs of f32 overflow or underflow.
const SIZES: [f64; 2] = [1e-12, 1e30];

/// The engine's f32 can hold the scene.
fn check_size(shape: SceneShape, extent: SceneExtent) -> Result<()> {
    let Some((lo, hi)) = shape.bounds else { return Ok(()) };
    let reach = (hi - extent.anchor).max(extent.anchor - lo).max_element();
    let [least, most] = SIZES;
    if reach > 0.0 && !(least..=most).contains(&reach) {
        let advice = "scale the scene and its camera, or use --engine reference";
        let range = format!("supported are {least:.0e} to {most:.0e}");
        return Err(Error::input(format!("the scene extends {reach:.1e} from the camera; {range}: {advice}")));
    }
    Ok(())
}
