//! The rays of a pixel in f64, from what the kernels read: a piece, or the table of a ray field.

use super::KernelInputs;
use anamorph::internals::camera::TILE;
use anamorph::internals::camera::{Bundle, Curve};
use anamorph::internals::engine::plan::curves::RayTable;
use anamorph::internals::gpu::kernels::RaysKind;
use anamorph::internals::gpu::layout::{Cell, Piece};
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
    /// Those on which coverage is decided in a scene of this size.
    pub fn perturbed(&self, scene_size: f64) -> PixelRays {
        PixelRays { bundle: self.bundle.perturbed(scene_size).0, ..*self }
    }

    /// The ray's direction.
    pub fn direction(&self) -> DVec3 {
        self.bundle.d[0] / self.bundle.h[0]
    }
}

/// A pixel's curve over a span of t, and the size of its numbers.
#[derive(Debug, Clone, Copy)]
pub struct PixelCurve {
    pub curve: Curve,
    pub span: [f64; 2],
    pub size: f64,
}

/// The rays of a cell at a pixel.
#[derive(Debug, Clone, Copy)]
pub enum Cast {
    Ray(PixelRays),
    Curve(PixelCurve),
}

impl Cast {
    /// The ray; for a curve the tangent at t, or where the derivative is 0 the direction to its end.
    pub fn ray(&self, t: f64) -> PixelRays {
        match self {
            Cast::Ray(rays) => *rays,
            Cast::Curve(c) => {
                let tangent = c.curve.tangent(t);
                let chord = c.curve.at(1.0) - c.curve.at(0.0);
                let d = if tangent == DVec3::ZERO { chord } else { tangent };
                let z = DVec3::ZERO;
                let bundle = Bundle { p: [c.curve.at(t), z, z], d: [d, z, z], h: [1.0, 0.0, 0.0] };
                let legs = c.curve.points().windows(2).map(|w| (w[1] - w[0]).length()).sum::<f64>();
                PixelRays { bundle, size_p: c.size, size_d: 2.0 * legs, size_h: 1.0 }
            }
        }
    }
}

impl KernelInputs<'_> {
    /// Column and row in the band of a pixel of a tile.
    pub fn pixel_of(&self, tile: u32, bit: u32) -> (u32, u32) {
        let (tx, ty) = (tile % self.params.tiles_x, tile / self.params.tiles_x % self.params.slab_rows);
        (tx * TILE + bit % TILE, ty * TILE + bit / TILE)
    }

    /// The slab of a tile.
    fn slab_of(&self, tile: u32) -> u32 {
        tile / self.params.tiles_x / self.params.slab_rows
    }

    pub fn layer_of(&self, tile: u32) -> u32 {
        self.slab_of(tile) / self.params.spans
    }

    /// The rays of a cell at its pixel `bit`.
    pub fn cell_cast(&self, cell: &Cell, bit: u32) -> Cast {
        let (x, y) = self.pixel_of(cell.tile, bit);
        match (self.kind, self.rays) {
            (RaysKind::Field { .. }, Some(table)) => Cast::Ray(field_rays(table, self.params.width, x, y)),
            (RaysKind::Curves { degree }, Some(table)) => {
                let span = self.slab_of(cell.tile) % self.params.spans;
                let at = |k: u32| f64::from(k) / f64::from(self.params.spans);
                let span = [at(span), at(span + 1)];
                Cast::Curve(PixelCurve { span, ..self.stored_curve(table, degree, self.layer_of(cell.tile), (x, y)) })
            }
            _ => Cast::Ray(piece_rays(&self.pieces[cell.piece as usize], x, y)),
        }
    }

    /// The curve of a pixel of the band in a layer, whole; one point where there is none.
    fn stored_curve(&self, table: &RayTable, degree: u32, layer: u32, (x, y): (u32, u32)) -> PixelCurve {
        let pixel = (layer * self.params.height + y) as usize * self.params.width as usize + x as usize;
        let first = pixel * (degree as usize + 1);
        let number = |k: usize| f64::from(table.hi[k]) + f64::from(table.lo[k]);
        let point = |k: usize| DVec3::new(number(3 * k), number(3 * k + 1), number(3 * k + 2));
        let points: Vec<DVec3> = (first..=first + degree as usize).map(point).collect();
        let size = points.iter().map(|p| p.length()).fold(0.0, f64::max);
        PixelCurve { curve: Curve::new(&points), span: [0.0, 1.0], size }
    }

    /// The length of a pixel's whole segment in a layer, 0 where it has none.
    pub fn segment_length(&self, layer: u32, x: u32, y: u32) -> f64 {
        match (self.kind, self.rays) {
            (RaysKind::Curves { degree }, Some(table)) => {
                length(&self.stored_curve(table, degree, layer, (x, y)).curve, 1.0)
            }
            _ => self.pixel_cell(layer, x, y).map_or(0.0, |cell| {
                let cell = &self.cells[cell as usize];
                self.cell_cast(cell, (y % TILE) * TILE + x % TILE).ray(0.0).direction().length()
            }),
        }
    }

    /// The cell that owns a pixel of the band in a layer's first slab.
    pub fn pixel_cell(&self, layer: u32, x: u32, y: u32) -> Option<u32> {
        let row = y / TILE + layer * self.params.spans * self.params.slab_rows;
        let tile = (row * self.params.tiles_x + x / TILE) as usize;
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
fn field_ray(table: &RayTable, width: u32, x: u32, y: u32) -> (DVec3, DVec3) {
    let at = 6 * (y as usize * (width as usize + 1) + x as usize);
    let number = |k: usize| f64::from(table.hi[at + k]) + f64::from(table.lo[at + k]);
    (DVec3::new(number(0), number(1), number(2)), DVec3::new(number(3), number(4), number(5)))
}

/// The ray of a pixel, and its slopes towards the right and lower neighbours that have a ray.
fn field_rays(table: &RayTable, width: u32, x: u32, y: u32) -> PixelRays {
    let (p, d) = field_ray(table, width, x, y);
    let slope = |(q, e): (DVec3, DVec3)| if e == DVec3::ZERO { (e, e) } else { (q - p, e - d) };
    let (px, dx) = slope(field_ray(table, width, x + 1, y));
    let (py, dy) = slope(field_ray(table, width, x, y + 1));
    let bundle = Bundle { p: [p, px, py], d: [d, dx, dy], h: [1.0, 0.0, 0.0] };
    PixelRays { bundle, size_p: p.length(), size_d: d.length(), size_h: 1.0 }
}

/// Equal parts of t by which lengths are summed up: Simpson's rule, of fourth order.
const LENGTH_PARTS: usize = 512;

/// The length of a curve from 0 to t.
pub fn length(curve: &Curve, t: f64) -> f64 {
    let speed = |k: usize| curve.tangent(t * k as f64 / (2 * LENGTH_PARTS) as f64).length();
    let inner = |first: usize| (first..2 * LENGTH_PARTS).step_by(2).map(speed).sum::<f64>();
    t / (6 * LENGTH_PARTS) as f64 * (speed(0) + speed(2 * LENGTH_PARTS) + 4.0 * inner(1) + 2.0 * inner(2))
}
