//! What changed since the last frame: one answer, by which plans and clusters are taken over, uploads are left out, and the steps of
//! a frame that are to run again are chosen.

use super::planned::Planned;
use crate::camera::Camera;
use crate::engine::plan::{Plan, SceneContents, SceneExtent, Wanted};
use crate::gpu::kernels::Variant;
use crate::scene::Scene;
use std::sync::Arc;

/// What of a frame is not as it was in the last one.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Changes {
    /// Rays, the size of the image, or what is wanted: all that a plan says.
    pub plan: bool,
    /// Triangles, or their order.
    pub triangles: bool,
    /// Places of triangles in the world.
    pub places: bool,
    /// Where triangles lie about the anchor.
    pub positions: bool,
    /// Alpha masks of triangles.
    pub alpha_masks: bool,
    /// Lights, materials, lines or the background.
    pub appearance: bool,
}

/// What changed since the picture was made, and so which stages are to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Dirty {
    Nothing,
    /// Lights or materials: what follows the visibility buffer.
    Appearance,
    All,
}

/// What is on the device.
pub(super) struct Shown<'a> {
    pub scene: &'a Scene,
    pub plan: &'a Arc<Plan>,
    /// [`Clustered::slots`] and [`Clustered::places`] of the triangles.
    pub slots: &'a Arc<()>,
    pub places: &'a Arc<()>,
}

impl Changes {
    /// Nothing is known of what was there.
    pub const ALL: Changes =
        Changes { plan: true, triangles: true, places: true, positions: true, alpha_masks: true, appearance: true };

    /// From what is shown to a frame that was planned.
    pub(super) fn between(shown: &Shown, next: &Planned) -> Changes {
        let Planned { scene, plan, clustered, .. } = next;
        Changes {
            plan: !Arc::ptr_eq(plan, shown.plan),
            triangles: !Arc::ptr_eq(shown.slots, &clustered.slots),
            places: !Arc::ptr_eq(shown.places, &clustered.places),
            positions: !(same_mesh(scene, shown.scene) && plan.anchor == shown.plan.anchor),
            // part of the mesh
            alpha_masks: false,
            appearance: !same_appearance(scene, shown.scene),
        }
    }

    /// What the device has of lights and materials follows from something that changed.
    pub fn needs_appearance(self) -> bool {
        self.positions || self.appearance
    }

    /// Which stages are to run again.
    pub fn dirty(self) -> Dirty {
        let Changes { plan, triangles, places, positions, alpha_masks, appearance } = self;
        match (plan || triangles || places || positions || alpha_masks, appearance) {
            (true, _) => Dirty::All,
            (false, true) => Dirty::Appearance,
            (false, false) => Dirty::Nothing,
        }
    }
}

/// Inputs of a plan, with all parts of the scene.
pub(super) struct PlannedBy<'a> {
    pub scene: &'a Scene,
    pub camera: &'a Arc<Camera>,
    pub extent: SceneExtent,
    pub wanted: &'a Wanted,
    pub whole: (SceneContents, Variant),
}

impl PlannedBy<'_> {
    /// The plan of `last` is the plan for this, if the same parts of the scene show.
    pub fn is_that_of(&self, last: &Planned) -> bool {
        let PlannedBy { scene, camera, extent, wanted, whole } = self;
        let Plan { anchor, origin, centre, scene_size, .. } = *last.plan;
        let was = &last.whole.scene;
        Arc::ptr_eq(&last.whole.camera, camera)
            && SceneExtent { anchor, origin, centre, scene_size } == *extent
            && last.wanted == **wanted
            && was.style == scene.style
            && last.plan.whole == *whole
            && (scene.steps.is_none() || same_steps(was, scene) && was.exposure == scene.exposure)
    }
}

/// The clusters of `last` hold the triangles of this scene for this plan, relative to this anchor or another one.
pub(super) fn same_places(last: &Planned, scene: &Scene, plan: &Plan) -> bool {
    let by = |plan: &Plan| (plan.variant.surfaces(), plan.variant.has_round(), plan.variant.is_instanced());
    same_mesh(&last.scene, scene) && by(&last.plan) == by(plan)
}

/// The scene of `last`, without the facets of a camera, is made of these triangles.
pub(super) fn same_triangles(last: &Planned, scene: &Scene) -> bool {
    same_mesh(&last.whole.scene, scene)
}

/// Both are made of the same triangles, not of equal ones.
fn same_mesh(a: &Scene, b: &Scene) -> bool {
    Arc::ptr_eq(&a.mesh, &b.mesh) && same_steps(a, b)
}

/// Both move alike.
fn same_steps(a: &Scene, b: &Scene) -> bool {
    match (&a.steps, &b.steps) {
        (Some(a), Some(b)) => Arc::ptr_eq(a, b),
        (None, None) => true,
        _ => false,
    }
}

/// Both have the same lights, style and background; materials may differ.
fn same_appearance(a: &Scene, b: &Scene) -> bool {
    let is_same_sky = match (&a.sky, &b.sky) {
        (Some(a), Some(b)) => Arc::ptr_eq(a, b),
        (None, None) => true,
        _ => false,
    };
    let is_same_volume = match (&a.volume, &b.volume) {
        (Some(a), Some(b)) => a.is_same(b),
        (None, None) => true,
        _ => false,
    };
    let appearance = |s: &Scene| (s.style, s.ambient_occlusion, s.background, s.tone);
    let has_same_lights = a.lights == b.lights && a.projector_lights == b.projector_lights;
    is_same_sky && is_same_volume && has_same_lights && appearance(a) == appearance(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_alone_runs_what_follows_the_visibility_buffer() {
        assert_eq!(Changes::default().dirty(), Dirty::Nothing);
        assert_eq!(Changes { appearance: true, ..Changes::default() }.dirty(), Dirty::Appearance);
        let none = Changes::default();
        let whole = [
            Changes { plan: true, ..none },
            Changes { triangles: true, ..none },
            Changes { positions: true, ..none },
            Changes { alpha_masks: true, ..none },
            Changes::ALL,
        ];
        assert!(whole.iter().all(|changes| changes.dirty() == Dirty::All));
    }
}
