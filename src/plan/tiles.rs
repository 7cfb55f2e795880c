//! Tiles of 8 x 8 pixels, cut into cells: the pixels of one tile that one piece owns. Each sheet has its own tiles.

use super::curves::{CurveTable, nets};
use super::sheets::Sheets;
use crate::TILE;
use crate::camera::{Bundle, Camera, Pieces, Rays};
use crate::gpu::rows::{self, split2};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// The tiles of one band.
#[derive(Debug, Clone, Default)]
pub struct Tiles {
    pub tiles_x: u32,
    /// Rows of all sheets.
    pub tiles_y: u32,
    /// Rows from one sheet to the next.
    pub sheet_rows: u32,
    /// `cells[start[k] .. start[k + 1]]` are the cells of tile k.
    pub start: Vec<u32>,
    pub cells: Vec<rows::Cell>,
    /// The pieces of the band, in order of first use; each row carries its number in the camera.
    pub pieces: Vec<rows::Piece>,
}

/// A ray of a tile: its place in [-1, 1]^2 over the tile, origin relative to the anchor and direction.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    pub place: DVec2,
    pub p: DVec3,
    pub d: DVec3,
}

/// Rays by which a tile is bounded.
#[derive(Debug, Clone, Default)]
pub struct Sampled {
    pub samples: Vec<Sample>,
    /// How far the tile's rays may lie from what is affine between the samples: origins, and directions. A point of a
    /// curve lies on a straight ray moved by at most its bend, which counts as the origins'.
    pub r_p: f64,
    pub r_d: f64,
}

/// Half of a tile from its middle to the outermost pixel centre, px.
const TILE_REACH: f64 = (TILE as f64 - 1.0) / 2.0;

/// A cell before its bundle is stored: piece of its layer, pixels.
type Owned = Vec<(u32, u64)>;

/// Rows `row .. row + rows` of an image to be cut.
#[derive(Clone, Copy)]
pub struct Cutting<'a> {
    pub camera: &'a Camera,
    pub sheets: Sheets,
    pub curves: Option<&'a CurveTable>,
    pub anchor: DVec3,
    pub row: u32,
    pub rows: u32,
}

/// A tile of a layer, and the span of t that its sheet holds.
#[derive(Clone, Copy)]
struct Place {
    layer: usize,
    span: [f64; 2],
    /// Column and row in the image, tiles.
    x: u32,
    y: u32,
}

impl Cutting<'_> {
    /// The tiles; and the rays by which [`super::nodes`] bounds each.
    pub fn cut(&self) -> (Tiles, Vec<Sampled>) {
        let tiles_x = self.camera.width.div_ceil(TILE);
        let sheet_rows = self.sheets.tile_rows(self.rows);
        let tiles_y = sheet_rows * self.sheets.count();
        let place = |k: u32| {
            let (sheet, y) = (k / tiles_x / sheet_rows, k / tiles_x % sheet_rows);
            let (layer, span) = self.sheets.of_sheet(sheet);
            (y < self.rows.div_ceil(TILE)).then(|| Place { layer, span, x: k % tiles_x, y: self.row / TILE + y })
        };
        let places: Vec<Option<Place>> = (0..tiles_x * tiles_y).map(place).collect();
        let owned: Vec<Owned> = places.par_iter().map(|place| place.map_or_else(Vec::new, |p| self.owned(p))).collect();
        let nets = self.curves.map(|table| nets(table, tiles_x));
        let of = |(place, owned): (&Option<Place>, &Owned)| match (place, &nets) {
            (None, _) => Sampled::default(),
            (Some(p), Some(nets)) => {
                let tile = (p.layer as u32 * self.rows.div_ceil(TILE) + p.y - self.row / TILE) * tiles_x + p.x;
                nets[tile as usize].as_ref().map_or_else(Sampled::default, |net| net.over(p.span, self.anchor))
            }
            (Some(p), None) => Sampled { samples: self.samples(*p, owned), ..Sampled::default() },
        };
        let samples = places.par_iter().zip(&owned).map(of).collect();
        let mut tiles = Tiles { tiles_x, tiles_y, sheet_rows, start: vec![0], ..Default::default() };
        let mut local = std::collections::HashMap::new();
        for (k, (place, cells)) in places.iter().zip(&owned).enumerate() {
            for (place, &(piece, mask)) in place.iter().flat_map(|p| cells.iter().map(move |c| (p, c))) {
                let number = self.camera.first_piece(place.layer) + piece;
                let row_of = match &self.camera.layers[place.layer] {
                    Rays::Pieces(pieces) if self.curves.is_none() => *local.entry(number).or_insert_with(|| {
                        tiles.pieces.push(self.piece_row(pieces, (piece, number), *place));
                        tiles.pieces.len() as u32 - 1
                    }),
                    _ => number,
                };
                tiles.cells.push(self.cell_row((piece, row_of), *place, k as u32, mask));
            }
            tiles.start.push(tiles.cells.len() as u32);
        }
        (tiles, samples)
    }

    /// Which pixels of a tile each piece owns, by ascending piece.
    fn owned(&self, at: Place) -> Owned {
        let (left, top) = (at.x * TILE, at.y * TILE);
        let (columns, rows) = ((self.camera.width - left).min(TILE), (self.row + self.rows - top).min(TILE));
        let pixels = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
        let bit = |(x, y): (u32, u32)| 1u64 << (y * TILE + x);
        let layer = &self.camera.layers[at.layer];
        if let (Rays::Pieces(p), None) = (layer, self.curves) {
            if p.pieces[0].corners_px.is_none() {
                // one piece over the whole image
                return vec![(0, pixels.map(bit).fold(0, |m, b| m | b))];
            }
        }
        let mut cells: Owned = Vec::new();
        for (x, y) in pixels {
            let (i, j) = (left + x, top + y);
            let owner = match (self.curves, layer) {
                (Some(table), _) => table.get(at.layer, i, j).map(|(piece, _)| piece),
                (None, Rays::Pieces(p)) => p.owner(i, j),
                (None, Rays::Field(f)) => f.ray(i, j).map(|_| 0),
                (None, Rays::Curves(_)) => None,
            };
            let Some(k) = owner else { continue };
            match cells.iter_mut().find(|c| c.0 == k) {
                Some(cell) => cell.1 |= bit((x, y)),
                None => cells.push((k, bit((x, y)))),
            }
        }
        cells.sort_unstable();
        cells
    }

    /// Rays that bound all straight rays of a tile: the corners of an affine cell's pixels, or every pixel's ray.
    fn samples(&self, at: Place, owned: &Owned) -> Vec<Sample> {
        let mut list = Vec::new();
        for &(piece, mask) in owned {
            let pixels = (0..64u32).filter(|b| mask >> b & 1 == 1).map(|b| (b % TILE, b / TILE));
            let pixel = |(x, y): (u32, u32)| (at.x * TILE + x, at.y * TILE + y);
            match &self.camera.layers[at.layer] {
                Rays::Field(f) => list.extend(pixels.filter_map(|q| {
                    let (i, j) = pixel(q);
                    let (p, d) = f.ray(i, j)?;
                    Some(Sample { place: place_in_tile(q.0, q.1), p: p - self.anchor, d })
                })),
                Rays::Pieces(pieces) => {
                    let b = rebased(&pieces.bundle_at_place(piece, middle(pieces, at)), self.anchor);
                    let at = |x: f64, y: f64| {
                        let ray = b.ray(x, y);
                        let place = DVec2::new(x, y) / (TILE as f64 / 2.0);
                        Sample { place, p: ray.origin, d: ray.direction }
                    };
                    if owned.len() == 1 && b.h[1] == 0.0 && b.h[2] == 0.0 {
                        let r = TILE as f64 / 2.0;
                        list.extend([(-r, -r), (r, -r), (-r, r), (r, r)].map(|(x, y)| at(x, y)));
                    } else {
                        list.extend(pixels.map(|(x, y)| at(x as f64 - TILE_REACH, y as f64 - TILE_REACH)));
                    }
                }
                Rays::Curves(_) => {}
            }
        }
        list
    }

    fn cell_row(&self, (piece, row_of): (u32, u32), at: Place, index: u32, mask: u64) -> rows::Cell {
        let mut cell = rows::Cell {
            p: [0.0; 3],
            h: 1.0,
            d: [0.0; 3],
            piece: row_of,
            tile: index,
            mask_lo: mask as u32,
            mask_hi: (mask >> 32) as u32,
            pad: 0,
        };
        if let (Rays::Pieces(p), None) = (&self.camera.layers[at.layer], self.curves) {
            let b = rebased(&p.bundle_at_place(piece, middle(p, at)), self.anchor);
            (cell.p, cell.h, cell.d) = (b.p[0].as_vec3().to_array(), b.h[0] as f32, b.d[0].as_vec3().to_array());
        }
        cell
    }

    /// A piece's row about the first pixel of a tile.
    fn piece_row(&self, pieces: &Pieces, (piece, number): (u32, u32), at: Place) -> rows::Piece {
        let mut row: rows::Piece = bytemuck::Zeroable::zeroed();
        let b = rebased(&pieces.bundle_at(piece, at.x * TILE, at.y * TILE), self.anchor);
        let v = |v: DVec3| {
            let s = v.to_array().map(split2);
            (s.map(|s| s[0]), s.map(|s| s[1]))
        };
        (row.p_hi, row.p_lo) = v(b.p[0]);
        (row.px_hi, row.px_lo) = v(b.p[1]);
        (row.py_hi, row.py_lo) = v(b.p[2]);
        (row.d_hi, row.d_lo) = v(b.d[0]);
        (row.dx_hi, row.dx_lo) = v(b.d[1]);
        (row.dy_hi, row.dy_lo) = v(b.d[2]);
        [row.h_hi, row.h_lo] = split2(b.h[0]);
        [row.hx_hi, row.hx_lo] = split2(b.h[1]);
        [row.hy_hi, row.hy_lo] = split2(b.h[2]);
        row.origin_x = (at.x * TILE) as f32;
        row.origin_y = (at.y * TILE - self.row) as f32;
        row.number = number;
        row
    }
}

/// The middle of a tile: the mean of its pixels' sample places, image px.
fn middle(pieces: &Pieces, at: Place) -> DVec2 {
    pieces.place(at.x * TILE, at.y * TILE) + TILE_REACH
}

/// The bundle with its origins relative to the anchor.
fn rebased(b: &Bundle, anchor: DVec3) -> Bundle {
    Bundle { p: [0, 1, 2].map(|k| b.p[k] - b.h[k] * anchor), ..*b }
}

pub(super) fn place_in_tile(x: u32, y: u32) -> DVec2 {
    (DVec2::new(x as f64, y as f64) - TILE_REACH) / (TILE as f64 / 2.0)
}
