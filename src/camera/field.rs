//! Ray fields: a ray stored for every pixel (`raymap`).

use super::bundle::Bundle;
use crate::error::{Error, Result};
use crate::output::read_vectors;
use glam::DVec3;
use std::path::Path;

/// Rays row by row from the top left; `None` where the pixel has no ray.
#[derive(Debug, Clone)]
pub struct Field {
    pub width: u32,
    pub height: u32,
    rays: Vec<Option<(DVec3, DVec3)>>,
}

impl Field {
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
        Ok(Field { width, height, rays })
    }

    /// Reads origins and directions from .npy or EXR files of one size.
    pub fn load(origins: &Path, directions: &Path) -> Result<Field> {
        let (w, h, p) = read_vectors(origins)?;
        let (wd, hd, d) = read_vectors(directions)?;
        if (w, h) != (wd, hd) {
            let files = format!("{} is {w}x{h}, {} is {wd}x{hd}", origins.display(), directions.display());
            return Err(Error::input(format!("camera: {files}; a ray map needs both of one size")));
        }
        Field::new(w, h, &p, &d)
    }

    /// Origin and direction of the pixel's ray.
    pub fn ray(&self, i: u32, j: u32) -> Option<(DVec3, DVec3)> {
        self.get(i as i64, j as i64)
    }

    /// The ray of a place up to one pixel right of or below the image too, where it goes on linearly.
    pub fn ray_or_beyond(&self, i: u32, j: u32) -> Option<(DVec3, DVec3)> {
        let inside = (i.min(self.width - 1), j.min(self.height - 1));
        let ray = self.ray(inside.0, inside.1)?;
        let (x, y) = ((i - inside.0) as i64, (j - inside.1) as i64);
        let (at_i, at_j) = (inside.0 as i64, inside.1 as i64);
        let right = self.slope(at_i, at_j, (x, 0), ray);
        let below = self.slope(at_i, at_j, (0, y), ray);
        Some((ray.0 + right.0 + below.0, ray.1 + right.1 + below.1))
    }

    fn get(&self, i: i64, j: i64) -> Option<(DVec3, DVec3)> {
        if i < 0 || j < 0 || i >= self.width as i64 || j >= self.height as i64 {
            return None;
        }
        self.rays[j as usize * self.width as usize + i as usize]
    }

    /// How P and D change one pixel along `(sx, sy)`: the difference to that neighbour, zero where it has no ray;
    /// beyond the image the field goes on linearly.
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

    /// The bundles on the four sides of the pixel's centre: bilinear interpolation has a slope for each.
    pub fn quadrants(&self, i: u32, j: u32) -> Vec<Bundle> {
        [(1, 1), (-1, 1), (1, -1), (-1, -1)].iter().filter_map(|&(x, y)| self.bundle_towards(i, j, x, y)).collect()
    }

    /// The field sampled `(dx, dy)` pixels from each pixel centre, bilinearly, clamped at the borders; no ray
    /// where any of the rays between which it lies is missing.
    pub(super) fn with_sample_offset(&self, dx: f64, dy: f64) -> Field {
        let at = |i: u32, j: u32| {
            let x = (i as f64 + dx).clamp(0.0, self.width as f64 - 1.0);
            let y = (j as f64 + dy).clamp(0.0, self.height as f64 - 1.0);
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
                .try_fold((DVec3::ZERO, DVec3::ZERO), |s, &(ox, oy, w)| {
                    corner(ox, oy, w).map(|c| (s.0 + c.0, s.1 + c.1))
                });
            sum.filter(|(_, d)| *d != DVec3::ZERO)
        };
        let rays = (0..self.height).flat_map(|j| (0..self.width).map(move |i| (i, j))).map(|(i, j)| at(i, j)).collect();
        Field { width: self.width, height: self.height, rays }
    }
}
