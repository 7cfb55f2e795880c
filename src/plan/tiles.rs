//! Tiles of 8 x 8 pixels, cut into cells: the pixels of one tile that one piece owns. Each sheet has its own tiles.

use super::curves::{CurveTable, Net, nets};
use super::nodes::above_cells;
use super::sheets::Sheets;
use super::tear::{Part, tear};
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

/// Cells before their bundles are stored: piece of the layer, pixels.
type Owned = Vec<(u32, u64)>;

/// What bounds all rays of a tile, and, where straight ones are in several cells, each cell's.
#[derive(Debug, Default)]
pub struct Bounds {
    pub whole: Sampled,
    pub each: Vec<Sampled>,
}

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
    /// The tiles; and the rays that bound each and its cells.
    pub fn cut(&self) -> (Tiles, Vec<Bounds>) {
        let tiles_x = self.camera.width.div_ceil(TILE);
        let sheet_rows = self.sheets.tile_rows(self.rows);
        let tiles_y = sheet_rows * self.sheets.count();
        let place = |k: u32| {
            let (sheet, y) = (k / tiles_x / sheet_rows, k / tiles_x % sheet_rows);
            let (layer, span) = self.sheets.of_sheet(sheet);
            (y < self.rows.div_ceil(TILE)).then(|| Place { layer, span, x: k % tiles_x, y: self.row / TILE + y })
        };
        let places: Vec<Option<Place>> = (0..tiles_x * tiles_y).map(place).collect();
        let nets = self.curves.map(|table| nets(table, tiles_x));
        let cut = |place: &Option<Place>| {
            let (Some(place), Some(nets)) = (place, &nets) else {
                return place.map_or_else(Default::default, |p| self.straight(p));
            };
            let tile = (place.layer as u32 * self.rows.div_ceil(TILE) + place.y - self.row / TILE) * tiles_x + place.x;
            let over = |net: &Net| net.over(place.span, self.anchor);
            let whole = nets[tile as usize].as_ref().map_or_else(Sampled::default, over);
            (self.owned(*place), Bounds { whole, each: Vec::new() })
        };
        let (owned, bounds): (Vec<Owned>, Vec<Bounds>) = places.par_iter().map(cut).unzip();
        let mut tiles = Tiles { tiles_x, tiles_y, sheet_rows, start: vec![0], ..Default::default() };
        let mut node_of_cell = above_cells(tiles_x, tiles_y);
        let mut local = std::collections::HashMap::new();
        for (((k, place), owned), bounds) in (0u32..).zip(&places).zip(&owned).zip(&bounds) {
            for (place, &(piece, mask)) in place.iter().flat_map(|p| owned.iter().map(move |c| (p, c))) {
                let number = self.camera.first_piece(place.layer) + piece;
                let row_of = match &self.camera.layers[place.layer] {
                    Rays::Pieces(pieces) if self.curves.is_none() => *local.entry(number).or_insert_with(|| {
                        tiles.pieces.push(self.piece_row(pieces, (piece, number), *place));
                        tiles.pieces.len() as u32 - 1
                    }),
                    _ => number,
                };
                let node = if bounds.each.is_empty() { k } else { node_of_cell };
                node_of_cell += u32::from(node != k);
                tiles.cells.push(rows::Cell { tile: k, node, ..self.cell_row((piece, row_of), *place, mask) });
            }
            tiles.start.push(tiles.cells.len() as u32);
        }
        (tiles, bounds)
    }

    /// The cells of a tile of straight rays, and what bounds them.
    fn straight(&self, at: Place) -> (Owned, Bounds) {
        let owned = self.owned(at);
        let sampled = |samples| Sampled { samples, ..Sampled::default() };
        let samples = self.samples(at, &owned);
        if let (Rays::Field(_), &[(piece, mask)]) = (&self.camera.layers[at.layer], owned.as_slice()) {
            let whole = Part { mask, samples: samples.clone() };
            // of sorted rays no cut leaves any nearer to each other
            let is_sorted = matches!(self.camera.layers.as_slice(), [Rays::Field(f)] if f.is_sorted);
            let parts = if is_sorted { vec![whole] } else { tear(whole) };
            let owned: Owned = parts.iter().map(|part| (piece, part.mask)).collect();
            let each =
                if parts.len() > 1 { parts.into_iter().map(|p| sampled(p.samples)).collect() } else { Vec::new() };
            return (owned, Bounds { whole: sampled(samples), each });
        }
        let share = |cell: &(u32, u64)| sampled(self.samples(at, &[*cell]));
        let each = if owned.len() > 1 { owned.iter().map(share).collect() } else { Vec::new() };
        (owned, Bounds { whole: sampled(samples), each })
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

    /// Rays that bound all straight rays of these cells: the corners of a lone affine one's tile, or every pixel's ray.
    fn samples(&self, at: Place, owned: &[(u32, u64)]) -> Vec<Sample> {
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

    /// A cell of a tile and a node yet to be named.
    fn cell_row(&self, (piece, row_of): (u32, u32), at: Place, mask: u64) -> rows::Cell {
        let mut cell = rows::Cell {
            p: [0.0; 3],
            h: 1.0,
            d: [0.0; 3],
            piece: row_of,
            tile: rows::NONE,
            mask_lo: mask as u32,
            mask_hi: (mask >> 32) as u32,
            node: rows::NONE,
        };
        if let (Rays::Pieces(p), None) = (&self.camera.layers[at.layer], self.curves) {
            let b = rebased(&p.bundle_at_place(piece, middle(p, at)), self.anchor);
            (cell.p, cell.h, cell.d) = (b.p[0].as_vec3().to_array(), b.h[0] as f32, b.d[0].as_vec3().to_array());
        }
        cell
    }

    /// A piece's row about the first pixel of a tile.
    fn piece_row(&self, pieces: &Pieces, (piece, number): (u32, u32), at: Place) -> rows::Piece {
        let (x, y) = (at.x * TILE, at.y * TILE);
        row_of(&pieces.bundle_at(piece, x, y), self.anchor, [x as f32, (y - self.row) as f32], number)
    }
}

/// The row of a bundle that is centred on a pixel.
pub fn row_of(bundle: &Bundle, anchor: DVec3, [origin_x, origin_y]: [f32; 2], number: u32) -> rows::Piece {
    let mut row = rows::Piece { origin_x, origin_y, number, ..bytemuck::Zeroable::zeroed() };
    let b = rebased(bundle, anchor);
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
    row
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
