//! An atlas of facets: an image in which each facet's camera covers a right-angled triangle of one size.
//!
//! Hou, Wei, Shum and Guo 2006, sections 2 and 2.3; the rays of a facet's texels as Yu, Yu and McMillan 2009 (flat), or as
//! Hou et al. in section 3.1 (interpolated normals).

use super::bounce::{Split, at_facet};
use super::{Atlas, Branch, Facet, Facets, Law, Optics};
use crate::arrays::MapEach;
use crate::camera::mesh::{half_cell, triangle};
use crate::camera::{Camera, Field, Pieces, Ray, Rays};
use crate::image::size::check_size;
use crate::input::{Error, Result};
use crate::parallel;
use glam::{DVec2, DVec3};

/// Where facets lie in an atlas: two a square cell, the even one in the upper left half, row by row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    /// Texels a side of a cell.
    pub side: u32,
    pub columns: u32,
    pub rows: u32,
}

impl Layout {
    pub fn new(facets: usize, side: u32) -> Layout {
        let cells = facets.div_ceil(2).max(1);
        let columns = (cells as f64).sqrt().ceil() as usize;
        Layout { side, columns: columns as u32, rows: cells.div_ceil(columns) as u32 }
    }

    pub fn size(&self) -> (u32, u32) {
        (self.columns * self.side, self.rows * self.side)
    }

    /// The corners of a facet's triangle, texels: the right angle, below it and beside it; of odd facets rotated by 180 degrees.
    pub fn corners(&self, facet: usize) -> [DVec2; 3] {
        half_cell(facet, self.columns as usize, DVec2::splat(self.side.into()))
    }
}

/// The camera whose picture is the atlas.
///
/// # Errors
/// [`Error::Input`] if the atlas exceeds the largest image size.
pub fn camera(optics: &Optics, atlas: &Atlas, facets: &Facets, law: Law) -> Result<Camera> {
    let layout = Layout::new(facets.triangles.len(), atlas.texels);
    let (width, height) = layout.size();
    let n = facets.triangles.len();
    check_size(width.into(), height.into())
        .map_err(|e| Error::input(format!("camera.atlas: {n} facets of {} texels a side: {e}", atlas.texels)))?;
    let split = Split { branch: Branch::Main, tilt: DVec2::ZERO };
    let facet_rays = |k: usize| corner_rays((optics, split), atlas.eye, &facets.facet(k));
    let rays = match law {
        Law::Flat { .. } => {
            let piece = |k: usize| triangle(layout.corners(k), facet_rays(k));
            Rays::Pieces(Pieces::new(parallel::map(0..n, piece), width, height))
        }
        Law::Normals => {
            let at = |texel: usize| {
                let (i, j) = (texel as u32 % width, texel as u32 / width);
                let (x, y) = (i % layout.side, j % layout.side);
                let cell = (j / layout.side) * layout.columns + i / layout.side;
                let lower = x + y >= layout.side;
                let facet =
                    facets.triangles.get(2 * cell as usize + usize::from(lower)).map(|_| 2 * cell + u32::from(lower));
                let place = (DVec2::new(f64::from(x), f64::from(y)) + 0.5) / f64::from(layout.side);
                let place = if lower { 1.0 - place } else { place };
                facet.map_or((DVec3::ZERO, DVec3::ZERO), |k| {
                    let facet = facets.facet(k as usize);
                    let weights = [place.y, place.x];
                    let on = |c: [DVec3; 3]| (1.0 - place.x - place.y) * c[0] + place.y * c[1] + place.x * c[2];
                    let (origin, (d, _)) =
                        at_facet((optics, split), law, &facet, on(facet.corners) - atlas.eye, weights);
                    (optics.environment.unwrap_or(origin), d)
                })
            };
            let (p, d): (Vec<DVec3>, Vec<DVec3>) =
                parallel::map(0..width as usize * height as usize, at).into_iter().unzip();
            Rays::Field(Field::new(width, height, &p, &d)?)
        }
    };
    Ok(Camera::of("atlas", (width, height), [0.0, f64::INFINITY], rays))
}

/// The rays of a flat facet's corners, scaled as [`Law::Flat`] says.
fn corner_rays(by: (&Optics, Split), eye: DVec3, facet: &Facet) -> [Ray; 3] {
    let [a, b, c] = facet.corners;
    let outside = (b - a).cross(c - a);
    // at a corner the interpolated ray is the corner's own
    let law = Law::Flat { eye };
    let weights = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    [0, 1, 2].map_each(|k| {
        let (place, (direction, _)) = at_facet(by, law, facet, outside, weights[k]);
        Ray { origin: by.0.environment.unwrap_or(place), direction }
    })
}
