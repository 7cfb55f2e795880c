//! The cameras of a composite, compiled, and what each shows.

use crate::camera::region::Region;
use crate::camera::{Camera, Curve, CurveMap, Ray, RayMap, Rays};
use glam::DVec2;

/// One camera and where it shows.
#[derive(Debug, Clone)]
pub struct Part {
    pub region: Region,
    /// The corners of its own image, image coordinates; `None`: the whole image.
    pub frame: Option<[DVec2; 2]>,
    /// It has one layer, and no mirror or lens.
    pub camera: Camera,
    /// The ends of its t, where they become 0 and 1.
    pub span: Option<[f64; 2]>,
}

/// Cameras that share an image. At a place the first one shows whose region holds it.
#[derive(Debug, Clone)]
pub struct Parts {
    /// Of the image, px.
    pub size: DVec2,
    pub parts: Vec<Part>,
    /// Of the curves; 1 where all rays are straight.
    pub degree: usize,
}

impl Part {
    /// An image place, px, in pixels of the camera's own image.
    fn own_place(&self, place_px: DVec2, size: DVec2) -> DVec2 {
        let Some([low, high]) = self.frame else { return place_px };
        let own_size = DVec2::new(self.camera.width.into(), self.camera.height.into());
        (place_px / size - low) / (high - low) * own_size
    }

    /// The straight ray at a place of its own image, px.
    fn ray(&self, place: DVec2) -> Option<Ray> {
        let ray = self.camera.layers.first()?.ray_at(place)?;
        Some(self.span.map_or(ray, |span| spanned(&ray, span)))
    }

    fn curve(&self, place: DVec2) -> Option<Curve> {
        match self.camera.layers.first()? {
            Rays::Curves(curves) => Some(curves.at_place(place)?.1),
            _ => self.ray(place).map(|ray| Curve::of_ray(&ray)),
        }
    }
}

/// The ray whose t from 0 to 1 is that of `ray` from `first` to `last`.
fn spanned(ray: &Ray, [first, last]: [f64; 2]) -> Ray {
    Ray { origin: ray.origin + first * ray.direction, direction: (last - first) * ray.direction }
}

impl Parts {
    /// The number of the part that shows at an image place, px.
    pub fn owner(&self, place_px: DVec2) -> Option<usize> {
        let place = place_px / self.size;
        self.parts.iter().position(|part| part.region.holds(place))
    }
}

impl RayMap for Parts {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        self.ray_at(DVec2::new(a, b) * self.size, self.size)
    }

    fn ray_at(&self, place_px: DVec2, size_px: DVec2) -> Option<Ray> {
        self.ray_of_part(self.owner(place_px)?, place_px, size_px)
    }

    fn part(&self, place_px: DVec2, _size_px: DVec2) -> Option<usize> {
        self.owner(place_px)
    }

    fn ray_of_part(&self, part: usize, place_px: DVec2, size_px: DVec2) -> Option<Ray> {
        let part = &self.parts[part];
        part.ray(part.own_place(place_px, size_px))
    }
}

impl CurveMap for Parts {
    fn degree(&self) -> usize {
        self.degree
    }

    fn curve(&self, a: f64, b: f64) -> Option<(u32, Curve)> {
        self.curve_at(DVec2::new(a, b) * self.size, self.size)
    }

    fn curve_at(&self, place_px: DVec2, size_px: DVec2) -> Option<(u32, Curve)> {
        let part = &self.parts[self.owner(place_px)?];
        Some((0, part.curve(part.own_place(place_px, size_px))?.elevated(self.degree)))
    }
}
