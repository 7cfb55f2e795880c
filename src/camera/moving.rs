//! Cameras that move while an image is taken: each pixel has the ray, or the curve, of its own time.

use super::bundle::Ray;
use super::composition::Shown;
use super::curve::{Curve, CurveMap, Curves};
use super::exposure::{Exposure, Sample};
use super::field::{Field, RayMap};
use super::{Camera, Rays};
use crate::arrays::MapEach;
use crate::input::{Error, Result};
use glam::DVec2;
use std::sync::Arc;

/// A camera at several times. Between two of them origins, directions and control points are linear in time.
#[derive(Debug)]
pub struct Moving {
    exposure: Exposure,
    /// Ascending, frames.
    times: Vec<f64>,
    /// One for each time.
    cameras: Vec<Camera>,
    /// The members of a composite whose cameras have frames of their own.
    members: Vec<Arc<Moving>>,
}

impl Moving {
    /// From times, two at least, and the camera at each.
    ///
    /// # Errors
    /// [`Error::Input`] if it has a mirror or lens, or if anything but its rays changes: its layers, its range of t, regions, feathers, priorities
    /// or objects of a composite.
    pub fn new(exposure: Exposure, times: Vec<f64>, cameras: Vec<Camera>) -> Result<Arc<Moving>> {
        let regions = |c: &Camera| {
            let composition = c.composition.as_ref()?;
            let member = |m: &Shown| (m.region.clone(), m.feather, m.priority, m.objects.clone());
            Some((composition.master, composition.members.iter().map(member).collect::<Vec<_>>()))
        };
        let fixed = |c: &Camera| (c.t_range, regions(c));
        let shape = |c: &Camera| (c.kind, c.width, c.height, c.layers.len(), c.layers.first().map(Rays::degree));
        if cameras.iter().any(|c| c.optics.is_some()) {
            return Err(Error::input(format!(
                "camera: a {} cannot move while a frame is taken; make shutter and line_time 0",
                cameras[0].kind
            )));
        }
        if cameras.iter().any(|c| shape(c) != shape(&cameras[0])) {
            return Err(Error::input(
                "camera: its size or its layers change while a frame is taken; make shutter and line_time 0",
            ));
        }
        if cameras.iter().any(|c| fixed(c) != fixed(&cameras[0])) {
            return Err(Error::input(
                "camera: t_range and all keys of a composite but its cameras' own cannot change while a frame is taken; \
                 make shutter and line_time 0",
            ));
        }
        let member = |k: usize| {
            // all of them have as many members
            let at_times =
                cameras.iter().filter_map(|c| Some(Camera::clone(&c.composition.as_ref()?.members[k].camera)));
            Moving::new(exposure.clone(), times.clone(), at_times.collect())
        };
        let count = cameras[0].layered().map_or(0, |composition| composition.members.len());
        let members = (0..count).map(member).collect::<Result<_>>()?;
        Ok(Arc::new(Moving { exposure, times, cameras, members }))
    }

    /// The camera of an image, or of one of the samples of each pixel.
    pub fn camera(self: &Arc<Self>, sample: Option<Sample>) -> Result<Camera> {
        let first = &self.cameras[0];
        let (width, height) = (first.width, first.height);
        let rays = |layer: usize| -> Result<Rays> {
            let map = Arc::new(InTime { moving: self.clone(), layer, sample });
            let is_straight = first.layers.len() == 1 && !first.is_curved();
            Ok(match is_straight {
                true => Rays::Field(Field::of_map(width, height, map)?),
                false => Rays::Curves(Curves::new(width, height, map)),
            })
        };
        let layers = (0..first.layers.len()).map(rays).collect::<Result<_>>()?;
        let mut composition = first.composition.clone();
        if let Some(composition) = composition.as_mut().filter(|_| !self.members.is_empty()) {
            for (shown, moving) in Arc::make_mut(composition).members.iter_mut().zip(&self.members) {
                shown.camera = Arc::new(moving.camera(sample)?);
            }
        }
        Ok(Camera { layers, sample, composition, moving: Some(self.clone()), ..first.clone() })
    }
}

/// A layer of a moving camera.
#[derive(Debug)]
struct InTime {
    moving: Arc<Moving>,
    layer: usize,
    sample: Option<Sample>,
}

impl InTime {
    /// The layer before and after the time of the pixel that a place lies in, the share of the way from the one to the other, and the place
    /// in pixels.
    fn at(&self, a: f64, b: f64) -> ([&Rays; 2], f64, DVec2) {
        let Moving { exposure, times, cameras, .. } = &*self.moving;
        let (width, height) = (cameras[0].width, cameras[0].height);
        let place = DVec2::new(a * f64::from(width), b * f64::from(height));
        // a cast saturates at 0
        let pixel = ((place.x as u32).min(width - 1), (place.y as u32).min(height - 1));
        let time = exposure.time(pixel, (width, height), self.sample);
        let next = times.partition_point(|t| *t <= time).clamp(1, times.len() - 1);
        let share = ((time - times[next - 1]) / (times[next] - times[next - 1])).clamp(0.0, 1.0);
        ([next - 1, next].map_each(|k| &cameras[k].layers[self.layer]), share, place)
    }
}

impl RayMap for InTime {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        let ([from, to], share, place) = self.at(a, b);
        let (from, to) = (from.ray_at(place)?, to.ray_at(place)?);
        Some(Ray {
            origin: from.origin + share * (to.origin - from.origin),
            direction: from.direction + share * (to.direction - from.direction),
        })
    }
}

impl CurveMap for InTime {
    fn degree(&self) -> usize {
        self.moving.cameras[0].layers[self.layer].degree()
    }

    fn curve(&self, a: f64, b: f64) -> Option<(u32, Curve)> {
        let (ends, share, place) = self.at(a, b);
        let curve = |rays: &Rays| match rays {
            Rays::Curves(curves) => curves.at_place(place),
            _ => rays.ray_at(place).map(|ray| (0, Curve::of_ray(&ray))),
        };
        let [Some((piece, from)), Some((_, to))] = ends.map_each(curve) else { return None };
        let points: Vec<_> = from.points().iter().zip(to.points()).map(|(p, q)| *p + share * (*q - *p)).collect();
        Some((piece, Curve::new(&points)))
    }

    fn piece_count(&self) -> usize {
        match &self.moving.cameras[0].layers[self.layer] {
            Rays::Curves(curves) => curves.map.piece_count(),
            _ => 0,
        }
    }
}
