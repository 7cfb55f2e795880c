//! shade in f64: the shading of each pixel's visible triangle, with bounds on the error of an f32 kernel.

use super::optics::Behind;
use super::raster::Visibility;
use super::rays::{Cast, length};
use super::surface::{NORMALIZE_UNITS, Surface};
use super::{KernelInputs, Real};
use anamorph::internals::image::frame::{Channel, NO_ID, PixelValues};
use glam::DVec3;
use rayon::prelude::*;

/// One pixel of a band under one chunk.
#[derive(Debug, Clone)]
pub enum Pixel {
    /// What is visible lies in another chunk, or it is a miss and this is not the first chunk; or the pixel's ray ended in
    /// a bounce before, or goes on at the next.
    Untouched,
    Miss(PixelValues),
    Hit(Box<Shaded>),
}

/// A hit.
#[derive(Debug, Clone, Copy)]
pub struct Shaded {
    /// Without labels and what is proven, which other stages find.
    pub values: PixelValues,
    /// How far a kernel's numbers may be from these; of colour and normal infinite if it is not certain which side faces the viewer.
    pub error: PixelValues,
}

/// Rounding of one f32 operation, relative.
pub(super) const UNIT: f64 = f32::EPSILON as f64 / 2.0;
/// t: rounded once; its decoding is exact.
const T_UNITS: f64 = 2.0;
/// Z: t's rounding, a length (3 squares, 2 sums, a root, at most 3 units) and a product.
const Z_UNITS: f64 = 6.0;
/// A direction in units of what is summed up: three stored terms (1 each), two products, two sums and a division.
const DIRECTION_UNITS: f64 = 6.0;

/// A point of a ray: origin and direction as a direction, t's own rounding, and a product and a sum.
const POINT_UNITS: f64 = DIRECTION_UNITS + T_UNITS + 2.0;
/// The anchor: rounded once, and a sum.
const ANCHOR_UNITS: f64 = 2.0;

/// All pixels of the band as the chunk of `input` sees them.
pub fn shade(input: &KernelInputs, visibility: &Visibility, real: Real) -> Vec<Pixel> {
    let p = &input.params;
    (0..p.width * p.height)
        .into_par_iter()
        .map(|pixel| shade_pixel(input, visibility.key(pixel as usize), pixel, real))
        .collect()
}

fn shade_pixel(input: &KernelInputs, key: Option<u64>, pixel: u32, real: Real) -> Pixel {
    let p = &input.params;
    let (x, y) = (pixel % p.width, pixel / p.width);
    let behind = input.behind(pixel);
    let Some(key) = key else {
        return if p.id_first == 0 && input.has_path(x, y) {
            Pixel::Miss(miss(input, &behind))
        } else {
            Pixel::Untouched
        };
    };
    let keys = input.keys(real);
    let (layer, t, id) = (keys.layer(key), keys.t(key), keys.id(key));
    if input.goes_on(id) {
        return Pixel::Untouched;
    }
    if input.ends_on_smooth(id) {
        return if p.id_first == 0 { end_on_smooth(input, &behind, (id, t), (x, y)) } else { Pixel::Untouched };
    }
    let here = id.wrapping_sub(p.id_first) < p.id_count;
    let (true, Some(cell)) = (here, input.pixel_cell(layer, x, y)) else { return Pixel::Untouched };
    let cell = input.cells[cell as usize];
    let cast = input.cell_cast(
        &cell,
        (y % anamorph::internals::camera::TILE) * anamorph::internals::camera::TILE
            + x % anamorph::internals::camera::TILE,
    );
    let rays = cast.ray(t);
    let slot = input.slot_of_id[(id - p.id_first) as usize];
    let hit = Surface { input, rays: &rays, corners: input.corners(slot), slot };

    let direction = rays.direction();
    let reached = match &cast {
        Cast::Ray(_) => t * direction.length(),
        Cast::Curve(c) => length(&c.curve, t),
    };
    let before = f64::from(behind.length) + (0..layer).map(|k| input.segment_length(k, x, y)).sum::<f64>();
    let z = before + reached;
    let b = &rays.bundle;
    // of a curve the bundle starts at t
    let along = if matches!(cast, Cast::Ray(_)) { t } else { 0.0 };
    let point = (b.p[0] + along * b.d[0]) / b.h[0];
    let point_size = (rays.size_p + t.abs() * rays.size_d) / b.h[0].abs() * (rays.size_h / b.h[0].abs());
    let t = f64::from(layer) + t;
    let direction_error = UNIT * DIRECTION_UNITS * hit.direction_size() / direction.length();
    let (weights, weight_error) = hit.weights(real);
    let (colour, colour_error) = match input.base(id) {
        Some(base) => (base.map(f64::from), 0.0),
        None => hit.colour(direction_error),
    };
    let (normal, normal_error) = hit.normal(direction.normalize(), direction_error + UNIT * NORMALIZE_UNITS);
    let (colour, colour_error) = behind.left_of(colour, colour_error);
    let own_piece = match cast {
        Cast::Ray(_) if input.rays.is_none() => input.pieces[cell.piece as usize].number,
        _ => cell.piece,
    };
    let (mirror, piece) = behind.first.unwrap_or((NO_ID, own_piece));
    let (uv, uv_error) = hit.uv();
    let error = PixelValues {
        t: T_UNITS * UNIT * t.abs(),
        z: z.abs() * (Z_UNITS * UNIT + direction_error) + UNIT * before,
        bary: [weight_error; 2],
        colour: [colour_error; 3],
        normal: DVec3::splat(normal_error),
        position: DVec3::splat(position_error(input, point, point_size)),
        uv: [uv_error; 2],
        view: DVec3::splat(direction_error + UNIT * NORMALIZE_UNITS),
        ..PixelValues::default()
    };
    let (position, albedo) = (point + input.anchor(), input.base(id).unwrap_or_else(|| hit.albedo()));
    let (bary, triangle) = ([weights[1], weights[2]], id);
    let view = -direction.normalize();
    let seen = PixelValues {
        view,
        triangle,
        piece,
        mirror,
        t,
        z,
        bary,
        colour,
        normal,
        position,
        albedo,
        uv,
        ..PixelValues::MISS
    };
    Pixel::Hit(Box::new(Shaded { values: PixelValues { coverage: 1.0, ..seen }, error }))
}

/// A ray that hits nothing.
fn miss(input: &KernelInputs, behind: &Behind) -> PixelValues {
    let colour = [0, 1, 2].map(|k| f64::from(behind.light[k]) * f64::from(input.appearance.shading.background[k]));
    let Some((mirror, piece)) = behind.first else { return PixelValues { colour, ..PixelValues::MISS } };
    // what the optics show is no hole in the picture
    PixelValues { colour, coverage: 1.0, mirror, piece, ..PixelValues::MISS }
}

/// How far a kernel's position may be from a point that is relative to the anchor, from numbers so large.
fn position_error(input: &KernelInputs, point: DVec3, size: f64) -> f64 {
    let anchor = input.anchor();
    UNIT * (POINT_UNITS * size + ANCHOR_UNITS * (anchor.length() + (anchor + point).length()))
}

/// A ray that ends on a surface without triangles.
fn end_on_smooth(input: &KernelInputs, behind: &Behind, (id, t): (u32, f64), (x, y): (u32, u32)) -> Pixel {
    let Some(ray) = input.bounded_ray(x, y, Real::F64) else { return Pixel::Untouched };
    let (mirror, piece) = behind.first.unwrap_or((NO_ID, 0));
    let z = f64::from(behind.length) + t * ray.d.value().length();
    let albedo = input.base(id).unwrap_or_default();
    let (colour, colour_error) = behind.left_of(albedo.map(f64::from), 0.0);
    let (p, d) = (ray.p.value(), ray.d.value());
    let point = p + t * d;
    let error = PixelValues {
        t: T_UNITS * UNIT * t.abs(),
        z: z * (Z_UNITS + 2.0) * UNIT,
        colour: [colour_error; 3],
        position: DVec3::splat(position_error(input, point, p.length() + t.abs() * d.length())),
        view: DVec3::splat(UNIT * (DIRECTION_UNITS + NORMALIZE_UNITS)),
        ..PixelValues::default()
    };
    let (position, triangle) = (point + input.anchor(), id);
    let view = -d.normalize();
    let seen = PixelValues { view, triangle, piece, mirror, t, z, colour, position, albedo, ..PixelValues::MISS };
    Pixel::Hit(Box::new(Shaded { values: PixelValues { coverage: 1.0, ..seen }, error }))
}

impl Behind {
    /// A colour times a share, with the error of one more product.
    fn left_of(&self, colour: [f64; 3], error: f64) -> ([f64; 3], f64) {
        let light = self.light.map(f64::from);
        let left = [0, 1, 2].map(|k| light[k] * colour[k]);
        let most = |v: [f64; 3]| v.into_iter().fold(0.0, f64::max);
        (left, error * most(light) + UNIT * most(left))
    }
}

impl Pixel {
    /// Its word in a channel's plane; `None`: not written.
    pub fn word(&self, channel: Channel) -> Option<u32> {
        match self {
            Pixel::Untouched => None,
            Pixel::Miss(values) => Some(values.word(channel)),
            Pixel::Hit(shaded) => Some(shaded.values.word(channel)),
        }
    }
}
