//! From photons to caustic triangles: the flux of the beams between them, and where it falls on receivers.

use super::receiver_triangles::ReceiverTriangles;
use super::{Caustics, FluxBudget, Method, mean};
use crate::arrays::MapEach;
use crate::geometry::mesh::Mesh;
use crate::image::frame::{Channel, Frame, NO_ID};
use crate::input::{Error, Result};
use crate::parallel;
use glam::DVec2;

/// What the photon-location map is made of.
pub const CHANNELS: [Channel; 6] =
    [Channel::R, Channel::G, Channel::TriangleId, Channel::BaryU, Channel::BaryV, Channel::MirrorId];

/// The fate of a photon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Photon {
    pub fate: Fate,
    /// Share of the light left after the bounces, linear RGB.
    pub left: [f64; 3],
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fate {
    /// Never bounced.
    Direct,
    /// Ended on the optics.
    Absorbed,
    /// Bounced, and not on a receiver's plane.
    Missed,
    /// Bounced so often, then on this receiver's plane at `place`, texels.
    OnReceiver { receiver: u32, bounces: u32, place: DVec2 },
}

/// Light on a receiver, spread evenly over a triangle; a line or a point where corners coincide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CausticTriangle {
    pub receiver: u32,
    /// Texels.
    pub corners: [DVec2; 3],
    /// Linear RGB.
    pub flux: [f64; 3],
}

impl Caustics {
    /// The photons of an image of [`Caustics::counting`] with the channels [`CHANNELS`], row by row.
    pub fn photons(&self, mesh: &Mesh, receiver_triangles: &ReceiverTriangles, frame: &Frame) -> Result<Vec<Photon>> {
        let absent = || Error::work("the photon-location map lacks a channel");
        let f32s = |channel| frame.f32(channel).ok_or_else(absent);
        let u32s = |channel| frame.u32(channel).ok_or_else(absent);
        let (ids, mirrors) = (u32s(Channel::TriangleId)?, u32s(Channel::MirrorId)?);
        let (u, v) = (f32s(Channel::BaryU)?, f32s(Channel::BaryV)?);
        let (r, g) = (f32s(Channel::R)?, f32s(Channel::G)?);
        let triangles = mesh.triangles.len() as u32;
        let photon = |k: usize| {
            // halving is exact
            let bounces = (g[k] / r[k]).log2().round();
            let left = self.optics.tint.map_each(|tint| f64::from(tint).powi(bounces as i32) * f64::from(g[k]));
            let fate = match (mirrors[k], ids[k], receiver_triangles.of(ids[k])) {
                (NO_ID, ..) => return Photon { fate: Fate::Direct, left: [1.0; 3] },
                (_, NO_ID, _) => Fate::Missed,
                (_, id, _) if id >= triangles => Fate::Absorbed,
                (_, _, None) => Fate::Missed,
                (_, _, Some(receiver_triangle)) => {
                    let place = receiver_triangle.place([u[k], v[k]].map_each(f64::from));
                    Fate::OnReceiver { receiver: receiver_triangle.receiver, bounces: bounces as u32, place }
                }
            };
            // a path without light has no share
            let left = if left.iter().all(|l| l.is_finite()) { left } else { [0.0; 3] };
            Photon { fate, left }
        };
        Ok(parallel::map(0..ids.len(), photon))
    }

    /// The caustic triangles of all beams, and a budget without what the receivers' maps alone know: `deposited`, and the
    /// part of `missed` that lies beyond their borders.
    ///
    /// Photons of a beam with the same number of bounces and the same receiver stay together: three are a triangle, two
    /// have two thirds of the flux, one a third, on triangles guessed from their neighbours.
    pub fn caustic_triangles(&self, photons: &[Photon]) -> (Vec<CausticTriangle>, FluxBudget) {
        let flux = self.beam_flux();
        let mut budget = FluxBudget { flux: self.flux, ..FluxBudget::default() };
        let mut caustic_triangles = Vec::new();
        let grid = Grid { photons, columns: self.light.width as usize };
        for (corners, flux) in self.beams().zip(flux) {
            let three = corners.map_each(|k| photons[k]);
            for photon in three {
                let third = flux / 3.0;
                let left = third * mean(photon.left);
                budget.absorbed += third - left;
                match photon.fate {
                    Fate::Direct => budget.direct += left,
                    Fate::Absorbed => budget.absorbed += left,
                    Fate::Missed => budget.missed += left,
                    Fate::OnReceiver { .. } => {}
                }
            }
            for triangle in grid.caustic_triangles(corners, flux) {
                match self.method {
                    Method::Flux => caustic_triangles.push(triangle),
                    Method::SolidAngle => {
                        let ratio = self.solid_angle_ratio(&triangle);
                        match ratio {
                            Some(ratio) => caustic_triangles
                                .push(CausticTriangle { flux: triangle.flux.map_each(|f| f * ratio), ..triangle }),
                            None => budget.missed += mean(triangle.flux),
                        }
                    }
                }
            }
        }
        budget.triangles = caustic_triangles.len() as u64;
        (caustic_triangles, budget)
    }
}

/// Receiver, number of bounces and texel place of a photon on a receiver.
fn on_receiver(photon: &Photon) -> Option<((u32, u32), DVec2)> {
    match photon.fate {
        Fate::OnReceiver { receiver, bounces, place } => Some(((receiver, bounces), place)),
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
    fn caustic_triangles(&self, corners: [usize; 3], flux: f64) -> Vec<CausticTriangle> {
        let paths = corners.map_each(|k| on_receiver(&self.photons[k]));
        let mut caustic_triangles = Vec::new();
        for (k, found) in paths.iter().enumerate() {
            let Some((path, _)) = found else { continue };
            let is_of = |k: usize| paths[k].is_some_and(|w| w.0 == *path);
            if (0..k).any(is_of) {
                continue;
            }
            let part = |mine: bool| (0..3).filter(|k| is_of(*k) == mine).map(|k| corners[k]).collect::<Vec<_>>();
            let (own, others) = (part(true), part(false));
            let third = |c: usize| own.iter().map(|k| self.photons[*k].left[c] * flux / 3.0).sum();
            let triangle = self.triangle(*path, &own, &others);
            caustic_triangles.extend(triangle.map(|t| CausticTriangle {
                receiver: path.0,
                corners: t,
                flux: [third(0), third(1), third(2)],
            }));
        }
        caustic_triangles
    }

    /// The triangle over which the light of a beam's photons `own` is spread. If `others` took another path, their places are
    /// extrapolated, and the triangle is shrunk in proportion to its light.
    fn triangle(&self, path: (u32, u32), own: &[usize], others: &[usize]) -> Option<[DVec2; 3]> {
        let place = |k: usize| on_receiver(&self.photons[k]).map(|l| l.1);
        let first = place(*own.first()?)?;
        let guess = |other: usize| own.iter().find_map(|k| self.opposite(path, *k, other));
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

    /// The place of photon `missing` if the map were linear from the photon on the other side of `k`.
    fn opposite(&self, path: (u32, u32), k: usize, missing: usize) -> Option<DVec2> {
        let cell = |k: usize| ((k % self.columns) as i64, (k / self.columns) as i64);
        let ((x, y), (mx, my)) = (cell(k), cell(missing));
        let (x, y) = (usize::try_from(2 * x - mx).ok()?, usize::try_from(2 * y - my).ok()?);
        let beyond = self.photons.get(y * self.columns + x).filter(|_| x < self.columns)?;
        let (_, from) = on_receiver(beyond).filter(|l| l.0 == path)?;
        Some(2.0 * on_receiver(&self.photons[k])?.1 - from)
    }
}
