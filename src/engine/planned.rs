//! What frames take, worked out before a device is touched; what did not change since an earlier frame is taken from there.

use super::RunOptions;
use super::changes::{PlannedBy, same_places, same_triangles};
use super::combinations::Asked;
use super::in_view::{InView, SceneFacts};
use super::medium::node_bytes;
use crate::camera::optics::Facets;
use crate::camera::ray_order::reordered;
use crate::camera::{Camera, Rays};
use crate::engine::call_ms::{CallMs, ms_since};
use crate::engine::clusters::instances::PlacedMeshes;
use crate::engine::clusters::{Clustered, cluster_scene};
use crate::engine::plan::variant::{method, variant};
use crate::engine::plan::{Plan, PlanTarget, SceneContents, SceneExtent, SceneShape, Wanted};
use crate::geometry::instances::Instances;
use crate::geometry::scene_mesh::SceneMesh;
use crate::gpu::device::AdapterFeatures;
use crate::gpu::kernels::{Method, SurfaceKind};
use crate::image::frame::Channel;
use crate::input::{Error, Result};
use crate::scene::Scene;
use crate::scene::style::Style;
use glam::DVec3;
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
    /// The parts that show, with the facets of the camera's optics as the last triangles of the mesh.
    pub(super) scene: Arc<Scene>,
    /// The camera, without its optics where these do not show.
    pub(super) camera: Arc<Camera>,
    /// The scene and the camera with all parts.
    pub(super) whole: Whole,
    /// The camera with its pixels in their own order; only to recognize it.
    asked: Weak<Camera>,
    pub(super) plan: Arc<Plan>,
    pub(super) clustered: Arc<Clustered>,
    pub(super) wanted: Wanted,
    /// Times of its parts `place` and `plan`.
    pub(super) call: CallMs,
}

/// A scene and a camera with all parts, shown or not.
#[derive(Clone)]
pub(super) struct Whole {
    /// Without the facets of the camera's optics.
    pub scene: Arc<Scene>,
    pub shape: SceneShape,
    /// Facts about these triangles and projector lights.
    pub facts: Arc<SceneFacts>,
    /// With its pixels in the order of their rays, where these are incoherent.
    pub camera: Arc<Camera>,
    /// The triangles with the facets of the camera's optics, if it has some.
    pub with_facets: Option<WithFacets>,
}

/// The triangles of a scene, and the facets of a camera's optics as the last ones.
#[derive(Clone)]
pub(super) struct WithFacets {
    mesh: Arc<SceneMesh>,
    shape: SceneShape,
}

impl Planned {
    /// The parts of the scene that show, without the facets of the camera's optics.
    pub(super) fn scene_without_optics(&self) -> Arc<Scene> {
        match Arc::ptr_eq(&self.scene.mesh, &self.whole.scene.mesh) {
            true => self.scene.clone(),
            false => Arc::new(Scene { mesh: self.whole.scene.mesh.clone(), ..Scene::clone(&self.scene) }),
        }
    }
}

impl Whole {
    /// Takes over from `last` what follows from the triangles alone, where these are the same.
    fn of(scene: &Scene, camera: Arc<Camera>, shape: SceneShape, last: Option<&Planned>) -> Whole {
        let has_same_beams = |last: &&Planned| last.whole.scene.projector_lights == scene.projector_lights;
        let same = last.filter(|last| same_triangles(last, scene));
        let facts = same.filter(has_same_beams).map_or_else(Arc::default, |last| last.whole.facts.clone());
        let with_facets = WithFacets::of(scene, &camera, same);
        Whole { scene: Arc::new(scene.clone()), shape, facts, camera, with_facets }
    }

    /// The scene with the facets of the camera's optics; the scene itself if there are none.
    fn with_optics(&self) -> Cow<'_, Scene> {
        match &self.with_facets {
            Some(WithFacets { mesh, .. }) => Cow::Owned(Scene { mesh: mesh.clone(), ..Scene::clone(&self.scene) }),
            None => Cow::Borrowed(&self.scene),
        }
    }

    fn shape_with_optics(&self) -> SceneShape {
        self.with_facets.as_ref().map_or(self.shape, |all| all.shape)
    }
}

impl WithFacets {
    /// Takes over the triangles of `last`, a plan for the same scene, if its camera has the same facets. `None`: the camera has no facets.
    fn of(scene: &Scene, camera: &Camera, last: Option<&Planned>) -> Option<WithFacets> {
        if let Some(last) = last.filter(|last| last.whole.with_facets.is_some())
            && facets_of(&last.whole.camera) == facets_of(camera)
        {
            return last.whole.with_facets.clone();
        }
        match scene.with_optics(camera) {
            Cow::Owned(all) => Some(WithFacets { shape: SceneShape::of(&all), mesh: all.mesh }),
            Cow::Borrowed(_) => None,
        }
    }
}

/// The facets of a camera's optics, and their color.
fn facets_of(camera: &Camera) -> Option<(&Facets, [f32; 3])> {
    camera.optics.as_ref().and_then(|optics| Some((optics.facets()?, optics.base)))
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
        let is_alike = |l: &&Planned| l.whole.scene.mesh.base().is_blended() == scene.mesh.base().is_blended();
        let known =
            last.filter(|l| l.asked.as_ptr() == Arc::as_ptr(&asked) && l.plan.centre == centre).filter(is_alike);
        let camera = match known {
            Some(last) => last.whole.camera.clone(),
            None => in_order(scene, &asked, centre).map_or_else(|| asked.clone(), Arc::new),
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
        let Whole { scene, shape, camera, .. } = &planned.whole;
        let again = self.plan_in_order((scene, *shape), camera.clone(), &planned.wanted, &run, None).ok()?;
        (again.plan.variant.method() == Method::Raster).then(|| Planned { asked: planned.asked.clone(), ..again })
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
        let asked_for = Asked::of(scene, &camera, wanted, run);
        asked_for.check()?;
        if asked_for.is_separate() {
            return Err(Error::input("each sample takes a frame here; call Engine::render"));
        }
        if camera.layered().is_some() {
            return Err(Error::input("frames of this composite are composed of several; call Engine::render"));
        }
        if facets_of(&camera).is_some() {
            // they are appended to one mesh
            scene.mesh.check_copies(scene.limits)?;
        }
        let whole = Whole::of(scene, camera.clone(), shape, last);
        let with_optics = whole.with_optics();
        let shape_of_all = whole.shape_with_optics();
        let extent = SceneExtent::of(&whole.camera, shape_of_all);
        check_size(shape_of_all, extent)?;
        scene.check_depth(&wanted.channels)?;
        self.check_volume(scene)?;
        let plan = self.plan_of(&whole, &with_optics, extent, wanted, run, last);
        if !plan.variant.is_instanced() {
            scene.mesh.check_copies(scene.limits)?;
        }
        self.check_normals(&with_optics, plan.variant.is_instanced())?;
        let scene = match plan.in_view.optics && whole.with_facets.is_some() {
            true => Arc::new(plan.in_view.scene(&with_optics).into_owned()),
            false => match plan.in_view.scene(&whole.scene) {
                Cow::Borrowed(_) => whole.scene.clone(),
                Cow::Owned(shown) => Arc::new(shown),
            },
        };
        let shown_camera = plan.in_view.camera(&whole.camera).into_owned();
        let started = Instant::now();
        let clustered = match last.filter(|l| same_places(l, &scene, &plan)) {
            Some(last) if last.plan.anchor == plan.anchor => last.clustered.clone(),
            Some(last) => Arc::new(last.clustered.anchored(plan.anchor)),
            None => Arc::new(match last.and_then(|last| moved(last, &scene, &plan)) {
                Some(moved) => moved,
                None => {
                    run.share.enter("sorting triangles");
                    cluster_scene(&scene, plan.anchor, plan.variant, self.table_limit)
                }
            }),
        };
        let call = CallMs { place: ms_since(started), ..CallMs::default() };
        Asked { planned: Some((&plan, clustered.chunks.len())), ..asked_for }.check()?;
        let (asked, wanted) = (Arc::downgrade(&camera), wanted.clone());
        Ok(Planned { scene, camera: shown_camera, whole, asked, plan, clustered, wanted, call })
    }

    /// The contents of a scene. The scene counts as having instances only if their matrices have inverses and their tables fit the adapter.
    pub(super) fn contents(&self, scene: &Scene) -> SceneContents {
        let contents = SceneContents::of(scene);
        let fit = |i: &Arc<Instances>| PlacedMeshes::fit(i, SurfaceKind::Colored, self.table_limit);
        let has_instances = scene.mesh.has_invertible_instances() && scene.mesh.instances().is_some_and(fit);
        SceneContents { has_instances, ..contents }
    }

    /// Refuses more normals than one binding holds, before any work on the triangles.
    fn check_normals(&self, scene: &Scene, instanced: bool) -> Result<()> {
        let mesh = if instanced { scene.mesh.base() } else { scene.mesh.mesh() };
        let (normals, limit, name) = (mesh.normals.len(), self.limit, &self.name);
        let normals = normals * scene.step_count() as usize;
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
        whole: &Whole,
        with_optics: &Scene,
        extent: SceneExtent,
        wanted: &Wanted,
        run: &RunOptions,
        last: Option<&Planned>,
    ) -> Arc<Plan> {
        let Whole { scene, camera, .. } = whole;
        let contents = self.contents(with_optics);
        let written = written(scene, camera, wanted);
        let variant = variant(camera, contents, &written, self.has, run);
        let by = PlannedBy { scene, camera, extent, wanted, whole: (contents, variant) };
        let seen = last.filter(|last| same_triangles(last, scene) && last.wanted == *wanted).map(|last| InView {
            // a light that is black for a while takes no kernels away
            black_lights: last.plan.in_view.black_lights
                || last.whole.scene.lights != scene.lights
                    && last.plan.variant.appearance.lights == variant.appearance.lights,
            ..last.plan.in_view
        });
        // objects that change from call to call are not looked through for kinds of looks
        let has_changed = last.is_some_and(|last| !same_triangles(last, scene));
        let seen = if has_changed { Some(InView::LOOKS) } else { seen };
        if let Some(last) = last.filter(|last| by.is_that_of(last)) {
            let in_view = InView::of((scene, &whole.facts), camera, &last.plan, (wanted, run), seen);
            let shown = in_view.contents(&in_view.scene(scene), contents);
            let has_same_lights =
                in_view.black_lights_left_out(scene) == in_view.black_lights_left_out(&last.whole.scene);
            if (in_view, shown) == (last.plan.in_view, last.plan.contents) && has_same_lights {
                return last.plan.clone();
            }
        }
        let last = last.map(|last| (&*last.plan, &*last.whole.camera));
        let plan = self.plan_by(run, whole, (contents, extent), wanted, (seen, last));
        Arc::new(plan.at_its_moments(scene, camera))
    }

    /// The plan of frames with these options of the parts of a scene that show, and of those that were `seen` before; what no pose changes is taken
    /// from `last`, an earlier plan and its camera. `contents` are with the facets of the camera's optics.
    pub(super) fn plan_by(
        &self,
        run: &RunOptions,
        whole: &Whole,
        (contents, extent): (SceneContents, SceneExtent),
        wanted: &Wanted,
        (seen, last): (Option<InView>, Option<(&Plan, &Camera)>),
    ) -> Plan {
        let Whole { scene, camera, .. } = whole;
        let all = written(scene, camera, wanted);
        let variant_of_all = variant(camera, contents, &all, self.has, run);
        let aims = run.rival.is_none() && variant_of_all.f64();
        let target = PlanTarget { has: self.has, binding_limit: self.limit, aims, last };
        let method_why = method(camera, contents, &all, self.has, run).1;
        let plan = Plan { method_why, ..Plan::on(target, variant_of_all, camera, contents, extent, &all) };
        let in_view = InView::of((scene, &whole.facts), camera, &plan, (wanted, run), seen);
        if in_view == InView::ALL {
            return plan;
        }
        let (shown, eye) = (in_view.scene(scene), in_view.camera(camera));
        let contents_shown = in_view.contents(&shown, contents);
        let wanted_shown = written(&shown, &eye, wanted);
        let variant = variant(&eye, contents_shown, &wanted_shown, self.has, run);
        if !plan.fits(variant, &wanted_shown, self.limit) {
            return plan;
        }
        let method_why = method(&eye, contents_shown, &wanted_shown, self.has, run).1;
        let mut plan = plan.showing(in_view, variant, contents_shown, &wanted_shown);
        plan.left_out.extend(in_view.left_out(scene, camera, wanted, contents));
        Plan { method_why, ..plan }
    }
}

/// `wanted` with the channels that caustics and lines between pixels follow from.
pub(super) fn written(scene: &Scene, camera: &Camera, wanted: &Wanted) -> Wanted {
    let mut channels = wanted.channels.clone();
    if scene.caustics.is_some() && wanted.has_colour() {
        channels.extend([Channel::BaryU, Channel::BaryV]);
        if scene.mesh.base().has_changing_colors() {
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
    if style.line_reach() > 0 {
        channels.push(TriangleId);
    }
    channels
}

/// The triangles of `last` for this plan, where only some of their vertices have moved.
fn moved(last: &Planned, scene: &Scene, plan: &Plan) -> Option<Clustered> {
    let by = |plan: &Plan| (plan.variant.surfaces(), plan.variant.has_round(), plan.variant.is_instanced());
    if scene.steps.is_some() || last.scene.steps.is_some() || by(&last.plan) != by(plan) {
        return None;
    }
    let moved = match (scene.mesh.instances(), plan.variant.is_instanced()) {
        (Some(instances), true) => last.clustered.placed_at(instances)?,
        _ => last.clustered.moved(&last.scene.mesh, &scene.mesh)?,
    };
    Some(if moved.anchor == plan.anchor { moved } else { moved.anchored(plan.anchor) })
}

/// The shape of a scene, taken over where it is that of `last`.
fn shape(scene: &Scene, last: Option<&Planned>) -> SceneShape {
    last.filter(|last| same_triangles(last, scene)).map_or_else(|| SceneShape::of(scene), |last| last.whole.shape)
}

/// The camera with its pixels in the order of their rays, if these are incoherent. Which samples of a pixel see a blended surface follows from
/// the pixel's own place.
pub(super) fn in_order(scene: &Scene, camera: &Camera, centre: DVec3) -> Option<Camera> {
    let is_of_place = camera.sample.is_some() && scene.mesh.base().is_blended();
    if is_of_place { None } else { reordered(camera, centre) }
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
