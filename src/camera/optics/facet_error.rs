//! The image error of facets against the smooth surface, in pixels.

use super::bounce::{Split, after, at_facet};
use super::meeting::first_meeting;
use super::{Branch, Optics, Surface};
use crate::arrays::MapEach;
use crate::camera::perturb::scene_size;
use crate::camera::{Camera, Ray};
use crate::geometry::cast::Caster;
use crate::parallel;
use glam::DVec3;

/// Approximate number of pixels sampled per row; more where none of these sees the surfaces.
const SAMPLES_PER_SIDE: u32 = 64;

/// Percentile of the error over the pixels that see both surfaces: at a silhouette no number of facets
/// is enough.
pub const SHARE: f64 = 0.95;

/// Image error, px, of points seen after one bounce, at the distance of `centre` from the surface: the 95th percentile over a grid of
/// pixels that see both surfaces. The unit is the true change from a pixel to its neighbours. `None` if no pixel and its neighbours see
/// both.
pub fn error_px(eye: &Camera, truth: &Optics, facets: &Optics, centre: DVec3) -> Option<f64> {
    let meshes = [truth, facets].map_each(|o| o.facets().map(|f| f.mesh(o.base)).unwrap_or_default());
    let [truth, facets] = [(truth, &meshes[0]), (facets, &meshes[1])].map_each(|(optics, mesh)| Alone {
        optics,
        caster: Caster::new(mesh),
        scene_size: scene_size(mesh.bounds()),
    });
    let (width, height) = (eye.width, eye.height);
    // the next column or row, or at the end the one before; none of an image of one
    let next = |k: u32, count: u32| if k + 1 < count { Some(k + 1) } else { k.checked_sub(1) };
    let off = |&(i, j): &(u32, u32)| {
        let known = truth.bounced(eye, i, j)?;
        let far = (centre - known.origin).length();
        let at = |ray: Ray| ray.origin + far * ray.direction.normalize();
        let here = at(known);
        let away = |(i, j): (u32, u32)| Some((at(truth.bounced(eye, i, j)?) - here).length());
        let beside = next(i, width).map(|i| away((i, j)));
        let below = next(j, height).map(|j| away((i, j)));
        let pixel = match (beside, below) {
            (Some(a), Some(b)) => (a? * b?).sqrt(),
            (Some(one), None) | (None, Some(one)) => one?,
            (None, None) => return None,
        };
        Some((at(facets.bounced(eye, i, j)?) - here).length() / pixel)
    };
    let every = |step: u32| -> Vec<f64> {
        let rows = (0..height).step_by(step as usize);
        let places: Vec<_> = rows.flat_map(|j| (0..width).step_by(step as usize).map(move |i| (i, j))).collect();
        parallel::flat_map(&places, |place| off(place).filter(|e| e.is_finite()))
    };
    let mut step = width.div_ceil(SAMPLES_PER_SIDE).max(1);
    let mut list = every(step);
    while list.is_empty() && step > 1 {
        step /= 2;
        list = every(step);
    }
    list.sort_unstable_by(f64::total_cmp);
    list.get((SHARE * list.len() as f64) as usize).copied()
}

/// Optics in an empty scene.
struct Alone<'a> {
    optics: &'a Optics,
    caster: Caster<'a>,
    scene_size: f64,
}

impl Alone<'_> {
    /// The ray of a pixel after its first bounce.
    fn bounced(&self, eye: &Camera, i: u32, j: u32) -> Option<Ray> {
        let (_, bundle) = eye.pixel(0, i, j)?;
        let ray = bundle.ray(0.0, 0.0);
        let split = Split { branch: Branch::Main, tilt: self.optics.tilts()[0] };
        let (place, (direction, _)) = match &self.optics.surface {
            Surface::Facets { facets, law } => {
                let hit = self.caster.first(&bundle.aim(self.scene_size)?, eye.t_range)?;
                at_facet((self.optics, split), *law, &facets.facet(hit.triangle as usize), ray.direction, hit.bary)
            }
            Surface::Smooth(smooth) => {
                let meeting = |part| Some((first_meeting((smooth, part), &ray, false, eye.t_range)?, part));
                let (t, part) = (0..smooth.count()).filter_map(meeting).min_by(|a, b| a.0.total_cmp(&b.0))?;
                let place = ray.origin + t * ray.direction;
                let normal = smooth.normal(part, place);
                (place, after((self.optics, split), ray.direction, normal, normal))
            }
        };
        let goes_on = direction.is_finite() && direction != DVec3::ZERO;
        goes_on.then(|| Ray { origin: self.optics.environment.unwrap_or(place), direction })
    }
}
