//! Frames of a scene that are aimed by another camera, or lit in another way. Only the laboratory and tests use them so far.

use super::super::changes::Changes;
use super::super::combinations::Asked;
use super::super::in_view::{InView, SceneFacts};
use super::super::planned::{Whole, in_order, outlined_by};
use super::super::resident::BvhState;
use super::super::setup;
use super::{Frames, moved};
use crate::camera::Camera;
use crate::engine::plan::{Plan, SceneContents, SceneExtent};
use crate::gpu::kernels::SurfaceKind;
use crate::input::{Error, Result};
use crate::scene::Scene;
use std::sync::Arc;

impl Frames {
    /// Shows the scene through `camera` from the next frame on, and in the end: plans anew and uploads what depends on the camera
    /// alone. Positions stay relative to where the first camera had them.
    ///
    /// # Errors
    /// [`Error::Input`] where the camera is not of the same kind and size as the one before, or reflects or refracts rays.
    pub fn aim(&mut self, camera: &Camera) -> Result<()> {
        let (old, new) = (self.camera.kind, camera.kind);
        let other =
            || Error::input(format!("frames of {old} cannot be taken by this {new}; call Engine::prepare again"));
        let asked = Asked::of(&self.whole.scene, camera, &self.wanted, &self.run);
        asked.check()?;
        if camera.optics.is_some() || camera.layered().is_some() || asked.is_separate() {
            return Err(other());
        }
        let Plan { anchor, origin, centre, scene_size, .. } = *self.plan;
        let extent = SceneExtent { anchor, origin, centre, scene_size };
        let shown = Arc::new(in_order(&self.whole.scene, camera, extent.centre).unwrap_or_else(|| camera.clone()));
        let whole = Whole { camera: shown.clone(), ..self.whole.clone() };
        let contents = self.planner.contents(&whole.scene);
        let last = (Some(self.plan.in_view), Some((&*self.plan, &*self.whole.camera)));
        let plan = self.planner.plan_by(&self.run, &whole, (contents, extent), &self.wanted, last);
        let plan = plan.at_its_moments(&whole.scene, &shown);
        Asked { planned: Some((&plan, self.resident.chunks.len())), ..asked }.check()?;
        let camera = shown;
        let is_as_large = (camera.width, plan.rows_max()) == (self.camera.width, self.plan.rows_max());
        let is_alike = (plan.variant, plan.in_view) == (self.plan.variant, self.plan.in_view);
        if !is_alike || !is_as_large {
            return Err(other());
        }
        // until all is there nothing is drawn
        let was_partly_uploaded = std::mem::replace(&mut self.is_partly_uploaded, true);
        // tracing may have been cheaper only for the earlier camera
        if self.resident.bvh == BvhState::Preferred {
            self.resident.bvh = BvhState::Built;
        }
        self.resident.aim(&self.gpu, &self.scene, &camera, &plan)?;
        if let Some(volume) = self.scene.volume.as_ref().filter(|_| plan.variant.extras.volume.is_some()) {
            self.resident.upload_medium(&self.gpu, volume, &self.scene, &plan)?;
        }
        self.timed.raster_cost = 0;
        if let Some(rival) = &mut self.rival {
            rival.aim(&self.gpu, &setup(&camera, &plan))?;
        }
        (self.whole, self.camera, self.plan, self.is_aimed) = (whole, camera, Arc::new(plan), true);
        self.is_partly_uploaded = was_partly_uploaded;
        self.mark_dirty(Changes { plan: true, ..Changes::default() });
        Ok(())
    }

    /// From the next frame on, renders the current triangles with the lights, materials, normals and background of `scene`.
    ///
    /// # Errors
    /// [`Error::Input`] where `scene` has other numbers of triangles, vertices, normals or materials, other kinds of these (images, gloss,
    /// a sky), or caustics are shown.
    pub fn light(&mut self, scene: &Scene) -> Result<()> {
        if self.caustics.is_some() {
            return Err(Error::input("the light cannot change with caustics; call Engine::prepare again"));
        }
        if let Some(atlas) = &mut self.atlas {
            atlas.frames.light(scene)?;
        }
        let scene = scene.with_optics(&self.camera);
        let sizes =
            |s: &Scene| [s.mesh.triangles.len(), s.mesh.positions.len(), s.mesh.normals.len(), s.mesh.materials.len()];
        if sizes(&scene) != sizes(&self.scene) || scene.mesh.radii != self.scene.mesh.radii {
            return Err(Error::input(
                "other triangles or materials than those that are lit; call Engine::prepare again",
            ));
        }
        let in_view = self.plan.in_view;
        let contents = |shown: &Scene, whole: &Scene| in_view.contents(shown, SceneContents::of(whole));
        let lit = contents(&self.scene, &self.whole.scene.with_optics(&self.camera));
        let contents = contents(&in_view.scene(&scene), &scene);
        let needed = InView::of(
            (&scene, &SceneFacts::default()),
            &self.whole.camera,
            &self.plan,
            (&self.wanted, &self.run),
            Some(in_view),
        );
        let outlined = |s: &Scene| outlined_by(&s.style, &self.camera);
        if lit != contents || needed != in_view || outlined(&self.scene) != outlined(&scene) {
            return Err(Error::input(
                "other kinds of materials or light than those that are lit; call Engine::prepare again",
            ));
        }
        let (lit, own) = (&self.scene.mesh, &scene.mesh);
        if self.plan.variant.appearance.textures.is_some() && (&lit.uvs, &lit.corner_uvs) != (&own.uvs, &own.corner_uvs)
        {
            return Err(Error::input("other texture coordinates than those that are lit; call Engine::prepare again"));
        }
        if self.plan.variant.surfaces() == SurfaceKind::Colored
            && (&lit.colors, &lit.corner_colors) != (&own.colors, &own.corner_colors)
        {
            return Err(Error::input("other vertex colours than those that are lit; call Engine::prepare again"));
        }
        // the triangles stay where they are
        let mut lit = scene.into_owned();
        let (own, shown) = (&lit.mesh, &self.scene.mesh);
        if !Arc::ptr_eq(own, shown) && (&own.positions, &own.triangles) != (&shown.positions, &shown.triangles) {
            let mesh = Arc::make_mut(&mut lit.mesh);
            mesh.positions.clone_from(&self.scene.mesh.positions);
            mesh.triangles.clone_from(&self.scene.mesh.triangles);
        }
        lit.steps.clone_from(&self.whole.scene.steps);
        self.scene = Arc::new(in_view.scene(&lit).into_owned());
        if self.whole.camera.optics.is_none() {
            (self.whole.scene, self.whole.facts) = (Arc::new(lit), Arc::default());
        }
        let was_partly_uploaded = std::mem::replace(&mut self.is_partly_uploaded, true);
        let keeps_masks = if self.moving.is_some() {
            let now = moved(&self.scene, self.fixed_vertices(), self.timed.moved);
            self.resident.upload_appearance(&self.gpu, &self.pages, &now, &self.plan)?
        } else {
            self.resident.upload_appearance(&self.gpu, &self.pages, &self.scene, &self.plan)?
        };
        self.is_partly_uploaded = was_partly_uploaded;
        self.mark_dirty(Changes { appearance: true, alpha_masks: !keeps_masks, ..Changes::default() });
        Ok(())
    }

    /// The wall time of the first frame, ms.
    pub fn first_ms(&self) -> f64 {
        self.timed.first_ms
    }

    /// The time on the device of each stage of the last frame that [`Frames::frame`] took, ms; empty without timestamps.
    pub fn stages(&self) -> &[(&'static str, f64)] {
        self.timed.stages.last().map_or(&[], Vec::as_slice)
    }
}
