//! Central cameras in perspective pieces (Lorenz and Doellner 2009): a grid of cells over the image, each a perspective.

use super::Posed;
use crate::arrays::MapEach;
use crate::camera::bundle::Bundle;
use crate::camera::mesh::interpolated;
use crate::camera::pieces::{Piece, Pieces};
use crate::camera::recipe::{Built, Setting};
use crate::camera::{RayMap, Rays};
use crate::input::limits::CELLS;
use crate::input::reader::Table;
use crate::input::{Error, Result};
use glam::{DVec2, DVec3};

/// Most cells: pieces, two a cell, are numbered in 32 bits.
const STRIPS_MAX: u64 = 1 << 30;

/// The key `strips`, which excludes `pieces`.
pub fn read(table: &Table) -> Result<Option<u32>> {
    let Some(field) = table.get("strips") else { return Ok(None) };
    if table.has("pieces") || table.has("error") {
        return Err(field.error("strips and pieces both split the image; give one of them"));
    }
    let strips = field.integer(1, STRIPS_MAX)?;
    field.limits().check(CELLS, strips).map_err(|e| field.error(e))?;
    // it is at most STRIPS_MAX, under 2^32
    Ok(Some(strips as u32))
}

/// Equal cells over the whole image.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    pub columns: u32,
    pub rows: u32,
    /// Of the image, px.
    pub size: DVec2,
}

impl Grid {
    /// # Errors
    /// [`Error::Input`] for more cells than fit.
    pub fn new(columns: u32, rows: f64, setting: &Setting) -> Result<Grid> {
        let (width, height) = setting.size()?;
        let cells = f64::from(columns) * rows;
        let at = |e: Error| e.at(format_args!("camera.strips = {columns}"));
        setting.limits().check_as(CELLS, cells as u64, format_args!("{columns} x {rows}")).map_err(at)?;
        if cells > STRIPS_MAX as f64 {
            return Err(at(Error::input(format!(
                "{columns} x {rows} cells are more than can be numbered; give fewer"
            ))));
        }
        Ok(Grid { columns, rows: rows as u32, size: DVec2::new(width.into(), height.into()) })
    }

    pub fn cells(&self) -> u64 {
        u64::from(self.columns) * u64::from(self.rows)
    }

    /// Two pieces a cell, row by row, with the map's rays at the cells' corners, their directions interpolated over each
    /// triangle: `D = sum L_i D_i`, L the barycentric coordinates in the image. The map has a ray everywhere.
    pub fn build(&self, map: &Posed) -> Built {
        let direction = |q: (f64, f64)| map.ray(q.0, q.1).map_or(DVec3::ZERO, |r| r.direction);
        let (eye, (w, h)) = (map.eye, (self.size.x as u32, self.size.y as u32));
        let pieces = self
            .corners()
            .flat_map(|q| {
                let d = q.map_each(direction);
                [[0, 1, 2], [3, 1, 2]]
                    .map_each(|t| central(eye, t.map_each(|k| DVec2::from(q[k]) * self.size), t.map_each(|k| d[k])))
            })
            .collect();
        Built::new((w, h), Rays::Pieces(Pieces::new(pieces, w, h)))
    }

    /// The cells' corners in image coordinates: top left, top right, bottom left, bottom right.
    fn corners(&self) -> impl Iterator<Item = [(f64, f64); 4]> + '_ {
        let (n, m) = (f64::from(self.columns), f64::from(self.rows));
        let cells = (0..self.rows).flat_map(|j| (0..self.columns).map(move |i| (f64::from(i), f64::from(j))));
        cells.map(move |(i, j)| [(0., 0.), (1., 0.), (0., 1.), (1., 1.)].map_each(|(x, y)| ((i + x) / n, (j + y) / m)))
    }
}

/// The piece over an image triangle (px) with rays from `eye` in the directions interpolated from its corners.
pub fn central(eye: DVec3, corners_px: [DVec2; 3], directions: [DVec3; 3]) -> Piece {
    let d = interpolated(&corners_px, directions);
    let bundle = Bundle { p: [eye, DVec3::ZERO, DVec3::ZERO], d, h: [1.0, 0.0, 0.0] };
    Piece { bundle, centre_px: corners_px.iter().sum::<DVec2>() / 3.0, corners_px: Some(corners_px) }
}
