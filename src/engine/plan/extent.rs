//! Where a scene lies, and the places that its positions are relative to.

use crate::camera::Camera;
use crate::camera::perturb::scene_size;
use crate::scene::Scene;
use glam::DVec3;

/// The place and the grain of a scene, world units.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SceneShape {
    /// The corners of the box around all vertices and round primitives; `None` without any.
    pub bounds: Option<(DVec3, DVec3)>,
    /// The median of the longest edges of some triangles, or of the radii of round primitives; 0: unknown.
    pub grain: f64,
}

/// Triangles that the grain is measured at.
const GRAIN_SAMPLES: usize = 255;

impl SceneShape {
    pub fn of(scene: &Scene) -> SceneShape {
        let mesh = &scene.mesh;
        let count = mesh.triangle_count();
        let step = count.div_ceil(GRAIN_SAMPLES).max(1);
        let size = |id: usize| mesh.primitive(id as u32).size();
        let mut sizes: Vec<f64> = (0..count).step_by(step).map(size).filter(|s| *s > 0.0).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        SceneShape { bounds: scene.bounds(), grain: sizes.get(sizes.len() / 2).copied().unwrap_or(0.0) }
    }

    /// The distance between places that positions may be relative to: a power of two. Cameras within one such distance share an anchor, so
    /// that a scene stays as it lies on the device while a camera moves there; 0: any place.
    fn spacing(&self) -> f64 {
        let Some((lo, hi)) = self.bounds else { return 0.0 };
        let extent = (hi - lo).max_element();
        // an eye is at most 887 grains from its anchor: one grain away, a unit of f32 there is 1/19 of a pixel of 1/1000
        let most = if self.grain > 0.0 { extent.min(GRAINS * self.grain) } else { extent };
        if most > 0.0 { (most / CELLS).log2().floor().exp2() } else { 0.0 }
    }
}

/// Distances between anchors along a scene.
const CELLS: f64 = 2.0;

/// Largest extent of a scene, in such distances, that has one origin for all cameras.
const SPACINGS: f64 = 16.0;

/// Upper limit, in grains, of the extent that the anchor spacing is computed from.
const GRAINS: f64 = 2048.0;

/// Where a camera meets a scene, world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneExtent {
    /// What all positions are relative to: near the camera's rays' start and the scene.
    pub anchor: DVec3,
    /// What hierarchies of the scene are relative to: a place near its center, whatever the camera; or the anchor where f32 numbers about that
    /// place do not tell triangles apart, since a few are far away from the others.
    pub origin: DVec3,
    /// Centre of the scene, by which incoherent rays are sorted.
    pub centre: DVec3,
    /// Size of the scene, which scales the perturbation of rays: [`crate::camera::perturb`].
    pub scene_size: f64,
}

impl SceneExtent {
    /// The anchor is the central ray's origin, clamped into the scene's box, at the nearest of the places that an anchor may have.
    pub fn of(camera: &Camera, shape: SceneShape) -> SceneExtent {
        let (i, j) = camera.middle();
        let start = camera.ray(i, j).map_or(DVec3::ZERO, |r| r.origin);
        let Some((lo, hi)) = shape.bounds else { return SceneExtent::point(start) };
        let spacing = shape.spacing();
        let nearest = |p: DVec3| if spacing > 0.0 { (p / spacing).round() * spacing } else { p };
        let centre = (lo + hi) / 2.0;
        let anchor = nearest(start.clamp(lo, hi));
        let is_even = (hi - lo).max_element() <= SPACINGS * spacing;
        let origin = if is_even { nearest(centre) } else { anchor };
        SceneExtent { anchor, origin, centre, scene_size: scene_size(shape.bounds) }
    }

    /// Returns the extent of a scene that is a single point.
    pub fn point(at: DVec3) -> SceneExtent {
        SceneExtent { anchor: at, origin: at, centre: at, scene_size: 0.0 }
    }
}
