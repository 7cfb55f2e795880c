//! Parts of a scene that can change a frame. Kernels are compiled for these alone, so that a part that does not show costs nothing.
//!
//! A part is left out only if it provably changes no pixel: no ray of the image meets its box ([`rays`]), or it is a light that emits nothing or
//! reaches nothing visible. Curved rays and rays after a bounce have no bounds: every box counts as met in their frames.

pub mod beams;
mod lamps;
pub mod objects;
pub mod rays;

use super::RunOptions;
use super::left_out::LeftOut;
use super::plan::{Plan, SceneContents, Wanted};
use crate::camera::Camera;
use crate::geometry::mesh::joined;
use crate::image::frame::Channel;
use crate::scene::Scene;
use crate::scene::caustics::Receiver;
use crate::scene::light::{Light, Source};
use beams::Beams;
use glam::DVec3;
use lamps::Sides;
use objects::{Kinds, Objects};
use rays::ImageRays;
use std::borrow::Cow;
use std::sync::Arc;

/// The parts of a scene that can change a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct InView {
    pub kinds: Kinds,
    /// The camera's mirror or lens.
    pub optics: bool,
    pub volume: bool,
    pub caustics: bool,
    /// Bit k is set if projector light k can change the frame; lights from index 64 on are always kept.
    pub pictures: u64,
    /// Whether lights that emit nothing are kept.
    pub black_lights: bool,
    /// Bit k is set if light k is a lamp whose light reaches nothing in view: [`lamps`].
    pub hidden_lights: u64,
}

/// Facts about a scene that hold for all of its frames.
#[derive(Default)]
pub struct SceneFacts {
    pub objects: Objects,
    pub beams: Beams,
    sides: Sides,
}

/// Black light that replaces the lights of a scene when all are left out; without it the scene would get a headlight.
const DARKNESS: Light = Light { source: Source::Distant(DVec3::X), colour: [0.0; 3], casts_shadows: false };

impl InView {
    pub const ALL: InView = InView {
        kinds: Kinds::ALL,
        optics: true,
        volume: true,
        caustics: true,
        pictures: u64::MAX,
        black_lights: true,
        hidden_lights: 0,
    };

    /// No part but what surfaces look like.
    pub const LOOKS: InView = InView {
        kinds: Kinds::LOOKS,
        optics: false,
        volume: false,
        caustics: false,
        pictures: 0,
        black_lights: false,
        hidden_lights: u64::MAX,
    };

    /// Returns the parts that can change a frame, and those that were `seen` in an earlier one: a part that comes into view changes the kernels
    /// and uploads all triangles, once. `plan` is the plan for the whole scene.
    pub fn of(
        (scene, facts): (&Scene, &SceneFacts),
        camera: &Camera,
        plan: &Plan,
        (wanted, run): (&Wanted, &RunOptions),
        seen: Option<InView>,
    ) -> InView {
        let is_checked = wanted.gradients || wanted.channels.contains(&Channel::Certified);
        if run.rival.is_some() || run.no_cull || run.moving || is_checked {
            return InView::ALL;
        }
        let rays = ImageRays::of(plan, camera.t_range);
        let is_met = |bounds| rays.is_none_or(|rays| rays.may_meet(bounds));
        let optics = camera.optics.as_ref().is_some_and(|optics| {
            let around = optics.surface.bounds();
            is_met((around.lo, around.hi))
        });
        let is_seen = |bounds| optics || is_met(bounds);
        // facets are no objects of the scene
        let pictures = if optics { u64::MAX } else { seen_pictures(scene, facts, is_seen) };
        let volume = scene.volume.as_ref().filter(|volume| is_seen(volume.grid.bounds()));
        // a volume is lit through triangles
        let hidden_lights = match optics || volume.is_some_and(|volume| volume.is_lit) {
            true => 0,
            false => lamps::hidden(scene, &facts.sides, rays.as_ref()),
        };
        let lit = InView { pictures, black_lights: false, hidden_lights, ..InView::ALL }.scene(scene);
        let has_shadow_rays =
            lit.has_shadows() && wanted.has_colour() || lit.hides_pictures() && wanted.needs_appearance();
        let needed = Kinds {
            // shadow rays go anywhere
            spheres: has_shadow_rays,
            alpha_masks: has_shadow_rays,
            // pictures are looked up by the size of the scene at all times
            motion: has_shadow_rays || !lit.projector_lights.is_empty(),
            ..Kinds::NONE
        };
        let needed = seen.map_or(needed, |seen| needed | seen.kinds);
        let in_view = InView {
            kinds: seen_kinds(scene, &facts.objects, plan.whole.0, needed, is_seen),
            optics,
            volume: volume.is_some(),
            caustics: scene.caustics.as_ref().is_some_and(|c| c.receivers.iter().any(|r| is_seen(receiver_box(r)))),
            pictures,
            black_lights: false,
            hidden_lights,
        };
        seen.map_or(in_view, |seen| in_view.joined(seen))
    }

    /// The parts of either.
    pub fn joined(self, other: InView) -> InView {
        InView {
            kinds: self.kinds | other.kinds,
            optics: self.optics || other.optics,
            volume: self.volume || other.volume,
            caustics: self.caustics || other.caustics,
            pictures: self.pictures | other.pictures,
            black_lights: self.black_lights || other.black_lights,
            hidden_lights: self.hidden_lights & other.hidden_lights,
        }
    }

    /// The scene without the parts that do not show, but for objects: these stay, so that every triangle has its number.
    pub fn scene<'a>(&self, scene: &'a Scene) -> Cow<'a, Scene> {
        let is_kept = |(k, light): (usize, &Light)| !self.is_hidden(k) && (self.black_lights || !is_black(light));
        let is_lit: Vec<bool> = scene.lights.iter().enumerate().map(is_kept).collect();
        let is_thrown = |k: usize| self.pictures.checked_shr(k as u32).is_none_or(|bits| bits & 1 == 1);
        let leaves = [
            scene.steps.is_some() && !self.kinds.motion,
            scene.volume.is_some() && !self.volume,
            scene.caustics.is_some() && !self.caustics,
            is_lit.contains(&false),
            !(0..scene.projector_lights.len()).all(is_thrown),
        ];
        if !leaves.contains(&true) {
            return Cow::Borrowed(scene);
        }
        let mut shown = scene.clone();
        shown.steps = shown.steps.filter(|_| self.kinds.motion);
        shown.volume = shown.volume.filter(|_| self.volume);
        shown.caustics = shown.caustics.filter(|_| self.caustics);
        let lights = scene.lights.iter().zip(is_lit);
        shown.lights = lights.filter(|(_, is_kept)| *is_kept).map(|(light, _)| *light).collect();
        let thrown = scene.projector_lights.iter().enumerate().filter(|(k, _)| is_thrown(*k));
        shown.projector_lights = thrown.map(|(_, light)| light.clone()).collect();
        if shown.has_headlight() && !scene.has_headlight() {
            shown.lights.push(DARKNESS);
        }
        Cow::Owned(shown)
    }

    /// The camera without the mirror or lens that does not show.
    pub fn camera<'a>(&self, camera: &'a Arc<Camera>) -> Cow<'a, Arc<Camera>> {
        match &camera.optics {
            Some(_) if !self.optics => Cow::Owned(Arc::new(Camera { optics: None, ..Camera::clone(camera) })),
            _ => Cow::Borrowed(camera),
        }
    }

    /// Returns the contents of the scene `shown`, reduced to these parts; `whole` are the contents of the whole scene.
    pub fn contents(&self, shown: &Scene, whole: SceneContents) -> SceneContents {
        SceneContents {
            has_spheres: whole.has_spheres && self.kinds.spheres,
            has_capsules: whole.has_capsules && self.kinds.spheres,
            has_images: whole.has_images && self.kinds.images,
            has_alpha_masks: whole.has_alpha_masks && self.kinds.alpha_masks,
            has_normals: whole.has_normals && self.kinds.smooth_normals,
            has_colors: whole.has_colors && self.kinds.vertex_colors,
            has_style: shown.style.is_on_surfaces() || whole.has_style && self.kinds.patterns,
            has_caustics: whole.has_caustics && self.caustics,
            has_positional_lights: !shown.lights.iter().all(Light::is_plain),
            has_shadows: shown.has_shadows(),
            has_pictures: !shown.projector_lights.is_empty(),
            steps: shown.step_count(),
            volume: whole.volume.filter(|_| self.volume),
            ..whole
        }
    }

    /// Light `k` reaches nothing in view.
    fn is_hidden(&self, k: usize) -> bool {
        self.hidden_lights.checked_shr(k as u32).is_some_and(|bits| bits & 1 == 1)
    }

    /// The number of black lights that are left out.
    pub fn black_lights_left_out(&self, scene: &Scene) -> usize {
        let lights = scene.lights.iter().enumerate();
        if self.black_lights { 0 } else { lights.filter(|(k, light)| is_black(light) && !self.is_hidden(*k)).count() }
    }

    /// The parts that are left out of a scene with the contents `whole`, for reports.
    pub fn left_out(&self, scene: &Scene, camera: &Camera, wanted: &Wanted, whole: SceneContents) -> Vec<LeftOut> {
        let is_lit = wanted.has_colour();
        let black = self.black_lights_left_out(scene);
        let idle = scene.projector_lights.len() - self.scene(scene).projector_lights.len();
        let rows = [
            (whole.has_spheres && !self.kinds.spheres, LeftOut::NotInView("spheres")),
            (whole.steps > 1 && !self.kinds.motion, LeftOut::NotInView("time steps")),
            (whole.has_images && !self.kinds.images && wanted.needs_appearance(), LeftOut::NotInView("textures")),
            (whole.has_alpha_masks && !self.kinds.alpha_masks, LeftOut::NotInView("alpha masks")),
            (whole.has_normals && !self.kinds.smooth_normals, LeftOut::NotInView("smooth normals")),
            (
                whole.has_colors && !self.kinds.vertex_colors && wanted.needs_appearance(),
                LeftOut::NotInView("vertex colours"),
            ),
            (
                whole.has_style && !self.kinds.patterns && !scene.style.is_on_surfaces() && wanted.needs_appearance(),
                LeftOut::NotInView("patterns"),
            ),
            (camera.optics.is_some() && !self.optics, LeftOut::NotInView("bounce, fit and meet")),
            (whole.volume.is_some() && !self.volume && wanted.needs_volume(), LeftOut::NotInView("volume")),
            (scene.caustics.is_some() && !self.caustics && is_lit, LeftOut::NotInView("caustics")),
            (black > 0 && is_lit, LeftOut::BlackLights(black)),
            (self.hidden_lights != 0 && is_lit, LeftOut::HiddenLights(self.hidden_lights.count_ones() as usize)),
            (idle > 0 && wanted.needs_appearance(), LeftOut::IdleProjectorLights(idle)),
        ];
        rows.into_iter().filter_map(|(is_left_out, row)| is_left_out.then_some(row)).collect()
    }
}

/// The kinds of content that are needed anyway, and those of objects that are seen.
fn seen_kinds(
    scene: &Scene,
    objects: &Objects,
    whole: SceneContents,
    needed: Kinds,
    is_seen: impl Fn((DVec3, DVec3)) -> bool,
) -> Kinds {
    let all = Kinds {
        spheres: whole.has_spheres,
        motion: whole.steps > 1,
        images: whole.has_images,
        alpha_masks: whole.has_alpha_masks,
        smooth_normals: whole.has_normals,
        vertex_colors: whole.has_colors,
        patterns: whole.has_style,
    };
    // a scene of one object shows its own look, or nothing
    let needed = if scene.objects.len() < 2 { needed | Kinds::LOOKS } else { needed };
    let mut found = needed & all;
    if scene.mesh.instances().is_some() {
        // boxes of objects are found from one mesh: instances would have to be copied
        return all;
    }
    if found == all {
        return found;
    }
    for object in objects.of(scene) {
        if object.kinds & all & !found != Kinds::NONE && is_seen(object.bounds) {
            found = found | object.kinds;
        }
    }
    found & all
}

/// A bit for each of the first projector lights whose picture may reach an object that is seen.
fn seen_pictures(scene: &Scene, facts: &SceneFacts, is_seen: impl Fn((DVec3, DVec3)) -> bool) -> u64 {
    if scene.projector_lights.is_empty() {
        return 0;
    }
    if scene.mesh.instances().is_some() {
        // boxes of objects are found from one mesh
        return u64::MAX;
    }
    let Some(reached) = facts.beams.reached(scene, &facts.objects) else { return u64::MAX };
    let objects = facts.objects.of(scene);
    let is_needed = |of_light: &Vec<bool>| {
        objects.iter().zip(of_light).any(|(object, is_reached)| *is_reached && is_seen(object.bounds))
    };
    let bits = reached.iter().take(u64::BITS as usize).enumerate();
    bits.map(|(k, of_light)| u64::from(is_needed(of_light)) << k).sum()
}

/// The light sends out nothing.
fn is_black(light: &Light) -> bool {
    light.colour == [0.0; 3]
}

/// The box around a receiver of caustics.
fn receiver_box(receiver: &Receiver) -> (DVec3, DVec3) {
    let Receiver { origin, u, v, .. } = *receiver;
    let corners = [origin, origin + u, origin + v, origin + u + v].map(|p| (p, p));
    corners.into_iter().fold((origin, origin), joined)
}
