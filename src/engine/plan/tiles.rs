//! Tiles of 8 x 8 pixels, split into cells: the pixels of one tile that one piece owns. Each slab has its own tiles.

use super::cells::{Part, cells_of};
use super::curves::{CurveTable, Net, nets};
use super::fit::Fit;
use super::nodes::{Nodes, WidthMeasure, above_cells};
use super::slabs::Slabs;
use crate::arrays::MapEach;
use crate::camera::TILE;
use crate::camera::{Bundle, Camera, Curve, Field, Pieces, Rays};
use crate::gpu::layout::{self, split2};
use crate::parallel;
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// The tiles of one band.
#[derive(Debug, Clone, Default)]
pub struct Tiles {
    pub tiles_x: u32,
    /// Rows of all slabs.
    pub tiles_y: u32,
    /// Rows from one slab to the next.
    pub slab_rows: u32,
    /// `cells[start[k] .. start[k + 1]]` are the cells of tile k.
    pub start: Vec<u32>,
    pub cells: Vec<layout::Cell>,
    /// Where pixels have samples: of each cell the pixels that have any sample there, those that have all, and those that have
    /// each; low word first.
    pub cell_samples: Vec<[u32; 2]>,
    /// The pieces of the band, in order of first use; each carries its number in the camera.
    pub pieces: Vec<layout::Piece>,
    /// Pixels that have a ray, summed over all slabs.
    pub rays: u64,
}

impl Tiles {
    /// The pixels of a cell of a piece.
    fn pixels(&self, cell: usize) -> CellPixels {
        let masks = self.cell_samples.len() / self.cells.len();
        let mask = |[low, high]: &[u32; 2]| u64::from(*high) << 32 | u64::from(*low);
        // behind the pixels with any sample and those with all
        let samples = self.cell_samples[cell * masks..(cell + 1) * masks].iter().skip(2).map(mask).collect();
        let layout::Cell { piece, mask_lo, mask_hi, .. } = self.cells[cell];
        CellPixels { piece: self.pieces[piece as usize].number, mask: mask(&[mask_lo, mask_hi]), samples }
    }
}

/// A ray of a tile: its place in [-1, 1]^2 over the tile, origin relative to the anchor and direction.
#[derive(Debug, Clone, Copy)]
pub struct TileRay {
    pub place: DVec2,
    pub p: DVec3,
    pub d: DVec3,
}

/// Rays by which a tile is bounded.
#[derive(Debug, Clone, Default)]
pub struct TileRays {
    pub rays: Vec<TileRay>,
    /// How far the tile's rays deviate from the affine fit between these rays: origins (`r_p`) and directions (`r_d`). For a curve,
    /// `r_p` includes its distance from the chord.
    pub r_p: f64,
    pub r_d: f64,
}

/// Half of a tile from its centre to the outermost pixel centre, px.
const TILE_REACH: f64 = (TILE as f64 - 1.0) / 2.0;

/// A cell before its bundle is stored.
#[derive(Debug, Clone, PartialEq, Eq)]
struct CellPixels {
    /// Of the layer.
    piece: u32,
    /// The pixels whose centres it owns.
    mask: u64,
    /// And those of which it owns each sample.
    samples: Vec<u64>,
}

impl CellPixels {
    /// The part of it in some pixels.
    fn within(&self, mask: u64) -> CellPixels {
        let samples = self.samples.iter().map(|s| s & mask).collect();
        CellPixels { piece: self.piece, mask: self.mask & mask, samples }
    }

    /// The pixels of which it owns any place.
    fn any(&self) -> u64 {
        self.samples.iter().fold(self.mask, |any, s| any | s)
    }

    /// And those of which it owns all.
    fn all(&self) -> u64 {
        self.samples.iter().fold(self.mask, |all, s| all & s)
    }
}

/// The cells of a tile.
type TileCells = Vec<CellPixels>;

/// What bounds all rays of a tile, and, where straight ones are in several cells, each cell's.
#[derive(Debug, Default)]
pub struct TileFits {
    pub whole: Fit,
    pub each: Vec<Fit>,
    /// The piece that owns all pixels of the tile, if the camera is one layer of pieces: its place in [`Tiles::pieces`].
    pub sole_piece: Option<u32>,
}

impl From<Fit> for TileFits {
    /// The bounds of a tile with one cell at most.
    fn from(whole: Fit) -> TileFits {
        TileFits { whole, each: Vec::new(), sole_piece: None }
    }
}

/// Splits rows `row .. row + rows` of an image into tiles.
#[derive(Clone, Copy)]
pub struct Tiler<'a> {
    pub camera: &'a Camera,
    pub slabs: Slabs,
    pub curves: Option<&'a CurveTable>,
    /// Where samples lie about their pixel's centre, px.
    pub sample_offsets: &'a [DVec2],
    pub anchor: DVec3,
    pub row: u32,
    pub rows: u32,
}

/// A tile of a layer, and the span of t that its slab holds.
#[derive(Clone, Copy)]
struct Place {
    layer: usize,
    span: [f64; 2],
    /// Column and row in the image, tiles.
    x: u32,
    y: u32,
}

impl Tiler<'_> {
    /// The tiles; and the rays that bound each and its cells.
    pub fn tiles(&self) -> (Tiles, Vec<TileFits>) {
        let is_sole_layer = self.curves.is_none() && matches!(self.camera.layers.as_slice(), [Rays::Pieces(_)]);
        let tiles_x = self.camera.width.div_ceil(TILE);
        let slab_rows = self.slabs.tile_rows(self.rows);
        let tiles_y = slab_rows * self.slabs.count();
        let place = |k: u32| {
            let (slab, y) = (k / tiles_x / slab_rows, k / tiles_x % slab_rows);
            let (layer, span) = self.slabs.of_slab(slab);
            (y < self.rows.div_ceil(TILE)).then(|| Place { layer, span, x: k % tiles_x, y: self.row / TILE + y })
        };
        let places: Vec<Option<Place>> = (0..tiles_x * tiles_y).map(place).collect();
        let nets = self.curves.map(|table| nets(table, tiles_x));
        let bounded = |place: &Option<Place>| {
            let (Some(place), Some(nets)) = (place, &nets) else {
                return place.map_or_else(Default::default, |p| self.straight(p));
            };
            let tile = (place.layer as u32 * self.rows.div_ceil(TILE) + place.y - self.row / TILE) * tiles_x + place.x;
            let over = |net: &Net| net.over(place.span, self.anchor);
            let whole = nets[tile as usize].as_ref().map_or_else(Fit::default, |net| Fit::of(&over(net)));
            self.curved(*place, whole)
        };
        let (owned, mut bounds): (Vec<TileCells>, Vec<TileFits>) = parallel::map(&places, bounded).into_iter().unzip();
        let mut tiles = Tiles { tiles_x, tiles_y, slab_rows, start: vec![0], ..Default::default() };
        let mut node_of_cell = above_cells(tiles_x, tiles_y);
        let mut local = std::collections::HashMap::new();
        for (((k, place), owned), bounds) in (0u32..).zip(&places).zip(&owned).zip(&mut bounds) {
            for (place, share) in place.iter().flat_map(|p| owned.iter().map(move |c| (p, c))) {
                let piece = share.piece;
                let number = self.camera.first_piece(place.layer) + piece;
                let index = match &self.camera.layers[place.layer] {
                    Rays::Pieces(pieces) if self.curves.is_none() => *local.entry(number).or_insert_with(|| {
                        tiles.pieces.push(self.piece_at(pieces, piece, *place));
                        tiles.pieces.len() as u32 - 1
                    }),
                    _ => number,
                };
                let node = if bounds.each.is_empty() { k } else { node_of_cell };
                node_of_cell += u32::from(node != k);
                tiles.cells.push(layout::Cell { tile: k, node, ..self.cell_at(share, index, *place) });
                if is_sole_layer && owned.len() == 1 && share.mask == self.all_pixels(*place) {
                    bounds.sole_piece = Some(index);
                }
                if !self.sample_offsets.is_empty() {
                    let masks = [share.any(), share.all()].into_iter().chain(share.samples.iter().copied());
                    tiles.cell_samples.extend(masks.map(|m| [m as u32, (m >> 32) as u32]));
                }
            }
            tiles.start.push(tiles.cells.len() as u32);
        }
        let pixels = |cell: &layout::Cell| u64::from(cell.mask_lo.count_ones() + cell.mask_hi.count_ones());
        tiles.rays = tiles.cells.iter().map(pixels).sum();
        (tiles, bounds)
    }

    /// Returns the tiles and the tree of bounds over them; `known`: pieces, and the tiles of an earlier pose or lens whose pieces own the same
    /// image places.
    pub fn tiles_and_nodes(&self, known: Option<(&Pieces, &Tiles)>, measure: WidthMeasure) -> (Arc<Tiles>, Arc<Nodes>) {
        let (tiles, nodes) = match known {
            Some((pieces, known)) => {
                let tiles = self.moved(pieces, known);
                let nodes = Nodes::new(|k| self.fits(pieces, &tiles, k), (tiles.tiles_x, tiles.tiles_y), measure);
                (tiles, nodes)
            }
            None => {
                let (tiles, fits) = self.tiles();
                let nodes = Nodes::new(|k| &fits[k], (tiles.tiles_x, tiles.tiles_y), measure);
                (tiles, nodes)
            }
        };
        (Arc::new(tiles), Arc::new(nodes))
    }

    /// Returns `known`, the tiles of an earlier pose, with the bundles of this pose. Each piece must own the same image places in both.
    pub fn moved(&self, pieces: &Pieces, known: &Tiles) -> Tiles {
        let number = |cell: &layout::Cell| known.pieces[cell.piece as usize].number;
        let cell = |cell: &layout::Cell| {
            with_bundle(*cell, &self.bundle(pieces, number(cell), self.place(cell.tile, known.tiles_x)))
        };
        let piece = |&layout::Piece { number, origin_x, origin_y, .. }: &layout::Piece| {
            let bundle = pieces.bundle_at(number, origin_x as u32, origin_y as u32 + self.row);
            packed_piece(&bundle, self.anchor, [origin_x, origin_y], number)
        };
        Tiles {
            cells: parallel::map(&known.cells, cell),
            pieces: parallel::map(&known.pieces, piece),
            start: known.start.clone(),
            cell_samples: known.cell_samples.clone(),
            ..*known
        }
    }

    /// Returns the bounds of the rays of a tile, for a camera that is one layer of pieces.
    fn fits(&self, pieces: &Pieces, tiles: &Tiles, tile: usize) -> TileFits {
        let at = self.place(tile as u32, tiles.tiles_x);
        let cells = tiles.start[tile] as usize..tiles.start[tile + 1] as usize;
        let owned: TileCells = cells.clone().map(|cell| tiles.pixels(cell)).collect();
        let sole_piece = match owned.as_slice() {
            [share] if share.mask == self.all_pixels(at) => Some(tiles.cells[cells.start].piece),
            _ => None,
        };
        TileFits { sole_piece, ..self.fits_of_pieces(at, pieces, &owned) }
    }

    /// The place of a tile, by its number, for a camera with one slab.
    fn place(&self, tile: u32, tiles_x: u32) -> Place {
        Place { layer: 0, span: self.slabs.of_slab(0).1, x: tile % tiles_x, y: self.row / TILE + tile / tiles_x }
    }

    /// The cells of a tile of curves, and what bounds them: where their chords jump, as at the border of two cameras of a composite, the
    /// curves on either side.
    fn curved(&self, at: Place, whole: Fit) -> (TileCells, TileFits) {
        let owned = self.owned(at);
        let (Some(table), [share]) = (self.curves, owned.as_slice()) else {
            return (owned, whole.into());
        };
        if !whole.is_loose() {
            return (owned, whole.into());
        }
        let curve = |bit: u32| {
            let (x, y) = (bit % TILE, bit / TILE);
            let curve = table.get(at.layer, at.x * TILE + x, at.y * TILE + y)?.1;
            Some((place_in_tile(x, y), curve))
        };
        let chord = |(place, curve): (DVec2, Curve)| {
            let part = curve.span(at.span);
            let (start, end) = (part.points()[0], part.points()[part.degree()]);
            TileRay { place, p: start - self.anchor, d: end - start }
        };
        let parts = cells_of(Part { mask: share.mask, rays: bits(share.mask).filter_map(curve).map(chord).collect() });
        if parts.len() < 2 {
            return (owned, whole.into());
        }
        let fit = |part: &Part| {
            let net = Net::of(bits(part.mask).filter_map(curve));
            net.map_or_else(Fit::default, |net| Fit::of(&net.over(at.span, self.anchor)))
        };
        let cells = parts.iter().map(|part| share.within(part.mask)).collect();
        (cells, TileFits { each: parts.iter().map(fit).collect(), ..whole.into() })
    }

    /// The cells of a tile of straight rays, and what bounds them.
    fn straight(&self, at: Place) -> (TileCells, TileFits) {
        if let (Rays::Field(field), true) = (&self.camera.layers[at.layer], self.sample_offsets.is_empty()) {
            return self.of_field(at, field);
        }
        let owned = self.owned(at);
        match &self.camera.layers[at.layer] {
            Rays::Pieces(pieces) => {
                let fits = self.fits_of_pieces(at, pieces, &owned);
                (owned, fits)
            }
            Rays::Field(field) => {
                let fit = |owned: &[CellPixels]| Fit::of(&self.rays_of_field(at, field, owned));
                let whole = fit(&owned);
                let owned = match owned.as_slice() {
                    // of sorted rays no split leaves any nearer to each other
                    [share] if !field.is_reordered => self.discontinuous(at, share, field),
                    _ => owned,
                };
                let each = match owned.len() {
                    0 | 1 => Vec::new(),
                    _ => owned.iter().map(|share| fit(std::slice::from_ref(share))).collect(),
                };
                (owned, TileFits { each, ..whole.into() })
            }
            Rays::Curves(_) => (owned, TileFits::default()),
        }
    }

    /// Returns the bounds of the rays of a tile of pieces, and of the rays of each cell if the tile has several.
    fn fits_of_pieces(&self, at: Place, pieces: &Pieces, owned: &[CellPixels]) -> TileFits {
        let fit = |owned: &[CellPixels]| Fit::of(&self.rays_of_pieces(at, pieces, owned));
        let of_cell = |share: &CellPixels| {
            let bundle = self.bundle(pieces, share.piece, at);
            // a few pixels, as along a border, have tighter bounds than their piece has over the whole tile
            let is_narrow = share.any().count_ones() <= TILE && owned.len() > 1;
            match has_one_weight(&bundle) && !is_narrow {
                true => Fit::of_bundle(&bundle, TILE as f64 / 2.0),
                false => fit(std::slice::from_ref(share)),
            }
        };
        match owned {
            [] => TileFits::default(),
            [share] => of_cell(share).into(),
            _ => TileFits { each: owned.iter().map(of_cell).collect(), ..fit(owned).into() },
        }
    }

    /// The same of a field's rays through pixel centres alone, each of which is asked for once.
    fn of_field(&self, at: Place, field: &Field) -> (TileCells, TileFits) {
        let (left, top) = (at.x * TILE, at.y * TILE);
        let (columns, rows) = self.tile_size(at);
        let mut mask = 0;
        let mut rays = Vec::with_capacity((TILE * TILE) as usize);
        let mut take = |x: u32, y: u32, (p, d): (DVec3, DVec3)| {
            mask |= 1u64 << (y * TILE + x);
            rays.push(TileRay { place: place_in_tile(x, y), p: p - self.anchor, d });
        };
        let lens = field.unturned_rays();
        for y in 0..rows {
            match lens.map(|lens| lens.directions_of_row(top + y)) {
                Some(directions) => {
                    let own = (0..).zip(&directions[left as usize..(left + columns) as usize]);
                    own.filter(|(_, d)| **d != DVec3::ZERO).for_each(|(x, d)| take(x, y, (DVec3::ZERO, *d)));
                }
                None => (0..columns)
                    .filter_map(|x| Some((x, field.ray(left + x, top + y)?)))
                    .for_each(|(x, ray)| take(x, y, ray)),
            }
        }
        if mask == 0 {
            return Default::default();
        }
        let share = CellPixels { piece: 0, mask, samples: Vec::new() };
        let tile = TileRays { rays, ..TileRays::default() };
        let whole = Fit::of(&tile);
        // of sorted rays no split leaves any nearer to each other
        if field.is_reordered || !whole.is_loose() {
            return (vec![share], whole.into());
        }
        let parts = cells_of(Part { mask, rays: tile.rays });
        let owned = parts.iter().map(|part| share.within(part.mask)).collect();
        let fit = |part: Part| Fit::of(&TileRays { rays: part.rays, ..TileRays::default() });
        let each = if parts.len() > 1 { parts.into_iter().map(fit).collect() } else { Vec::new() };
        (owned, TileFits { each, ..whole.into() })
    }

    /// The pixels of a tile of a field in parts, each pixel where a ray of it belongs.
    fn discontinuous(&self, at: Place, share: &CellPixels, field: &Field) -> TileCells {
        let one_each = |bit: u32| {
            let (x, y) = (bit % TILE, bit / TILE);
            let (i, j) = (at.x * TILE + x, at.y * TILE + y);
            let offset = || self.sample_offsets.iter().find_map(|place| field.ray_at_offset(i, j, *place));
            let (p, d) = field.ray(i, j).or_else(offset)?;
            Some(TileRay { place: place_in_tile(x, y), p: p - self.anchor, d })
        };
        let rays = bits(share.any()).filter_map(one_each).collect();
        cells_of(Part { mask: share.any(), rays }).iter().map(|part| share.within(part.mask)).collect()
    }

    /// Columns and rows of a tile that lie in the band.
    fn tile_size(&self, at: Place) -> (u32, u32) {
        ((self.camera.width - at.x * TILE).min(TILE), (self.row + self.rows - at.y * TILE).min(TILE))
    }

    /// The pixels of a tile that lie in the band.
    fn all_pixels(&self, at: Place) -> u64 {
        let (columns, rows) = self.tile_size(at);
        let row = (1u64 << columns) - 1;
        (0..rows).fold(0, |mask, j| mask | row << (TILE * j))
    }

    /// Which pixels of a tile each piece owns, by ascending piece.
    fn owned(&self, at: Place) -> TileCells {
        let (left, top) = (at.x * TILE, at.y * TILE);
        let (columns, rows) = self.tile_size(at);
        let pixels = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
        let bit = |(x, y): (u32, u32)| 1u64 << (y * TILE + x);
        let layer = &self.camera.layers[at.layer];
        if let (Rays::Pieces(p), None) = (layer, self.curves)
            && let Some((piece, rows)) = p.sole_from(top)
        {
            let mask = pixels.filter(|(_, y)| *y < rows).map(bit).fold(0, |m, b| m | b);
            return vec![CellPixels { piece, mask, samples: vec![mask; self.sample_offsets.len()] }];
        }
        let mut cells: TileCells = Vec::new();
        let none = |piece: u32| CellPixels { piece, mask: 0, samples: vec![0; self.sample_offsets.len()] };
        for (x, y) in pixels {
            let (i, j) = (left + x, top + y);
            let owner = match (self.curves, layer) {
                (Some(table), _) => table.get(at.layer, i, j).map(|(piece, _)| piece),
                (None, Rays::Pieces(p)) => p.owner(i, j),
                (None, Rays::Field(f)) => f.ray(i, j).map(|_| 0),
                (None, Rays::Curves(_)) => None,
            };
            if let Some(piece) = owner {
                share_of(&mut cells, piece, none).mask |= bit((x, y));
            }
            for (n, place) in self.sample_offsets.iter().enumerate() {
                let owner = match layer {
                    Rays::Pieces(p) => p.owner_at_offset(i, j, *place),
                    Rays::Field(f) => f.ray_at_offset(i, j, *place).map(|_| 0),
                    Rays::Curves(_) => None,
                };
                if let Some(piece) = owner {
                    share_of(&mut cells, piece, none).samples[n] |= bit((x, y));
                }
            }
        }
        cells.sort_unstable_by_key(|c| c.piece);
        cells
    }

    /// The ray of each pixel of some cells of a field, and those of its samples.
    fn rays_of_field(&self, at: Place, field: &Field, owned: &[CellPixels]) -> TileRays {
        let ray = |(bit, offset): (u32, DVec2)| {
            let (x, y) = (bit % TILE, bit / TILE);
            let (i, j) = (at.x * TILE + x, at.y * TILE + y);
            let (p, d) = if offset == DVec2::ZERO { field.ray(i, j)? } else { field.ray_at_offset(i, j, offset)? };
            let place = place_in_tile(x, y) + offset / (TILE as f64 / 2.0);
            Some(TileRay { place, p: p - self.anchor, d })
        };
        let all = owned.iter().flat_map(|share| self.places(share, share.mask));
        TileRays { rays: all.filter_map(ray).collect(), ..TileRays::default() }
    }

    /// The ray of each pixel of some cells of pieces, and the rays of its samples. An affine cell without samples needs only the outermost pixels of
    /// each row: the others lie between them.
    fn rays_of_pieces(&self, at: Place, pieces: &Pieces, owned: &[CellPixels]) -> TileRays {
        let mut rays = Vec::new();
        for share in owned {
            let bundle = self.bundle(pieces, share.piece, at);
            let is_affine = has_one_weight(&bundle) && share.samples.is_empty();
            let mask = if is_affine { row_ends(share.mask) } else { share.mask };
            rays.extend(self.places(share, mask).map(|(bit, offset)| {
                let place = DVec2::new(f64::from(bit % TILE), f64::from(bit / TILE)) - TILE_REACH + offset;
                let ray = bundle.ray(place.x, place.y);
                TileRay { place: place / (TILE as f64 / 2.0), p: ray.origin, d: ray.direction }
            }));
        }
        TileRays { rays, ..TileRays::default() }
    }

    /// The pixels of a mask, and the samples of a cell by their pixel and offset.
    fn places<'a>(&'a self, share: &'a CellPixels, mask: u64) -> impl Iterator<Item = (u32, DVec2)> + 'a {
        let sampled = share.samples.iter().zip(self.sample_offsets);
        let offsets = sampled.flat_map(|(mask, place)| bits(*mask).map(move |bit| (bit, *place)));
        bits(mask).map(|bit| (bit, DVec2::ZERO)).chain(offsets)
    }

    /// The rays of a piece about the centre of a tile, relative to the anchor.
    fn bundle(&self, pieces: &Pieces, piece: u32, at: Place) -> Bundle {
        // the mean of the tile's sample places
        let centre = pieces.place(at.x * TILE, at.y * TILE) + TILE_REACH;
        rebased(&pieces.bundle_at_place(piece, centre), self.anchor)
    }

    /// A cell of a tile and a node yet to be named.
    fn cell_at(&self, &CellPixels { piece, mask, .. }: &CellPixels, index: u32, at: Place) -> layout::Cell {
        let cell = layout::Cell {
            p: [0.0; 3],
            h: 1.0,
            d: [0.0; 3],
            piece: index,
            tile: layout::NONE,
            mask_lo: mask as u32,
            mask_hi: (mask >> 32) as u32,
            node: layout::NONE,
        };
        match (&self.camera.layers[at.layer], self.curves) {
            (Rays::Pieces(pieces), None) => with_bundle(cell, &self.bundle(pieces, piece, at)),
            _ => cell,
        }
    }

    /// A piece about the first pixel of a tile.
    fn piece_at(&self, pieces: &Pieces, piece: u32, at: Place) -> layout::Piece {
        let (x, y) = (at.x * TILE, at.y * TILE);
        let number = self.camera.first_piece(at.layer) + pieces.number_in_image(piece);
        packed_piece(&pieces.bundle_at(piece, x, y), self.anchor, [x as f32, (y - self.row) as f32], number)
    }
}

/// As kernels read it: a bundle that is centred on a pixel.
pub fn packed_piece(bundle: &Bundle, anchor: DVec3, [origin_x, origin_y]: [f32; 2], number: u32) -> layout::Piece {
    let mut packed = layout::Piece { origin_x, origin_y, number, ..bytemuck::Zeroable::zeroed() };
    let b = rebased(bundle, anchor);
    let v = |v: DVec3| {
        let s = v.to_array().map_each(split2);
        (s.map_each(|s| s[0]), s.map_each(|s| s[1]))
    };
    (packed.p_hi, packed.p_lo) = v(b.p[0]);
    (packed.px_hi, packed.px_lo) = v(b.p[1]);
    (packed.py_hi, packed.py_lo) = v(b.p[2]);
    (packed.d_hi, packed.d_lo) = v(b.d[0]);
    (packed.dx_hi, packed.dx_lo) = v(b.d[1]);
    (packed.dy_hi, packed.dy_lo) = v(b.d[2]);
    [packed.h_hi, packed.h_lo] = split2(b.h[0]);
    [packed.hx_hi, packed.hx_lo] = split2(b.h[1]);
    [packed.hy_hi, packed.hy_lo] = split2(b.h[2]);
    packed
}

/// A cell of a piece that has this bundle about the centre of its tile.
fn with_bundle(cell: layout::Cell, b: &Bundle) -> layout::Cell {
    layout::Cell { p: b.p[0].as_vec3().to_array(), h: b.h[0] as f32, d: b.d[0].as_vec3().to_array(), ..cell }
}

/// Whether the rays of a bundle are affine over the image: its weight is constant.
fn has_one_weight(b: &Bundle) -> bool {
    b.h[1] == 0.0 && b.h[2] == 0.0
}

/// The first and the last pixel of a mask in each row.
fn row_ends(mask: u64) -> u64 {
    let ends = |row: u8| if row == 0 { 0 } else { row & row.wrapping_neg() | 0x80 >> row.leading_zeros() };
    u64::from_le_bytes(mask.to_le_bytes().map(ends))
}

/// The bundle with its origins relative to the anchor.
fn rebased(b: &Bundle, anchor: DVec3) -> Bundle {
    Bundle { p: [0, 1, 2].map_each(|k| b.p[k] - b.h[k] * anchor), ..*b }
}

/// The share of a piece, at first `none`.
fn share_of(cells: &mut TileCells, piece: u32, none: impl Fn(u32) -> CellPixels) -> &mut CellPixels {
    let k = cells.iter().position(|c| c.piece == piece).unwrap_or(cells.len());
    if k == cells.len() {
        cells.push(none(piece));
    }
    &mut cells[k]
}

/// The bits of a mask of pixels.
fn bits(mask: u64) -> impl Iterator<Item = u32> {
    (0..TILE * TILE).filter(move |bit| mask >> bit & 1 == 1)
}

#[inline]
pub(super) fn place_in_tile(x: u32, y: u32) -> DVec2 {
    (DVec2::new(x as f64, y as f64) - TILE_REACH) / (TILE as f64 / 2.0)
}
