//! The rays of a pixel in f64, from the rows that the kernels read: a piece's row, or the table of a ray field.

use super::Input;
use crate::TILE;
use crate::camera::Bundle;
use crate::gpu::rows::{Cell, Piece};
use crate::plan::FieldTable;
use glam::DVec3;

/// A pixel's bundle about its centre, and the sizes of what was summed up to get it: their rounding is the bundle's.
#[derive(Debug, Clone, Copy)]
pub struct PixelRays {
    pub bundle: Bundle,
    pub size_p: f64,
    pub size_d: f64,
    pub size_h: f64,
}

impl PixelRays {
    /// The ray's direction.
    pub fn direction(&self) -> DVec3 {
        self.bundle.d[0] / self.bundle.h[0]
    }
}

impl Input<'_> {
    /// Column and row in the band of a pixel of a tile.
    pub fn pixel_of(&self, tile: u32, bit: u32) -> (u32, u32) {
        let (tx, ty) = (tile % self.params.tiles_x, tile / self.params.tiles_x);
        (tx * TILE + bit % TILE, ty * TILE + bit / TILE)
    }

    /// The rays about the pixel `bit` of a cell.
    pub fn cell_rays(&self, cell: &Cell, bit: u32) -> PixelRays {
        let (x, y) = self.pixel_of(cell.tile, bit);
        match self.field {
            Some(table) => field_rays(table, self.params.width, x, y),
            None => piece_rays(&self.pieces[cell.piece as usize], x, y),
        }
    }

    /// The cell that owns a pixel of the band.
    pub fn pixel_cell(&self, x: u32, y: u32) -> Option<u32> {
        let tile = ((y / TILE) * self.params.tiles_x + x / TILE) as usize;
        let bit = (y % TILE) * TILE + x % TILE;
        (self.tile_start[tile]..self.tile_start[tile + 1]).find(|&k| owned(&self.cells[k as usize]) >> bit & 1 == 1)
    }
}

/// The pixels of a cell, bit 8 y + x.
pub fn owned(cell: &Cell) -> u64 {
    u64::from(cell.mask_lo) | u64::from(cell.mask_hi) << 32
}

fn piece_rays(piece: &Piece, x: u32, y: u32) -> PixelRays {
    let v = |hi: [f32; 3], lo: [f32; 3]| DVec3::from(hi.map(f64::from)) + DVec3::from(lo.map(f64::from));
    let s = |hi: f32, lo: f32| f64::from(hi) + f64::from(lo);
    let whole = Bundle {
        p: [v(piece.p_hi, piece.p_lo), v(piece.px_hi, piece.px_lo), v(piece.py_hi, piece.py_lo)],
        d: [v(piece.d_hi, piece.d_lo), v(piece.dx_hi, piece.dx_lo), v(piece.dy_hi, piece.dy_lo)],
        h: [s(piece.h_hi, piece.h_lo), s(piece.hx_hi, piece.hx_lo), s(piece.hy_hi, piece.hy_lo)],
    };
    let (x, y) = (f64::from(x) - f64::from(piece.origin_x), f64::from(y) - f64::from(piece.origin_y));
    let sum = |c: [f64; 3]| c[0].abs() + (x * c[1]).abs() + (y * c[2]).abs();
    PixelRays {
        bundle: whole.recentred(x, y),
        size_p: sum(whole.p.map(DVec3::length)),
        size_d: sum(whole.d.map(DVec3::length)),
        size_h: sum(whole.h),
    }
}

/// The ray that the table holds for a place; no direction: none.
fn field_ray(table: &FieldTable, width: u32, x: u32, y: u32) -> (DVec3, DVec3) {
    let at = 6 * (y as usize * (width as usize + 1) + x as usize);
    let number = |k: usize| f64::from(table.hi[at + k]) + f64::from(table.lo[at + k]);
    (DVec3::new(number(0), number(1), number(2)), DVec3::new(number(3), number(4), number(5)))
}

/// The ray of a pixel, and its slopes towards the right and lower neighbours that have a ray.
fn field_rays(table: &FieldTable, width: u32, x: u32, y: u32) -> PixelRays {
    let (p, d) = field_ray(table, width, x, y);
    let slope = |(q, e): (DVec3, DVec3)| if e == DVec3::ZERO { (e, e) } else { (q - p, e - d) };
    let (px, dx) = slope(field_ray(table, width, x + 1, y));
    let (py, dy) = slope(field_ray(table, width, x, y + 1));
    let bundle = Bundle { p: [p, px, py], d: [d, dx, dy], h: [1.0, 0.0, 0.0] };
    PixelRays { bundle, size_p: p.length(), size_d: d.length(), size_h: 1.0 }
}
