//! How the flux of a light is shared out among its beams, and Hou's measure of what arrives.

use super::Caustics;
use super::beams::CausticTriangle;
use crate::arrays::MapEach;
use crate::camera::Ray;
use crate::parallel;
use glam::DVec3;

impl Caustics {
    /// Photons of each beam: two a cell of the grid, cell by cell.
    pub fn beams(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [columns, rows] = self.cells.map_each(|n| n as usize);
        (0..rows).flat_map(move |j| (0..columns).map(move |i| j * (columns + 1) + i)).flat_map(move |k| {
            let below = k + columns + 1;
            [[k, k + 1, below], [below + 1, below, k + 1]]
        })
    }

    /// Flux of each beam: its share of the light's image, by solid angle from a point, by area across a sun's rays.
    pub fn beam_flux(&self) -> Vec<f64> {
        let (beams, is_sun): (Vec<[usize; 3]>, bool) = (self.beams().collect(), self.is_sun());
        let sizes: Vec<f64> = parallel::map(&beams, |corners| self.size(*corners, is_sun));
        let all: f64 = sizes.iter().sum();
        sizes.into_iter().map(|size| size / all * self.flux).collect()
    }

    /// Solid angle, or area across the rays, of a beam.
    fn size(&self, corners: [usize; 3], is_sun: bool) -> f64 {
        let rays = corners.map_each(|k| self.ray(k));
        let [a, b, c] = rays;
        if is_sun {
            return (b.origin - a.origin).cross(c.origin - a.origin).dot(a.direction.normalize()).abs() / 2.0;
        }
        solid_angle(rays.map_each(|r| r.direction))
    }

    fn ray(&self, photon: usize) -> Ray {
        let (k, columns) = (photon as u32, self.light.width);
        let none = Ray { origin: DVec3::ZERO, direction: DVec3::ZERO };
        self.light.ray(k % columns, k / columns).unwrap_or(none)
    }

    /// All rays of the light are parallel.
    pub fn is_sun(&self) -> bool {
        self.ray(0).direction == self.ray(self.light.width as usize * self.light.height as usize - 1).direction
    }

    /// The light that Hou's ratio brings to a triangle, over the flux of its beam: what the light would send to its middle
    /// without the optics, times beam over triangle as seen from the light, times its area. The beam's own size cancels out.
    /// `None` where the triangle is not seen from the light.
    pub(super) fn solid_angle_ratio(&self, triangle: &CausticTriangle) -> Option<f64> {
        let receiver = &self.receivers[triangle.receiver as usize];
        let points = triangle.corners.map_each(|p| receiver.point(p));
        let cross = (points[1] - points[0]).cross(points[2] - points[0]);
        let ray = self.ray(0);
        // flux an area there, of one an angle (or an area) of the light's image; and how large the triangle is seen
        let (sent, seen) = if self.is_sun() {
            let cosine = cross.normalize_or_zero().dot(ray.direction.normalize()).abs();
            (cosine, cosine * cross.length() / 2.0)
        } else {
            let out = (points[0] + points[1] + points[2]) / 3.0 - ray.origin;
            let cosine = cross.normalize_or_zero().dot(out.normalize_or_zero()).abs();
            (cosine / out.length_squared(), solid_angle(points.map_each(|p| p - ray.origin)))
        };
        let ratio = sent / seen * cross.length() / 2.0;
        (seen > 0.0 && ratio.is_finite()).then_some(ratio)
    }
}

/// Solid angle of the triangle that three directions of any length span, sr (Van Oosterom and Strackee 1983).
pub fn solid_angle(directions: [DVec3; 3]) -> f64 {
    let [a, b, c] = directions.map_each(|d| d.normalize_or_zero());
    let volume = a.dot(b.cross(c)).abs();
    2.0 * volume.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a)).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn solid_angles_of_the_octant_and_of_a_rectangle() {
        assert!((solid_angle([DVec3::X, 2.0 * DVec3::Y, 0.1 * DVec3::Z]) - PI / 2.0).abs() < 1e-15);
        // a rectangle 2 a by 2 b at distance 1: 4 asin(a b / sqrt((1 + a a)(1 + b b)))
        let (a, b) = (0.7, 0.2);
        let at = |x: f64, y: f64| DVec3::new(x * a, y * b, 1.0);
        let half = |s: f64| solid_angle([at(s, s), at(-s, s), at(s, -s)]);
        let exact = 4.0 * (a * b / ((1.0 + a * a) * (1.0 + b * b)).sqrt()).asin();
        assert!((half(1.0) + half(-1.0) - exact).abs() < 1e-15);
    }
}
