//! From photons to caustic triangles: the flux of the beams between them, and what of it lands where.

use super::landing::Landings;
use super::{Budget, Caustics, Method, mean};
use crate::error::{Error, Result};
use crate::frame::{Channel, Frame, NO_ID};
use crate::scene::mesh::Mesh;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// What the photon-location map is made of.
pub const CHANNELS: [Channel; 6] =
    [Channel::R, Channel::G, Channel::TriangleId, Channel::BaryU, Channel::BaryV, Channel::MirrorId];

/// What became of a ray of the light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Photon {
    pub fate: Fate,
    /// What the turns left of its light, linear RGB.
    pub left: [f64; 3],
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fate {
    /// Never turned.
    Direct,
    /// Ended on the optics.
    Absorbed,
    /// Turned, and then on no receiver's plane.
    Missed,
    /// Turned so often, and then on this receiver's plane, there at a place in texels.
    Landed { receiver: u32, turns: u32, place: DVec2 },
}

/// Light on a receiver, spread evenly over a triangle; a line or a point where corners coincide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cast {
    pub receiver: u32,
    /// Texels.
    pub corners: [DVec2; 3],
    /// Linear RGB.
    pub flux: [f64; 3],
}

impl Caustics {
    /// The photons of an image of [`Caustics::counting`] with the channels [`CHANNELS`], row by row.
    pub fn photons(&self, mesh: &Mesh, landings: &Landings, frame: &Frame) -> Result<Vec<Photon>> {
        let absent = || Error::work("the photon-location map lacks a channel");
        let f32s = |channel| frame.f32(channel).ok_or_else(absent);
        let u32s = |channel| frame.u32(channel).ok_or_else(absent);
        let (ids, mirrors) = (u32s(Channel::TriangleId)?, u32s(Channel::MirrorId)?);
        let (u, v) = (f32s(Channel::BaryU)?, f32s(Channel::BaryV)?);
        let (r, g) = (f32s(Channel::R)?, f32s(Channel::G)?);
        let triangles = mesh.triangles.len() as u32;
        let photon = |k: usize| {
            // halving is exact
            let turns = (g[k] / r[k]).log2().round();
            let left = self.optics.tint.map(|tint| f64::from(tint).powi(turns as i32) * f64::from(g[k]));
            let fate = match (mirrors[k], ids[k], landings.of(ids[k])) {
                (NO_ID, ..) => return Photon { fate: Fate::Direct, left: [1.0; 3] },
                (_, NO_ID, _) => Fate::Missed,
                (_, id, _) if id >= triangles => Fate::Absorbed,
                (_, _, None) => Fate::Missed,
                (_, _, Some(landing)) => {
                    let place = landing.place([u[k], v[k]].map(f64::from));
                    Fate::Landed { receiver: landing.receiver, turns: turns as u32, place }
                }
            };
            // nothing is left of a light that was turned to nothing
            let left = if left.iter().all(|l| l.is_finite()) { left } else { [0.0; 3] };
            Photon { fate, left }
        };
        Ok((0..ids.len()).into_par_iter().map(photon).collect())
    }

    /// The caustic triangles of all beams, and a budget without what the receivers' maps alone know: `deposited`, and the
    /// part of `missed` that lies beyond their borders.
    ///
    /// Photons of a beam that fare alike, equally often turned and on one receiver, stay together: three are a triangle, two
    /// have two thirds of the flux, one a third, on triangles guessed from their neighbours.
    pub fn casts(&self, photons: &[Photon]) -> (Vec<Cast>, Budget) {
        let flux = self.beam_flux();
        let mut budget = Budget { flux: self.flux, ..Budget::default() };
        let mut casts = Vec::new();
        let grid = Grid { photons, columns: self.light.width as usize };
        for (corners, flux) in self.beams().zip(flux) {
            let three = corners.map(|k| photons[k]);
            for photon in three {
                let third = flux / 3.0;
                let left = third * mean(photon.left);
                budget.absorbed += third - left;
                match photon.fate {
                    Fate::Direct => budget.direct += left,
                    Fate::Absorbed => budget.absorbed += left,
                    Fate::Missed => budget.missed += left,
                    Fate::Landed { .. } => {}
                }
            }
            for cast in grid.casts(corners, flux) {
                match self.method {
                    Method::Flux => casts.push(cast),
                    Method::SolidAngle => {
                        let ratio = self.solid_angle_ratio(&cast);
                        match ratio {
                            Some(ratio) => casts.push(Cast { flux: cast.flux.map(|f| f * ratio), ..cast }),
                            None => budget.missed += mean(cast.flux),
                        }
                    }
                }
            }
        }
        budget.triangles = casts.len() as u64;
        (casts, budget)
    }

    /// Photons of each beam: two a cell of the grid, cell by cell.
    pub fn beams(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [columns, rows] = self.cells.map(|n| n as usize);
        (0..rows).flat_map(move |j| (0..columns).map(move |i| j * (columns + 1) + i)).flat_map(move |k| {
            let below = k + columns + 1;
            [[k, k + 1, below], [below + 1, below, k + 1]]
        })
    }

    /// Flux of each beam: its share of the light's image, by solid angle from a point, by area across a sun's rays.
    pub fn beam_flux(&self) -> Vec<f64> {
        let sizes: Vec<f64> = self.beams().map(|corners| self.size(corners)).collect();
        let all: f64 = sizes.iter().sum();
        sizes.into_iter().map(|size| size / all * self.flux).collect()
    }

    /// Solid angle, or area across the rays, of a beam.
    fn size(&self, corners: [usize; 3]) -> f64 {
        let rays = corners.map(|k| self.ray(k));
        let [a, b, c] = rays;
        if self.is_sun() {
            return (b.origin - a.origin).cross(c.origin - a.origin).dot(a.direction.normalize()).abs() / 2.0;
        }
        solid_angle(rays.map(|r| r.direction))
    }

    fn ray(&self, photon: usize) -> crate::camera::Ray {
        let (k, columns) = (photon as u32, self.light.width);
        let none = crate::camera::Ray { origin: DVec3::ZERO, direction: DVec3::ZERO };
        self.light.ray(k % columns, k / columns).unwrap_or(none)
    }

    /// All rays of the light are parallel.
    pub fn is_sun(&self) -> bool {
        self.ray(0).direction == self.ray(self.light.width as usize * self.light.height as usize - 1).direction
    }

    /// The light that Hou's ratio brings to a triangle, over the flux of its beam: what the light would send to its middle
    /// without the optics, times beam over triangle as seen from the light, times its area. The beam's own size cancels out.
    /// `None` where the triangle is not seen from the light.
    fn solid_angle_ratio(&self, cast: &Cast) -> Option<f64> {
        let receiver = &self.receivers[cast.receiver as usize];
        let points = cast.corners.map(|p| receiver.point(p));
        let cross = (points[1] - points[0]).cross(points[2] - points[0]);
        let ray = self.ray(0);
        // flux an area there, of one an angle (or an area) of the light's image; and how large the triangle is seen
        let (sent, seen) = if self.is_sun() {
            let cosine = cross.normalize_or_zero().dot(ray.direction.normalize()).abs();
            (cosine, cosine * cross.length() / 2.0)
        } else {
            let out = (points[0] + points[1] + points[2]) / 3.0 - ray.origin;
            let cosine = cross.normalize_or_zero().dot(out.normalize_or_zero()).abs();
            (cosine / out.length_squared(), solid_angle(points.map(|p| p - ray.origin)))
        };
        let ratio = sent / seen * cross.length() / 2.0;
        (seen > 0.0 && ratio.is_finite()).then_some(ratio)
    }
}

/// The way of a photon that landed, and where.
fn landed(photon: &Photon) -> Option<((u32, u32), DVec2)> {
    match photon.fate {
        Fate::Landed { receiver, turns, place } if place.is_finite() => Some(((receiver, turns), place)),
        _ => None,
    }
}

/// Photons by their place in the grid.
struct Grid<'a> {
    photons: &'a [Photon],
    columns: usize,
}

impl Grid<'_> {
    /// The parts of a beam's light that stay together on a receiver.
    fn casts(&self, corners: [usize; 3], flux: f64) -> Vec<Cast> {
        let ways = corners.map(|k| landed(&self.photons[k]));
        let mut casts = Vec::new();
        for (k, found) in ways.iter().enumerate() {
            let Some((way, _)) = found else { continue };
            let is_of = |k: usize| ways[k].is_some_and(|w| w.0 == *way);
            if (0..k).any(is_of) {
                continue;
            }
            let part = |mine: bool| (0..3).filter(|k| is_of(*k) == mine).map(|k| corners[k]).collect::<Vec<_>>();
            let (own, others) = (part(true), part(false));
            let third = |c: usize| own.iter().map(|k| self.photons[*k].left[c] * flux / 3.0).sum();
            let triangle = self.triangle(*way, &own, &others);
            casts.extend(triangle.map(|t| Cast { receiver: way.0, corners: t, flux: [third(0), third(1), third(2)] }));
        }
        casts
    }

    /// Over what the light of a beam's photons `own` is spread. Where `others` fare otherwise their places are guessed from
    /// the photons opposite, and the triangle is made smaller as its light is less.
    fn triangle(&self, way: (u32, u32), own: &[usize], others: &[usize]) -> Option<[DVec2; 3]> {
        let place = |k: usize| landed(&self.photons[k]).map(|l| l.1);
        let first = place(*own.first()?)?;
        let guess = |other: usize| own.iter().find_map(|k| self.opposite(way, *k, other));
        Some(match (own, others) {
            (&[_, b, c], _) => [first, place(b)?, place(c)?],
            (&[_, b], &[other]) => {
                let (b, middle) = (place(b)?, (first + place(b)?) / 2.0);
                [first, b, guess(other).map_or(middle, |c| middle.lerp(c, 2.0 / 3.0))]
            }
            (_, &[b, c]) => {
                let towards = |corner: DVec2| first.lerp(corner, (1.0f64 / 3.0).sqrt());
                guess(b).zip(guess(c)).map_or([first; 3], |(b, c)| [first, towards(b), towards(c)])
            }
            _ => [first; 3],
        })
    }

    /// Where photon `missing` would land if the map were linear from the photon on the other side of `k`.
    fn opposite(&self, way: (u32, u32), k: usize, missing: usize) -> Option<DVec2> {
        let cell = |k: usize| ((k % self.columns) as i64, (k / self.columns) as i64);
        let ((x, y), (mx, my)) = (cell(k), cell(missing));
        let (x, y) = (usize::try_from(2 * x - mx).ok()?, usize::try_from(2 * y - my).ok()?);
        let beyond = self.photons.get(y * self.columns + x).filter(|_| x < self.columns)?;
        let (_, from) = landed(beyond).filter(|l| l.0 == way)?;
        Some(2.0 * landed(&self.photons[k])?.1 - from)
    }
}

/// Solid angle of the triangle that three directions of any length span, sr (Van Oosterom and Strackee 1983).
pub fn solid_angle(directions: [DVec3; 3]) -> f64 {
    let [a, b, c] = directions.map(|d| d.normalize_or_zero());
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
