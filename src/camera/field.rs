//! Ray fields: a ray for every pixel, read from a file (`raymap`) or given by a formula ([`RayMap`]).

use super::SAFE_RADIUS_PX;
use super::bundle::{Bundle, Ray};
use super::calibration::Calibrated;
use super::lens::{LensRays, Posed};
use super::stack::Stack;
use crate::image::read_vectors;
use crate::input::{Error, Loading, Result};
use crate::parallel;
use glam::{DVec2, DVec3};
use std::fmt::Debug;
use std::path::Path;
use std::sync::Arc;

/// A formula for the ray of every place of the image.
pub trait RayMap: Debug + Send + Sync {
    /// The ray at image coordinates (a, b); `None`: no ray there.
    fn ray(&self, a: f64, b: f64) -> Option<Ray>;

    /// The same at a place in pixels of an image of this size.
    fn ray_at(&self, place_px: DVec2, size_px: DVec2) -> Option<Ray> {
        self.ray(place_px.x / size_px.x, place_px.y / size_px.y)
    }

    /// The part of the image that a place (px) lies in, by its number; `None`: in none. Rays may jump from part to part.
    fn part(&self, _place_px: DVec2, _size_px: DVec2) -> Option<usize> {
        Some(0)
    }

    /// The ray of a part's formula at a place (px), in the part or beside it.
    fn ray_of_part(&self, _part: usize, place_px: DVec2, size_px: DVec2) -> Option<Ray> {
        self.ray_at(place_px, size_px)
    }

    /// All image places (a, b), also outside the image, whose rays pass through `point`, each with its t; `None`: no closed form.
    fn images(&self, _point: DVec3) -> Option<Vec<(DVec2, f64)>> {
        None
    }

    /// The viewer, if this map is a lens at a pose.
    fn viewer(&self) -> Option<Posed> {
        None
    }

    /// The numbers of the calibrated camera, if these are the rays of one.
    fn calibrated(&self) -> Option<&Calibrated> {
        None
    }
}

/// Rays row by row from the top left; `None` where the pixel has no ray.
#[derive(Debug, Clone)]
pub struct Field {
    pub width: u32,
    pub height: u32,
    /// Empty if a formula is evaluated for each ray when needed, or if the field is a lens at a pose.
    rays: Arc<Vec<Option<(DVec3, DVec3)>>>,
    /// The rays of the lens and the viewer, if this field is a lens at a pose.
    turned: Option<(Arc<LensRays>, Posed)>,
    /// The formula of the rays, if any.
    map: Option<Sampled>,
    /// The images that this one is made of, if it is, with all rays.
    stacked: Option<Arc<Stack<Field>>>,
    /// Whether the pixels are sorted by their rays ([`super::ray_order`]).
    pub is_reordered: bool,
}

/// A formula, and the sample position, px from the pixel's top left corner.
#[derive(Debug, Clone)]
struct Sampled {
    map: Arc<dyn RayMap>,
    sample: DVec2,
}

/// Most pixels whose rays are stored, 56 bytes each, if there is a formula.
const STORED_MAX: usize = 1 << 24;

impl Field {
    /// Whether the formula is evaluated for each ray when needed.
    pub fn is_computed(&self) -> bool {
        self.rays.is_empty() && self.turned.is_none() && self.stacked.is_none()
    }

    /// Whether it is made of several images.
    pub fn is_stacked(&self) -> bool {
        self.stacked.is_some()
    }

    /// A row in the middle of an image in the middle, of several.
    pub(super) fn middle_row(&self) -> Option<u32> {
        let stack = self.stacked.as_ref()?;
        let middle = stack.images.len() / 2;
        Some(middle as u32 * stack.step + stack.images[middle].height / 2)
    }

    /// Images of one size, one below another, `step` rows from each to the next, two more at least than they have.
    pub(super) fn stacked(images: Vec<Field>, step: u32) -> Field {
        let (width, height) = (images[0].width, step * images.len() as u32);
        let stacked = Some(Arc::new(Stack { images, step }));
        Field { stacked, ..Field::empty(width, height) }
    }

    /// A field without rays.
    fn empty(width: u32, height: u32) -> Field {
        Field { width, height, rays: Arc::default(), turned: None, map: None, stacked: None, is_reordered: false }
    }

    /// The image of row `j` and the row's number there, where this is a stack of images. Between images rows count on.
    fn image(&self, j: u32) -> Option<(&Field, u32)> {
        let stack = self.stacked.as_ref()?;
        let (k, row) = stack.at(j);
        Some((&stack.images[k], row))
    }

    /// A field from `width * height` origins and directions. A non-finite ray or a zero direction is no ray.
    pub fn new(width: u32, height: u32, origins: &[DVec3], directions: &[DVec3]) -> Result<Field> {
        let ray = |(p, d): (&DVec3, &DVec3)| (p.is_finite() && d.is_finite() && *d != DVec3::ZERO).then_some((*p, *d));
        let rays: Vec<_> = origins.iter().zip(directions).map(ray).collect();
        if rays.len() != width as usize * height as usize || rays.is_empty() {
            return Err(Error::input("camera: the ray map holds no pixel"));
        }
        if rays.iter().all(Option::is_none) {
            return Err(Error::input("camera: no pixel of the ray map holds a finite ray with a direction"));
        }
        Ok(Field { rays: Arc::new(rays), ..Field::empty(width, height) })
    }

    /// The rays of a formula at the centres of `width x height` pixels.
    pub fn of_map(width: u32, height: u32, map: Arc<dyn RayMap>) -> Result<Field> {
        let field = Field::sampled(width, height, Sampled { map, sample: DVec2::splat(0.5) });
        let has_ray = |k: usize| field.ray((k % width as usize) as u32, (k / width as usize) as u32).is_some();
        let has_any = match &field.turned {
            Some((rays, _)) => rays.has_any(),
            None => parallel::any(0..width as usize * height as usize, has_ray),
        };
        if !has_any {
            return Err(Error::input("camera: no pixel has a ray; make the image or its angles larger"));
        }
        Ok(field)
    }

    fn sampled(width: u32, height: u32, map: Sampled) -> Field {
        let size = DVec2::new(width as f64, height as f64);
        let count = width as usize * height as usize;
        if count > STORED_MAX {
            return Field { map: Some(map), ..Field::empty(width, height) };
        }
        if let Some(viewer) = map.map.viewer().filter(|viewer| viewer.eye.is_finite()) {
            let turned = Some((LensRays::of(viewer.lens.clone(), (width, height), map.sample), viewer));
            return Field { turned, map: Some(map), ..Field::empty(width, height) };
        }
        let place = |k: usize| DVec2::new((k % width as usize) as f64, (k / width as usize) as f64);
        let rays = parallel::map(0..count, |k| map.ray(place(k) + map.sample, size));
        Field { rays: Arc::new(rays), map: Some(map), ..Field::empty(width, height) }
    }

    /// A field whose pixel k has the ray of this one's pixel `source[k]`, numbered row by row.
    pub(super) fn reordered(&self, source: &[u32]) -> Field {
        let ray = |k: &u32| self.ray(k % self.width, k / self.width);
        let rays = Arc::new(source.iter().map(ray).collect());
        Field { rays, is_reordered: true, ..Field::empty(self.width, self.height) }
    }

    /// The rays of the lens and the viewer, if this field is a lens at a pose.
    pub fn turned(&self) -> Option<(&Arc<LensRays>, &Posed)> {
        self.turned.as_ref().map(|(rays, viewer)| (rays, viewer))
    }

    /// Returns the field of the same lens in a viewer at the origin, with the world's axes; `None` for other fields.
    pub fn unturned(&self) -> Option<Field> {
        let (rays, viewer) = self.turned.clone()?;
        let turned = Some((rays, viewer.unturned()));
        Some(Field { turned, map: None, ..self.clone() })
    }

    /// Returns the rays of a lens if all rays start in the eye, the eye is the origin, and the axes are the world's: see [`Field::unturned`].
    pub fn unturned_rays(&self) -> Option<&LensRays> {
        let (rays, viewer) = self.turned.as_ref()?;
        (rays.is_central() && viewer.is_unturned()).then_some(&**rays)
    }

    /// The formula of the rays, if any.
    pub fn map(&self) -> Option<&Arc<dyn RayMap>> {
        self.map.as_ref().map(|m| &m.map)
    }

    /// A field of the same pixels and samples by another formula, evaluated for each ray when it is needed.
    pub fn by_map(&self, map: Arc<dyn RayMap>) -> Field {
        let sample = self.map.as_ref().map_or(DVec2::splat(0.5), |m| m.sample);
        Field { map: Some(Sampled { map, sample }), ..Field::empty(self.width, self.height) }
    }

    /// The same, its rays computed now and stored unless there are too many.
    pub fn kept(self) -> Field {
        match self.map {
            Some(map) if self.is_computed() => Field::sampled(self.width, self.height, map),
            _ => self,
        }
    }

    /// Reads origins and directions from .npy or EXR files of one size.
    pub fn load(origins: &Path, directions: &Path, loading: &Loading) -> Result<Field> {
        let (w, h, p) = read_vectors(origins, loading)?;
        let (wd, hd, d) = read_vectors(directions, loading)?;
        if (w, h) != (wd, hd) {
            let files = format!("{} is {w}x{h}, {} is {wd}x{hd}", origins.display(), directions.display());
            return Err(Error::input(format!("camera: {files}; a ray map needs both of one size")));
        }
        Field::new(w, h, &p, &d)
    }

    /// Origin and direction of the pixel's ray.
    #[inline]
    pub fn ray(&self, i: u32, j: u32) -> Option<(DVec3, DVec3)> {
        self.get(i as i64, j as i64)
    }

    /// The ray of a pixel, also of one column right of and one row below the image, extrapolated linearly.
    pub fn ray_or_beyond(&self, i: u32, j: u32) -> Option<(DVec3, DVec3)> {
        if self.stacked.is_some() {
            // the row below an image extends it
            let (image, row) = self.image(j.min(self.height - 1)).filter(|(image, row)| *row <= image.height)?;
            return image.ray_or_beyond(i, row);
        }
        let inside = (i.min(self.width - 1), j.min(self.height - 1));
        let ray = self.ray(inside.0, inside.1)?;
        if inside == (i, j) {
            return Some(ray);
        }
        let (x, y) = ((i - inside.0) as i64, (j - inside.1) as i64);
        let (at_i, at_j) = (inside.0 as i64, inside.1 as i64);
        let right = self.slope(at_i, at_j, (x, 0), ray);
        let below = self.slope(at_i, at_j, (0, y), ray);
        Some((ray.0 + right.0 + below.0, ray.1 + right.1 + below.1))
    }

    /// The ray at `offset` px from the centre of pixel `(i, j)`, within that pixel; see [`Field::with_sample_offset`].
    pub fn ray_at_offset(&self, i: u32, j: u32, offset: DVec2) -> Option<(DVec3, DVec3)> {
        if self.stacked.is_some() {
            let (image, row) = self.image(j).filter(|(image, row)| *row < image.height)?;
            return image.ray_at_offset(i, row, offset);
        }
        let place = DVec2::new(f64::from(i), f64::from(j));
        match &self.map {
            Some(map) => map.ray(place + (map.sample + offset), self.size()),
            None => self.bilinear(place.x + offset.x, place.y + offset.y),
        }
    }

    #[inline]
    fn get(&self, i: i64, j: i64) -> Option<(DVec3, DVec3)> {
        if i < 0 || j < 0 || i >= self.width as i64 || j >= self.height as i64 {
            return None;
        }
        if let Some((rays, viewer)) = &self.turned {
            let Ray { origin, direction } = viewer.turned(rays.get(i as u32, j as u32)?);
            return Some((origin, direction));
        }
        if let Some((image, row)) = self.image(j as u32) {
            return image.get(i, row.into());
        }
        match &self.map {
            Some(map) if self.rays.is_empty() => {
                let place = DVec2::new(i as f64, j as f64);
                map.ray(place + map.sample, self.size())
            }
            _ => self.rays[j as usize * self.width as usize + i as usize],
        }
    }

    /// Change of P and D from pixel to neighbour `(sx, sy)`; zero if that has no ray. Beyond the image the field is extrapolated
    /// linearly.
    fn slope(&self, i: i64, j: i64, (sx, sy): (i64, i64), (p, d): (DVec3, DVec3)) -> (DVec3, DVec3) {
        if let Some((q, e)) = self.get(i + sx, j + sy) {
            return (q - p, e - d);
        }
        let inside = (0..self.width as i64).contains(&(i + sx)) && (0..self.height as i64).contains(&(j + sy));
        let opposite = if inside { None } else { self.get(i - sx, j - sy) };
        opposite.map_or((DVec3::ZERO, DVec3::ZERO), |(q, e)| (p - q, d - e))
    }

    fn bundle_towards(&self, i: u32, j: u32, sx: i64, sy: i64) -> Option<Bundle> {
        let (i, j) = (i as i64, j as i64);
        let (p, d) = self.get(i, j)?;
        let (px, dx) = self.slope(i, j, (sx, 0), (p, d));
        let (py, dy) = self.slope(i, j, (0, sy), (p, d));
        let (fx, fy) = (sx as f64, sy as f64);
        Some(Bundle { p: [p, fx * px, fy * py], d: [d, fx * dx, fy * dy], h: [1.0, 0.0, 0.0] })
    }

    /// The ray of the pixel with its slopes towards the right and lower neighbours.
    pub fn bundle(&self, i: u32, j: u32) -> Option<Bundle> {
        self.bundle_towards(i, j, 1, 1)
    }

    /// The bundles on the four sides of the pixel's centre: bilinear interpolation has a slope for each; a formula the
    /// secants to a place [`SAFE_RADIUS_PX`] away. Those of other parts of the image that are as near follow. Empty if the pixel
    /// has no ray.
    pub fn quadrants(&self, i: u32, j: u32) -> Vec<Bundle> {
        let Some(map) = &self.map else {
            let sides = [(1, 1), (-1, 1), (1, -1), (-1, -1)];
            return sides.iter().filter_map(|&(x, y)| self.bundle_towards(i, j, x, y)).collect();
        };
        let (place, size) = (DVec2::new(f64::from(i), f64::from(j)) + map.sample, self.size());
        let Some(own) = map.map.part(place, size) else { return Vec::new() };
        let mut bundles = map.quadrants(own, place, size);
        if bundles.is_empty() {
            return bundles;
        }
        let mut parts = vec![own];
        for step in AROUND.map(|side| DVec2::from(side) * SAFE_RADIUS_PX) {
            if let Some(part) = map.map.part(place + step, size).filter(|part| !parts.contains(part)) {
                parts.push(part);
                let beside = map.quadrants(part, place + step, size);
                bundles.extend(beside.iter().map(|bundle| bundle.recentred(-step.x, -step.y)));
            }
        }
        bundles
    }

    /// The part of the image that the pixel lies in; see [`RayMap::part`].
    pub(super) fn part(&self, i: u32, j: u32) -> Option<usize> {
        let Some(map) = &self.map else { return Some(0) };
        map.map.part(DVec2::new(f64::from(i), f64::from(j)) + map.sample, self.size())
    }

    /// The ray of a part's formula `by` pixels from a pixel's sample. Of stored rays between two pixels, up to half a pixel away along one axis;
    /// beyond the image they go on as between the last two.
    pub(super) fn ray_of_part(&self, part: usize, (i, j): (u32, u32), by: DVec2) -> Option<Ray> {
        let ray = match &self.map {
            Some(map) => {
                let place = DVec2::new(f64::from(i), f64::from(j)) + map.sample + by;
                usable(map.map.ray_of_part(part, place, self.size())?)
            }
            None => self.towards((i, j), by),
        };
        ray.map(|(origin, direction)| Ray { origin, direction })
    }

    /// `by` is along one axis. No ray towards a pixel of the image that has none.
    fn towards(&self, (i, j): (u32, u32), by: DVec2) -> Option<(DVec3, DVec3)> {
        let (p, d) = self.ray(i, j)?;
        let sign = |x: f64| if x == 0.0 { 0 } else { x.signum() as i64 };
        let (at, step) = ((i64::from(i), i64::from(j)), (sign(by.x), sign(by.y)));
        let is_inside = |x: i64, side: u32| (0..i64::from(side)).contains(&x);
        let next = (at.0 + step.0, at.1 + step.1);
        let beyond = !(is_inside(next.0, self.width) && is_inside(next.1, self.height));
        let other = if beyond { (at.0 - step.0, at.1 - step.1) } else { next };
        self.get(other.0, other.1)?;
        let (dp, dd) = self.slope(at.0, at.1, step, (p, d));
        let share = by.abs().max_element();
        Some((p + share * dp, d + share * dd))
    }

    /// Whether the pixel has a ray, and a place within [`SAFE_RADIUS_PX`] lies in no part of the image.
    pub(super) fn ends_near(&self, i: u32, j: u32) -> bool {
        let Some(map) = &self.map else { return false };
        let (place, size) = (DVec2::new(f64::from(i), f64::from(j)) + map.sample, self.size());
        let is_in_none = |side| map.map.part(place + DVec2::from(side) * SAFE_RADIUS_PX, size).is_none();
        self.ray(i, j).is_some() && AROUND.into_iter().any(is_in_none)
    }

    /// Of the image, px.
    fn size(&self) -> DVec2 {
        DVec2::new(f64::from(self.width), f64::from(self.height))
    }

    /// The ray at an image place (px): by the formula, or bilinearly between pixel centres and clamped beyond them.
    pub fn ray_at(&self, place_px: DVec2) -> Option<Ray> {
        let ray = match &self.map {
            Some(map) => map.ray(place_px, self.size()),
            None => self.bilinear(place_px.x - 0.5, place_px.y - 0.5),
        };
        ray.map(|(origin, direction)| Ray { origin, direction })
    }

    /// Origin and direction between the stored rays; `x` and `y` count pixel centres, clamped at the borders. No ray where any of
    /// those between which it lies is missing.
    fn bilinear(&self, x: f64, y: f64) -> Option<(DVec3, DVec3)> {
        let (x, y) = (x.clamp(0.0, self.width as f64 - 1.0), y.clamp(0.0, self.height as f64 - 1.0));
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let corner = |ox: i64, oy: i64, w: f64| {
            if w == 0.0 {
                return Some((DVec3::ZERO, DVec3::ZERO));
            }
            self.get(x0 as i64 + ox, y0 as i64 + oy).map(|(p, d)| (w * p, w * d))
        };
        let sum = [(0, 0, (1. - fx) * (1. - fy)), (1, 0, fx * (1. - fy)), (0, 1, (1. - fx) * fy), (1, 1, fx * fy)]
            .iter()
            .try_fold((DVec3::ZERO, DVec3::ZERO), |s, &(ox, oy, w)| corner(ox, oy, w).map(|c| (s.0 + c.0, s.1 + c.1)));
        sum.filter(|(_, d)| *d != DVec3::ZERO)
    }

    /// The field sampled `(dx, dy)` pixels from each pixel centre: by its formula, or bilinearly, clamped at the borders; no ray
    /// where any of the rays between which it lies is missing.
    pub(super) fn with_sample_offset(&self, dx: f64, dy: f64) -> Field {
        if let Some(stack) = &self.stacked {
            let images = stack.images.iter().map(|image| image.with_sample_offset(dx, dy)).collect();
            return Field::stacked(images, stack.step);
        }
        if let Some(map) = &self.map {
            let sample = DVec2::new(0.5 + dx, 0.5 + dy);
            return Field::sampled(self.width, self.height, Sampled { sample, ..map.clone() });
        }
        let at = |i: u32, j: u32| self.ray_at_offset(i, j, DVec2::new(dx, dy));
        let rays = (0..self.height).flat_map(|j| (0..self.width).map(move |i| (i, j))).map(|(i, j)| at(i, j)).collect();
        Field { rays: Arc::new(rays), ..Field::empty(self.width, self.height) }
    }
}

/// The corners of a square about a pixel's sample, and the middles of its sides.
const AROUND: [(f64, f64); 8] = [(1., 1.), (-1., 1.), (1., -1.), (-1., -1.), (1., 0.), (-1., 0.), (0., 1.), (0., -1.)];

impl Sampled {
    /// Origin and direction at a place in pixels; `None` as well where the ray is not finite or has no direction.
    fn ray(&self, at_px: DVec2, size: DVec2) -> Option<(DVec3, DVec3)> {
        usable(self.map.ray_at(at_px, size)?)
    }

    /// The bundles of a part's formula on the four sides of a place (px), with its slopes to [`SAFE_RADIUS_PX`] away in x and in y; no
    /// slope to where there is no ray.
    fn quadrants(&self, part: usize, at_px: DVec2, size: DVec2) -> Vec<Bundle> {
        let ray = |by: DVec2| usable(self.map.ray_of_part(part, at_px + by, size)?);
        let Some((p, d)) = ray(DVec2::ZERO) else { return Vec::new() };
        let slope = |by: DVec2, step: f64| match ray(by) {
            Some((q, e)) => ((q - p) / step, (e - d) / step),
            None => (DVec3::ZERO, DVec3::ZERO),
        };
        let secants = |side: &(f64, f64)| {
            let step = DVec2::from(*side) * SAFE_RADIUS_PX;
            let (px, dx) = slope(DVec2::new(step.x, 0.0), step.x);
            let (py, dy) = slope(DVec2::new(0.0, step.y), step.y);
            Bundle { p: [p, px, py], d: [d, dx, dy], h: [1.0, 0.0, 0.0] }
        };
        AROUND[..4].iter().map(secants).collect()
    }
}

/// Origin and direction of a ray that is finite and has a direction.
fn usable(Ray { origin: p, direction: d }: Ray) -> Option<(DVec3, DVec3)> {
    (p.is_finite() && d.is_finite() && d != DVec3::ZERO).then_some((p, d))
}
