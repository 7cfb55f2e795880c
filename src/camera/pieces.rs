//! Images made of pieces, each an affine homogeneous bundle of rays; and the piece that owns a pixel.
//!
//! Borders are decided in f64 with one canonical order of every edge's end points, so two pieces that share
//! an edge see the same number: a pixel exactly on a border lies in both, and the lowest-numbered piece owns it.

use super::boxes::{Boxes, around, around_triangle};
use super::bundle::Bundle;
use super::lens::Held;
use super::stack::Stack;
use super::view::View;
use crate::arrays::MapEach;
use crate::camera::TILE;
use crate::parallel;
use glam::{DVec2, DVec3};
use std::collections::HashMap;
use std::sync::Arc;

/// One piece: its rays, and its image triangle.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Centred on `centre_px`.
    pub bundle: Bundle,
    /// Image place in pixels, x right and y down, (0, 0) the top left corner of the image.
    pub centre_px: DVec2,
    /// The piece's image triangle in pixels; `None`: the whole image.
    pub corners_px: Option<[DVec2; 3]>,
}

/// Pieces over an image, with a list of the pieces near each tile of [`TILE`] x [`TILE`] pixels.
#[derive(Debug, Clone)]
pub struct Pieces {
    pub pieces: Vec<Piece>,
    /// Width and height of the image, px.
    size: (u32, u32),
    tiles: Arc<Tiles>,
    /// Where in a pixel its ray is taken, px from the pixel's top left corner.
    sample: DVec2,
    /// The images that this one is made of, if it is: all above but `pieces` is then theirs.
    stacked: Option<Arc<StackedPieces>>,
    /// These pieces in the frame of their viewer, if they have one.
    turned: Option<TurnedPieces>,
}

/// The pieces near each tile.
#[derive(Debug, Default)]
struct Tiles {
    /// `pieces[start[k]..start[k + 1]]` are the pieces near tile k, ascending.
    start: Vec<u32>,
    pieces: Vec<u32>,
    /// A hierarchy over the pieces of each tile that has [`MANY`] or more, by the tile's number.
    crowded: HashMap<usize, Boxes>,
}

impl Tiles {
    fn near(&self, k: usize) -> &[u32] {
        &self.pieces[self.start[k] as usize..self.start[k + 1] as usize]
    }
}

/// Pieces in the frame of a viewer at a pose.
#[derive(Debug, Clone)]
pub struct TurnedPieces {
    /// For a viewer at the origin, with the world's axes; all poses share them.
    pub unturned: Arc<Pieces>,
    pub eye: DVec3,
    pub view: View,
}

/// Pieces in viewers' frames that cameras of this process hold.
static UNTURNED: Held<Pieces> = Held::new();

#[derive(Debug)]
struct StackedPieces {
    stack: Stack<Pieces>,
    /// Rows of an image.
    rows: u32,
    /// The number of each image's first piece.
    first: Vec<u32>,
}

impl StackedPieces {
    /// The image of a row, if it lies in one: its pieces, the number of the first, and the row's number there.
    fn at(&self, j: u32) -> Option<(&Pieces, u32, u32)> {
        let (k, row) = self.stack.at(j);
        (row < self.rows).then(|| (&self.stack.images[k], self.first[k], row))
    }

    /// The image that a piece belongs to, and the piece's number there.
    fn of_piece(&self, piece: u32) -> (usize, u32) {
        let k = self.first.partition_point(|first| *first <= piece) - 1;
        (k, piece - self.first[k])
    }
}

/// Rounding bound of [`side`], in units of the sum of its absolute products: two differences, two products
/// and one subtraction (5 u), and the rounding of the corners themselves to pixels (2 u): 8 u with u = 2^-53.
const SIDE_ROUNDING: f64 = 8.0 / (1u64 << 53) as f64;

/// Tiles with at least this many pieces have a hierarchy of boxes, and this many pieces share a leaf.
const MANY: usize = 256;
const RUN: usize = 8;

/// How far beyond a tile a piece may lie and still be listed with it: the safe radius and a sample offset of half a pixel.
const TILE_REACH_PX: f64 = super::SAFE_RADIUS_PX + 0.5;

/// Twice the signed area of (a, b, q), 0 within rounding; the same bits up to sign for (b, a, q).
pub(super) fn side(a: DVec2, b: DVec2, q: DVec2) -> f64 {
    let flip = (a.x, a.y) > (b.x, b.y);
    let (a, b) = if flip { (b, a) } else { (a, b) };
    let (e, m) = (b - a, q - a);
    let value = e.x * m.y - e.y * m.x;
    let reach = DVec2::new(m.x.abs() + a.x.abs() + q.x.abs(), m.y.abs() + a.y.abs() + q.y.abs());
    if value.abs() <= SIDE_ROUNDING * (e.x.abs() * reach.y + e.y.abs() * reach.x) {
        return 0.0;
    }
    if flip { -value } else { value }
}

/// The triangle holds the place, its border included.
pub(super) fn holds([a, b, c]: [DVec2; 3], q: DVec2) -> bool {
    let o = side(a, b, c);
    side(a, b, q) * o >= 0.0 && side(b, c, q) * o >= 0.0 && side(c, a, q) * o >= 0.0
}

impl Piece {
    /// A piece that is the whole image; `bundle` is centred on its middle.
    pub fn whole(bundle: Bundle, (width, height): (u32, u32)) -> Piece {
        Piece { bundle, centre_px: DVec2::new(width.into(), height.into()) / 2.0, corners_px: None }
    }

    /// The piece holds the image place `q` (px), its border included.
    pub(super) fn contains(&self, q: DVec2) -> bool {
        self.corners_px.is_none_or(|corners| holds(corners, q))
    }

    /// The piece may come within the box of half-sizes `half` about `centre` (px): never false when it does.
    pub(super) fn reaches(&self, centre: DVec2, half: DVec2) -> bool {
        let Some([a, b, c]) = self.corners_px else { return true };
        let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
        if (lo - half).cmpgt(centre).any() || (hi + half).cmplt(centre).any() {
            return false;
        }
        let o = side(a, b, c).signum();
        [(a, b), (b, c), (c, a)].iter().all(|&(s, t)| {
            let e = t - s;
            o * side(s, t, centre) + e.x.abs() * half.y + e.y.abs() * half.x >= 0.0
        })
    }
}

impl Pieces {
    /// One piece over the whole image; `bundle` is centred on the image's middle.
    pub fn whole(bundle: Bundle, width: u32, height: u32) -> Pieces {
        Pieces::new(vec![Piece::whole(bundle, (width, height))], width, height)
    }

    pub fn new(pieces: Vec<Piece>, width: u32, height: u32) -> Pieces {
        let mut tiles = pieces_near_tiles(&pieces, width.div_ceil(TILE), height.div_ceil(TILE));
        let crowded = parallel::flat_map(0..tiles.start.len() - 1, |k| Some((k, boxes_over(&pieces, tiles.near(k))?)));
        tiles.crowded = crowded.into_iter().collect();
        let (size, sample) = ((width, height), DVec2::splat(0.5));
        Pieces { pieces, size, tiles: Arc::new(tiles), sample, stacked: None, turned: None }
    }

    /// Pieces of a viewer at `eye` with the axes of `view`, from those for a viewer at the origin with the world's axes.
    pub fn turned_by(view: View, eye: DVec3, unturned: Vec<Piece>, (width, height): (u32, u32)) -> Pieces {
        let is_it = |known: &Pieces| known.size == (width, height) && known.pieces == unturned;
        let unturned = UNTURNED.or_make(is_it, || Pieces::new(unturned.clone(), width, height));
        let turned = |v: DVec3| view.vector(v.x, v.y, v.z);
        let bundle = |Bundle { p, d, h }: &Bundle| Bundle {
            p: [0, 1, 2].map_each(|k| h[k] * eye + turned(p[k])),
            d: d.map_each(turned),
            h: *h,
        };
        let pieces = unturned.pieces.iter().map(|piece| Piece { bundle: bundle(&piece.bundle), ..piece.clone() });
        Pieces {
            pieces: pieces.collect(),
            size: unturned.size,
            tiles: unturned.tiles.clone(),
            sample: unturned.sample,
            stacked: None,
            turned: eye.is_finite().then_some(TurnedPieces { unturned, eye, view }),
        }
    }

    /// The pieces in their viewer's frame and its pose, if these have a viewer.
    pub fn turned(&self) -> Option<&TurnedPieces> {
        self.turned.as_ref()
    }

    /// One piece over the whole image, for a viewer at `eye` with the axes of `view`; `bundle` is in the viewer's frame.
    pub fn whole_turned_by(view: View, eye: DVec3, bundle: Bundle, size: (u32, u32)) -> Pieces {
        Pieces::turned_by(view, eye, vec![Piece::whole(bundle, size)], size)
    }

    /// Images of `rows` rows, one below another, `step` rows from each to the next. Their samples are at pixel centres. Numbers of pieces go
    /// on from image to image; [`Piece::centre_px`] and [`Piece::corners_px`] are places in the piece's own image.
    pub(super) fn stacked(images: Vec<Pieces>, rows: u32, step: u32) -> Pieces {
        let (mut pieces, mut first) = (Vec::new(), Vec::new());
        for image in &images {
            first.push(pieces.len() as u32);
            pieces.extend_from_slice(&image.pieces);
        }
        let stacked = Some(Arc::new(StackedPieces { stack: Stack { images, step }, rows, first }));
        Pieces { pieces, size: (0, 0), tiles: Arc::default(), sample: DVec2::splat(0.5), stacked, turned: None }
    }

    pub(super) fn with_sample(&self, x: f64, y: f64) -> Pieces {
        // those in the viewer's frame have other samples
        Pieces { sample: DVec2::new(x, y), turned: None, ..self.clone() }
    }

    /// The piece that owns all of the image that row `j` lies in, and the rows from `j` to that image's end; `None`: there are several.
    pub fn sole_from(&self, j: u32) -> Option<(u32, u32)> {
        if let Some(stacked) = &self.stacked {
            let (image, first, row) = stacked.at(j)?;
            return image.pieces[0].corners_px.is_none().then_some((first, stacked.rows - row));
        }
        self.pieces[0].corners_px.is_none().then_some((0, u32::MAX))
    }

    /// A row in the middle of an image in the middle, of several.
    pub(super) fn middle_row(&self) -> Option<u32> {
        let stacked = self.stacked.as_ref()?;
        let middle = stacked.stack.images.len() / 2;
        Some(middle as u32 * stacked.stack.step + stacked.rows / 2)
    }

    /// A piece's number in its own image.
    pub fn number_in_image(&self, piece: u32) -> u32 {
        self.stacked.as_ref().map_or(piece, |stacked| stacked.of_piece(piece).1)
    }

    /// The number of a pixel's tile.
    fn tile(&self, i: u32, j: u32) -> usize {
        (j / TILE * self.size.0.div_ceil(TILE) + i / TILE) as usize
    }

    /// Whether the pieces have the same image triangles as those of `other`, in the same order, so that they own the same pixels. `false` for
    /// stacked images.
    pub fn own_alike(&self, other: &Pieces) -> bool {
        let is_one = self.stacked.is_none() && other.stacked.is_none();
        is_one
            && (self.size, self.sample) == (other.size, other.sample)
            && self.pieces.iter().map(|piece| piece.corners_px).eq(other.pieces.iter().map(|piece| piece.corners_px))
    }

    /// The image place (px) of the ray of pixel `(i, j)`.
    pub fn place(&self, i: u32, j: u32) -> DVec2 {
        DVec2::new(i as f64, j as f64) + self.sample
    }

    pub fn owner(&self, i: u32, j: u32) -> Option<u32> {
        self.owner_at_offset(i, j, DVec2::ZERO)
    }

    /// The owner of the place at `offset` px from the sample of pixel `(i, j)`, within that pixel.
    pub fn owner_at_offset(&self, i: u32, j: u32, offset: DVec2) -> Option<u32> {
        if let Some(stacked) = &self.stacked {
            let (image, first, row) = stacked.at(j)?;
            return image.owner_at_offset(i, row, self.sample - image.sample + offset).map(|k| first + k);
        }
        self.owner_of_place(i, j, DVec2::new(i as f64, j as f64) + (self.sample + offset))
    }

    /// The piece that owns an image place (px) up to [`super::SAFE_RADIUS_PX`] from the sample of pixel `(i, j)`.
    pub fn owner_of_place(&self, i: u32, j: u32, place_px: DVec2) -> Option<u32> {
        if let Some(stacked) = &self.stacked {
            let (image, first, row) = stacked.at(j)?;
            let top = DVec2::new(0.0, f64::from(j - row));
            return image.owner_of_place(i, row, place_px - top).map(|k| first + k);
        }
        let tile = self.tile(i, j);
        let near = self.tiles.near(tile);
        let contains = |k: &u32| self.pieces[*k as usize].contains(place_px);
        match self.tiles.crowded.get(&tile) {
            Some(boxes) => boxes.first(place_px, &|n| Some(near[n]).filter(contains)),
            _ => near.iter().copied().find(contains),
        }
    }

    /// The piece that owns an image place (px), of one image.
    pub fn owner_at(&self, place_px: DVec2) -> Option<u32> {
        // a place on or beyond a border is looked up with the pixel beside it; a cast saturates at 0
        let pixel = |at: f64, size: u32| (at as u32).min(size - 1);
        self.owner_of_place(pixel(place_px.x, self.size.0), pixel(place_px.y, self.size.1), place_px)
    }

    /// Piece `k`'s bundle, centred on the sample of pixel `(i, j)`.
    pub fn bundle_at(&self, k: u32, i: u32, j: u32) -> Bundle {
        self.bundle_at_place(k, self.place(i, j))
    }

    /// Piece `k`'s bundle, centred on an image place in pixels.
    pub fn bundle_at_place(&self, k: u32, place_px: DVec2) -> Bundle {
        if let Some(stacked) = &self.stacked {
            let (image, piece) = stacked.of_piece(k);
            let top = DVec2::new(0.0, f64::from(image as u32 * stacked.stack.step));
            return stacked.stack.images[image].bundle_at_place(piece, place_px - top);
        }
        let piece = &self.pieces[k as usize];
        let offset = place_px - piece.centre_px;
        piece.bundle.recentred(offset.x, offset.y)
    }

    /// See [`super::Camera::near`].
    pub(super) fn near(&self, i: u32, j: u32, radius_px: f64) -> (Vec<Bundle>, bool) {
        if let Some(stacked) = &self.stacked {
            return stacked.at(j).map_or((Vec::new(), true), |(image, _, row)| image.near(i, row, radius_px));
        }
        let q = self.place(i, j);
        let owner = self.owner(i, j);
        let half = DVec2::splat(radius_px);
        let mut bundles: Vec<Bundle> = owner.iter().map(|&k| self.bundle_at(k, i, j)).collect();
        let mut covered = 0.0;
        for &k in self.tiles.near(self.tile(i, j)) {
            let piece = &self.pieces[k as usize];
            if piece.reaches(q, half) {
                covered += clipped_area(piece, q, half);
                if owner != Some(k) {
                    bundles.push(self.bundle_at(k, i, j));
                }
            }
        }
        let area = 4.0 * radius_px * radius_px;
        (bundles, covered < area * (1.0 - AREA_ROUNDING))
    }
}

/// Relative rounding of the summed areas of [`clipped_area`] at image places up to 2^16 px: a place rounds to 2^-37 px
/// there, which is 2^-33 of the box's side of 1/8 px; some ten such terms a polygon.
const AREA_ROUNDING: f64 = 1.0 / (1u64 << 28) as f64;

/// The part of a convex polygon in the box `lo..hi` (Sutherland and Hodgman).
pub(super) fn clip(mut polygon: Vec<DVec2>, lo: DVec2, hi: DVec2) -> Vec<DVec2> {
    for (axis, limit) in [(DVec2::X, hi.x), (DVec2::NEG_X, -lo.x), (DVec2::Y, hi.y), (DVec2::NEG_Y, -lo.y)] {
        let depth = |q: DVec2| limit - axis.dot(q);
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (k, &b) in polygon.iter().enumerate() {
            let a = polygon[(k + polygon.len() - 1) % polygon.len()];
            if (depth(a) >= 0.0) != (depth(b) >= 0.0) {
                kept.push(a + (b - a) * (depth(a) / (depth(a) - depth(b))));
            }
            if depth(b) >= 0.0 {
                kept.push(b);
            }
        }
        polygon = kept;
    }
    polygon
}

/// The area (px^2) of the piece inside the box about `centre`.
fn clipped_area(piece: &Piece, centre: DVec2, half: DVec2) -> f64 {
    let Some(corners) = piece.corners_px else { return 4.0 * half.x * half.y };
    let polygon = clip(corners.iter().map(|c| *c - centre).collect(), -half, half);
    let twice: f64 = (0..polygon.len()).map(|k| polygon[k].perp_dot(polygon[(k + 1) % polygon.len()])).sum();
    twice.abs() / 2.0
}

/// The hierarchy over the pieces near a tile, if they are many.
fn boxes_over(pieces: &[Piece], near: &[u32]) -> Option<Boxes> {
    let everywhere = (DVec2::NEG_INFINITY, DVec2::INFINITY);
    let bounds = |k: &u32| pieces[*k as usize].corners_px.as_ref().map_or(everywhere, around_triangle);
    (near.len() >= MANY).then(|| Boxes::new(near.iter().map(bounds), RUN))
}

/// For every tile, row by row, the pieces that may come within [`TILE_REACH_PX`] of it, as offsets and a list.
fn pieces_near_tiles(pieces: &[Piece], tiles_x: u32, tiles_y: u32) -> Tiles {
    let count = (tiles_x * tiles_y) as usize;
    if let [Piece { corners_px: None, .. }] = pieces {
        return Tiles { start: (0..=count as u32).collect(), pieces: vec![0; count], ..Tiles::default() };
    }
    let mut pairs: Vec<(u32, u32)> = parallel::flat_map(0..pieces.len(), |k| {
        tiles_near(&pieces[k], tiles_x, tiles_y).map(move |(x, y)| (y * tiles_x + x, k as u32))
    });
    parallel::sort(&mut pairs);
    let mut start = vec![0u32; count + 1];
    for &(tile, _) in &pairs {
        start[tile as usize + 1] += 1;
    }
    for k in 0..count {
        start[k + 1] += start[k];
    }
    Tiles { start, pieces: pairs.into_iter().map(|(_, piece)| piece).collect(), ..Tiles::default() }
}

/// Columns and rows of the tiles within [`TILE_REACH_PX`] of the piece.
fn tiles_near(piece: &Piece, tiles_x: u32, tiles_y: u32) -> impl Iterator<Item = (u32, u32)> + '_ {
    let side_px = TILE as f64;
    let half = DVec2::splat(side_px / 2.0 + TILE_REACH_PX);
    let corners = piece.corners_px.unwrap_or([DVec2::ZERO; 3]);
    let range = move |lo: f64, hi: f64, n: u32| {
        let first = ((lo - TILE_REACH_PX) / side_px).floor().clamp(0.0, n as f64) as u32;
        first..(((hi + TILE_REACH_PX) / side_px).floor() + 1.0).clamp(first as f64, n as f64) as u32
    };
    let (lo, hi) = around(&corners);
    let rows = range(lo.y, hi.y, tiles_y);
    rows.flat_map(move |y| {
        // a long oblique piece reaches few tiles of its box
        let top = y as f64 * side_px - TILE_REACH_PX;
        let (lo, hi) = span_between(&corners, top, top + side_px + 2.0 * TILE_REACH_PX);
        range(lo, hi, tiles_x).map(move |x| (x, y))
    })
    .filter(move |&(x, y)| piece.reaches(DVec2::new(x as f64 + 0.5, y as f64 + 0.5) * side_px, half))
}

/// Bound on the rounding of a place on an edge, relative to the largest coordinate: seven roundings, each half an epsilon.
const SPAN_ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Bounds on x of the part of a triangle between two heights; (inf, -inf) if there is none.
fn span_between(corners: &[DVec2; 3], top: f64, bottom: f64) -> (f64, f64) {
    let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut include = |x: f64| (lo, hi) = (lo.min(x), hi.max(x));
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        if top <= a.y && a.y <= bottom {
            include(a.x);
        }
        for y in [top, bottom].into_iter().filter(|y| (a.y < *y) != (b.y < *y)) {
            include(a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y)));
        }
    }
    let tolerance =
        SPAN_ROUNDING * corners.iter().fold(top.abs().max(bottom.abs()), |m, q| m.max(q.abs().max_element()));
    (lo - tolerance, hi + tolerance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_tile_that_a_piece_reaches_is_listed(corners in prop::array::uniform6(-40.0f64..140.0), thin in 0.0f64..1.0) {
            let q = [0, 2, 4].map(|k| DVec2::new(corners[k], corners[k + 1]));
            // down to slivers
            let q = [q[0], q[1], q[1] + thin.powi(6) * (q[2] - q[1])];
            let bundle = Bundle { p: [DVec3::ZERO; 3], d: [DVec3::Z; 3], h: [1.0, 0.0, 0.0] };
            let piece = Piece { bundle, centre_px: DVec2::ZERO, corners_px: Some(q) };
            let half = DVec2::splat(TILE as f64 / 2.0 + TILE_REACH_PX);
            let reached = |x: u32, y: u32| piece.reaches(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5) * TILE as f64, half);
            let all: Vec<(u32, u32)> = (0..12).flat_map(|y| (0..13).map(move |x| (x, y))).filter(|t| reached(t.0, t.1)).collect();
            prop_assert_eq!(tiles_near(&piece, 13, 12).collect::<Vec<_>>(), all);
        }
    }
}
