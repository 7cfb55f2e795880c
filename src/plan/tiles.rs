//! Tiles of 8 x 8 pixels, cut into cells: the pixels of one tile that one piece owns.

use crate::TILE;
use crate::camera::{Bundle, Camera, Field, Pieces, Rays};
use crate::gpu::rows::{self, split2};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::FieldTable;

/// The tiles of one band.
#[derive(Debug, Clone, Default)]
pub struct Tiles {
    pub tiles_x: u32,
    pub tiles_y: u32,
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

/// Half of a tile from its middle to the outermost pixel centre, px.
const TILE_REACH: f64 = (TILE as f64 - 1.0) / 2.0;

/// A cell before its bundle is stored: piece, pixels.
type Owned = Vec<(u32, u64)>;

impl Tiles {
    /// Cuts rows `row .. row + rows` into tiles; also the rays by which [`super::nodes`] bounds each tile.
    pub fn new(camera: &Camera, anchor: DVec3, row: u32, rows: u32) -> (Tiles, Vec<Vec<Sample>>) {
        let (tiles_x, tiles_y) = (camera.width.div_ceil(TILE), rows.div_ceil(TILE));
        let place = |k: usize| (k as u32 % tiles_x, row / TILE + k as u32 / tiles_x);
        let owned: Vec<Owned> =
            (0..(tiles_x * tiles_y) as usize).into_par_iter().map(|k| owned(camera, row + rows, place(k))).collect();
        let samples = owned.par_iter().enumerate().map(|(k, o)| samples(camera, anchor, place(k), o)).collect();
        let mut tiles = Tiles { tiles_x, tiles_y, start: vec![0], ..Default::default() };
        let mut local = std::collections::HashMap::new();
        for (k, cells) in owned.iter().enumerate() {
            for &(piece, mask) in cells {
                let row_of = *local.entry(piece).or_insert_with(|| {
                    tiles.pieces.push(piece_row(camera, anchor, piece, place(k), row));
                    tiles.pieces.len() as u32 - 1
                });
                tiles.cells.push(cell_row(camera, anchor, (piece, row_of), place(k), k as u32, mask));
            }
            tiles.start.push(tiles.cells.len() as u32);
        }
        (tiles, samples)
    }
}

/// Which pixels of a tile each piece owns, by ascending piece.
fn owned(camera: &Camera, row_end: u32, (tx, ty): (u32, u32)) -> Owned {
    let (columns, rows) = ((camera.width - tx * TILE).min(TILE), (row_end - ty * TILE).min(TILE));
    let pixels = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
    let bit = |(x, y): (u32, u32)| 1u64 << (y * TILE + x);
    match &camera.layers[0] {
        Rays::Field(f) => {
            let has_ray = |&(x, y): &(u32, u32)| f.ray(tx * TILE + x, ty * TILE + y).is_some();
            let mask = pixels.filter(has_ray).map(bit).fold(0, |m, b| m | b);
            if mask == 0 { Vec::new() } else { vec![(0, mask)] }
        }
        Rays::Curves(_) => Vec::new(),
        Rays::Pieces(p) => {
            if p.pieces[0].corners_px.is_none() {
                // one piece over the whole image
                return vec![(0, pixels.map(bit).fold(0, |m, b| m | b))];
            }
            let mut cells: Owned = Vec::new();
            for (x, y) in pixels {
                let Some(k) = p.owner(tx * TILE + x, ty * TILE + y) else { continue };
                match cells.iter_mut().find(|c| c.0 == k) {
                    Some(cell) => cell.1 |= bit((x, y)),
                    None => cells.push((k, bit((x, y)))),
                }
            }
            cells.sort_unstable();
            cells
        }
    }
}

/// The middle of a tile: the mean of its pixels' sample places, image px.
fn middle(pieces: &Pieces, (tx, ty): (u32, u32)) -> DVec2 {
    pieces.place(tx * TILE, ty * TILE) + TILE_REACH
}

/// The bundle with its origins relative to the anchor.
fn rebased(b: &Bundle, anchor: DVec3) -> Bundle {
    Bundle { p: [0, 1, 2].map(|k| b.p[k] - b.h[k] * anchor), ..*b }
}

/// Rays that bound all rays of a tile: the corners of an affine cell's pixels, or every pixel's ray.
fn samples(camera: &Camera, anchor: DVec3, tile: (u32, u32), owned: &Owned) -> Vec<Sample> {
    let mut list = Vec::new();
    for &(piece, mask) in owned {
        let pixels = (0..64u32).filter(|b| mask >> b & 1 == 1).map(|b| (b % TILE, b / TILE));
        match &camera.layers[0] {
            Rays::Field(f) => list.extend(pixels.filter_map(|(x, y)| {
                let (p, d) = f.ray(tile.0 * TILE + x, tile.1 * TILE + y)?;
                Some(Sample { place: place_in_tile(x, y), p: p - anchor, d })
            })),
            Rays::Curves(_) => {}
            Rays::Pieces(pieces) => {
                let b = rebased(&pieces.bundle_at_place(piece, middle(pieces, tile)), anchor);
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
        }
    }
    list
}

fn place_in_tile(x: u32, y: u32) -> DVec2 {
    (DVec2::new(x as f64, y as f64) - TILE_REACH) / (TILE as f64 / 2.0)
}

fn cell_row(
    camera: &Camera,
    anchor: DVec3,
    (piece, row_of): (u32, u32),
    tile: (u32, u32),
    index: u32,
    mask: u64,
) -> rows::Cell {
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
    if let Rays::Pieces(p) = &camera.layers[0] {
        let b = rebased(&p.bundle_at_place(piece, middle(p, tile)), anchor);
        (cell.p, cell.h, cell.d) = (b.p[0].as_vec3().to_array(), b.h[0] as f32, b.d[0].as_vec3().to_array());
    }
    cell
}

/// A piece's row about the first pixel of `tile`.
fn piece_row(camera: &Camera, anchor: DVec3, piece: u32, tile: (u32, u32), band_row: u32) -> rows::Piece {
    let mut row: rows::Piece = bytemuck::Zeroable::zeroed();
    let Rays::Pieces(pieces) = &camera.layers[0] else { return row };
    let b = rebased(&pieces.bundle_at(piece, tile.0 * TILE, tile.1 * TILE), anchor);
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
    row.origin_x = (tile.0 * TILE) as f32;
    row.origin_y = (tile.1 * TILE - band_row) as f32;
    row.number = piece;
    row
}

/// The rays of rows `row ..= row + rows`, one column and row more than the band; beyond the image and beside a pixel
/// without a ray, the place that leaves the slope of [`Field::bundle`].
pub fn field_table(field: &Field, anchor: DVec3, row: u32, rows: u32) -> FieldTable {
    let mut table = FieldTable::default();
    let mut push = |v: DVec3| {
        for [hi, lo] in v.to_array().map(split2) {
            table.hi.push(hi);
            table.lo.push(lo);
        }
    };
    for j in row..=row + rows {
        for i in 0..=field.width {
            let (p, d) = field.ray_or_beyond(i, j).unwrap_or((anchor, DVec3::ZERO));
            push(p - anchor);
            push(d);
        }
    }
    table
}
