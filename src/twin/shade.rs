//! shade in f64: what each pixel's visible triangle looks like, and how far an f32 kernel may be from it.

use super::optics::Behind;
use super::raster::{Corners, Visibility};
use super::rays::{Cast, PixelRays, length};
use super::{Input, Real};
use crate::frame::{Channel, NO_ID};
use crate::gpu::rows::NONE;
use crate::scene::clusters::CORNER_ORDERS;
use glam::DVec3;
use rayon::prelude::*;

/// One pixel of a band under one chunk.
#[derive(Debug, Clone, Copy)]
pub enum Pixel {
    /// What is visible lies in another chunk, or it is a miss and this is not the first chunk; or the pixel's ray ended in
    /// a pass before, or goes on in the next.
    Untouched,
    Miss(Behind),
    Hit(Shaded),
}

/// The channels of a hit.
#[derive(Debug, Clone, Copy)]
pub struct Shaded {
    pub triangle: u32,
    pub piece: u32,
    /// The surface of the optics that was met first.
    pub mirror: u32,
    pub t: f64,
    pub z: f64,
    /// Weights of the file's corners, clamped to [0, 1].
    pub weights: [f64; 3],
    pub colour: [f64; 3],
    pub error: Errors,
}

/// How far a kernel's numbers may be from these.
#[derive(Debug, Clone, Copy)]
pub struct Errors {
    pub t: f64,
    pub z: f64,
    pub weight: f64,
    /// Infinite where the face turned to the viewer is not certain.
    pub colour: f64,
}

/// Rounding of one f32 operation, relative.
const UNIT: f64 = f32::EPSILON as f64 / 2.0;
/// t: rounded once; its decoding is exact.
const T_UNITS: f64 = 2.0;
/// Z: t's rounding, a length (3 squares, 2 sums, a root, at most 3 units) and a product.
const Z_UNITS: f64 = 6.0;
/// A direction in units of what is summed up: three stored terms (1 each), two products, two sums and a division.
const DIRECTION_UNITS: f64 = 6.0;
/// A unit vector from a given one: length 3, division 2.5 (as a Vulkan driver may).
const NORMALIZE_UNITS: f64 = 6.0;
/// A cross product of two differences: 1 each, 3 for products and sum.
const NORMAL_UNITS: f64 = 6.0;
/// A vertex rounded to f32, 1 unit of reach, at both ends of an edge.
const STORED_UNITS: f64 = 2.0;
/// A dot product and the few sums and products that make a colour.
const LIGHT_UNITS: f64 = 8.0;
/// An edge value `e . (d x m)`: edge 1, direction 1, cross product 3, dot product 3.
const EDGE_UNITS: f64 = 8.0;
/// A vertex less an origin: a product, a difference, and the origin's own sums.
const OFFSET_UNITS: f64 = 3.0;
/// A sum of three weighted normals.
const SUM_UNITS: f64 = 5.0;

/// All pixels of the band as the chunk of `input` sees them.
pub fn shade(input: &Input, visibility: &Visibility, real: Real) -> Vec<Pixel> {
    let p = &input.params;
    (0..p.width * p.height)
        .into_par_iter()
        .map(|pixel| shade_pixel(input, visibility.key(pixel as usize), pixel, real))
        .collect()
}

fn shade_pixel(input: &Input, key: Option<u64>, pixel: u32, real: Real) -> Pixel {
    let p = &input.params;
    let (x, y) = (pixel % p.width, pixel / p.width);
    let behind = input.behind(pixel);
    let Some(key) = key else {
        return if p.id_first == 0 && input.is_under_way(x, y) { Pixel::Miss(behind) } else { Pixel::Untouched };
    };
    let keys = input.keys(real);
    let (layer, t, id) = (keys.layer(key), keys.t(key), keys.id(key));
    if input.goes_on(id) {
        return Pixel::Untouched;
    }
    if input.ends_on_quadric(id) {
        return if p.id_first == 0 { end_on_quadric(input, &behind, (id, t), (x, y)) } else { Pixel::Untouched };
    }
    let here = id.wrapping_sub(p.id_first) < p.id_count;
    let (true, Some(cell)) = (here, input.pixel_cell(layer, x, y)) else { return Pixel::Untouched };
    let cell = input.cells[cell as usize];
    let cast = input.cell_cast(&cell, (y % crate::TILE) * crate::TILE + x % crate::TILE);
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
    let t = f64::from(layer) + t;
    let direction_error = UNIT * DIRECTION_UNITS * hit.direction_size() / direction.length();
    let (weights, weight_error) = hit.weights(real);
    let (colour, colour_error) = match input.base(id) {
        Some(base) => (base.map(f64::from), 0.0),
        None => hit.colour(direction_error),
    };
    let (colour, colour_error) = behind.left_of(colour, colour_error);
    let own_piece = match cast {
        Cast::Ray(_) if input.rays.is_none() => input.pieces[cell.piece as usize].number,
        _ => cell.piece,
    };
    let (mirror, piece) = behind.first.unwrap_or((NO_ID, own_piece));
    let error = Errors {
        t: T_UNITS * UNIT * t.abs(),
        z: z.abs() * (Z_UNITS * UNIT + direction_error) + UNIT * before,
        weight: weight_error,
        colour: colour_error,
    };
    Pixel::Hit(Shaded { triangle: id, piece, mirror, t, z, weights, colour, error })
}

/// A ray that ends on a surface without triangles.
fn end_on_quadric(input: &Input, behind: &Behind, (id, t): (u32, f64), (x, y): (u32, u32)) -> Pixel {
    let Some(ray) = input.near_ray(x, y, Real::F64) else { return Pixel::Untouched };
    let (mirror, piece) = behind.first.unwrap_or((NO_ID, 0));
    let z = f64::from(behind.length) + t * ray.d.value().length();
    let (colour, colour_error) = behind.left_of(input.base(id).unwrap_or_default().map(f64::from), 0.0);
    let error =
        Errors { t: T_UNITS * UNIT * t.abs(), z: z * (Z_UNITS + 2.0) * UNIT, weight: 0.0, colour: colour_error };
    Pixel::Hit(Shaded { triangle: id, piece, mirror, t, z, weights: [0.0; 3], colour, error })
}

impl Behind {
    /// What is left of a colour, and of its error: one product more.
    fn left_of(&self, colour: [f64; 3], error: f64) -> ([f64; 3], f64) {
        let light = self.light.map(f64::from);
        let left = [0, 1, 2].map(|k| light[k] * colour[k]);
        let most = |v: [f64; 3]| v.into_iter().fold(0.0, f64::max);
        (left, error * most(light) + UNIT * most(left))
    }
}

/// A triangle at a pixel.
struct Surface<'a> {
    input: &'a Input<'a>,
    rays: &'a PixelRays,
    corners: Corners,
    slot: u32,
}

impl Surface<'_> {
    /// Sizes that an f32 kernel sums up to a direction: those of the cell's bundle over half a tile, over h.
    fn direction_size(&self) -> f64 {
        let b = &self.rays.bundle;
        let half = f64::from(crate::TILE);
        let h = b.h[0].abs();
        let d = b.d[0].length() + half * (b.d[1].length() + b.d[2].length());
        let size_h = h + half * (b.h[1].abs() + b.h[2].abs());
        if self.input.rays.is_some() { b.d[0].length() } else { d / h * (size_h / h) }
    }

    /// Weights of the row's corners: each opposite edge's value over their sum, which is `h N . d`; and the error of
    /// arithmetic with `rounding`, `stored` units of reach lost in each vertex.
    fn row_weights(&self, rounding: f64, stored: f64) -> ([f64; 3], f64) {
        let [v0, v1, v2] = self.corners.v;
        let b = &self.rays.bundle;
        let d = b.d[0];
        let edge = |from: DVec3, e: DVec3| e.dot(d.cross(from * b.h[0] - b.p[0]));
        let w = [edge(v1, v2 - v1), edge(v0, v0 - v2), edge(v0, v1 - v0)];
        let sum = (v1 - v0).cross(v2 - v0).dot(d) * b.h[0];
        let reach = f64::from(self.input.params.vertex_reach);
        let size_e = (v1 - v0).length().max((v2 - v1).length()).max((v2 - v0).length());
        let size_m = (v0 * b.h[0] - b.p[0]).length().max((v1 * b.h[0] - b.p[0]).length());
        let lost_m = OFFSET_UNITS * (reach * self.rays.size_h + self.rays.size_p);
        let lost = rounding * self.rays.size_d * (size_m * (EDGE_UNITS * size_e + stored * reach) + lost_m * size_e);
        // a weight's own edge, and three in the sum
        let error = 4.0 * lost / (sum.abs() - 3.0 * lost).max(0.0);
        (w.map(|w| w / sum), error)
    }

    fn in_file_order(&self, w: [f64; 3]) -> [f64; 3] {
        let order = (self.input.triangles[self.slot as usize][3] >> 28 & 7) as usize;
        CORNER_ORDERS[order].map(|k| w[k].clamp(0.0, 1.0))
    }

    /// Weights of the file's corners, rounded to f32 at the end.
    fn weights(&self, real: Real) -> ([f64; 3], f64) {
        let stored = if real == Real::F32 { STORED_UNITS } else { 0.0 };
        let (w, error) = self.row_weights(real.rounding(), stored);
        (self.in_file_order(w), error + UNIT)
    }

    /// Lambert from every light, or one headlight along the ray, and a small ambient term.
    fn colour(&self, direction_error: f64) -> ([f64; 3], f64) {
        let look = self.input.look;
        let view = self.rays.direction().normalize();
        let view_error = direction_error + UNIT * NORMALIZE_UNITS;
        let (n, n_error) = self.normal(view, view_error);
        let lambert = |travel: DVec3| (-n.dot(travel)).max(0.0);
        let ambient = f64::from(look.shading.ambient);
        let lights = look.lights.iter().map(|l| DVec3::new(l[0].into(), l[1].into(), l[2].into()));
        let (direct, lights_error) = if look.lights.is_empty() {
            (lambert(view), n_error + view_error + LIGHT_UNITS * UNIT)
        } else {
            (lights.map(lambert).sum::<f64>(), look.lights.len() as f64 * (n_error + LIGHT_UNITS * UNIT))
        };
        let received = ambient + (1.0 - ambient) * direct;
        let material = self.input.surfaces[self.slot as usize][3];
        let diffuse = look.materials[material as usize];
        let colour = [0, 1, 2].map(|k| f64::from(diffuse[k]) * received);
        (colour, lights_error + LIGHT_UNITS * UNIT * received)
    }

    /// The normal turned to the viewer: the file's where it has them, else the triangle's.
    fn normal(&self, view: DVec3, view_error: f64) -> (DVec3, f64) {
        let [v0, v1, v2] = self.corners.v;
        let (e1, e2) = (v1 - v0, v2 - v0);
        let cross = e1.cross(e2);
        let reach = f64::from(self.input.params.vertex_reach);
        let stored = STORED_UNITS * reach * (e1.length() + e2.length());
        let flat_error =
            UNIT * ((stored + NORMAL_UNITS * e1.length() * e2.length()) / cross.length() + NORMALIZE_UNITS);
        let towards = |n: DVec3, away: bool| if away { -n } else { n };
        let flat = cross.normalize();
        let edge_on = flat.dot(view).abs() <= flat_error + view_error;
        let flat = towards(flat, flat.dot(view) > 0.0);
        let flat_error = if edge_on { f64::INFINITY } else { flat_error };
        let Some((smooth, smooth_error)) = self.smooth_normal() else { return (flat, flat_error) };
        let unsure = smooth.dot(flat).abs() <= smooth_error + flat_error;
        (towards(smooth, smooth.dot(flat) < 0.0), if unsure { f64::INFINITY } else { smooth_error })
    }

    /// The file's normals by their weights, which f32 kernels take from f32 edges.
    fn smooth_normal(&self) -> Option<(DVec3, f64)> {
        let look = self.input.look;
        let surface = self.input.surfaces[self.slot as usize];
        let corners = [surface[0], surface[1], surface[2]];
        if look.shading.has_normals == 0 || corners.contains(&NONE) {
            return None;
        }
        let (w, error) = self.row_weights(UNIT, STORED_UNITS);
        let w = self.in_file_order(w);
        let normals = corners.map(|k| DVec3::from(look.normals[k as usize].map(f64::from)));
        let sum: DVec3 = (0..3).map(|k| w[k] * normals[k]).sum();
        let smooth = sum.try_normalize()?;
        // weights add up to 1, so their errors turn the sum only as far as the normals differ
        let apart: f64 = normals.iter().map(|n| (*n - normals[0]).length()).sum();
        Some((smooth, (error * apart + SUM_UNITS * UNIT) / sum.length() + NORMALIZE_UNITS * UNIT))
    }
}

/// A pixel's word in a channel's plane; `None`: not written.
pub fn word(pixel: &Pixel, channel: Channel, background: [f32; 3]) -> Option<u32> {
    let infinity = f32::INFINITY.to_bits();
    let bits = |v: f64| (v as f32).to_bits();
    Some(match (pixel, channel) {
        (Pixel::Untouched, _) => return None,
        (Pixel::Miss(m), Channel::R) => (m.light[0] * background[0]).to_bits(),
        (Pixel::Miss(m), Channel::G) => (m.light[1] * background[1]).to_bits(),
        (Pixel::Miss(m), Channel::B) => (m.light[2] * background[2]).to_bits(),
        // what the optics show is no hole in the picture
        (Pixel::Miss(m), Channel::A) => bits(if m.first.is_some() { 1.0 } else { 0.0 }),
        (Pixel::Miss(_), Channel::Z | Channel::T) => infinity,
        (Pixel::Miss(m), Channel::PieceId) => m.first.map_or(NO_ID, |f| f.1),
        (Pixel::Miss(m), Channel::MirrorId) => m.first.map_or(NO_ID, |f| f.0),
        (Pixel::Miss(_), Channel::TriangleId) => NO_ID,
        (Pixel::Miss(_), Channel::BaryU | Channel::BaryV) => 0,
        (Pixel::Hit(s), Channel::R) => bits(s.colour[0]),
        (Pixel::Hit(s), Channel::G) => bits(s.colour[1]),
        (Pixel::Hit(s), Channel::B) => bits(s.colour[2]),
        (Pixel::Hit(_), Channel::A) => bits(1.0),
        (Pixel::Hit(s), Channel::Z) => bits(s.z),
        (Pixel::Hit(s), Channel::T) => bits(s.t),
        (Pixel::Hit(s), Channel::TriangleId) => s.triangle,
        (Pixel::Hit(s), Channel::PieceId) => s.piece,
        (Pixel::Hit(s), Channel::MirrorId) => s.mirror,
        (Pixel::Hit(s), Channel::BaryU) => bits(s.weights[1]),
        (Pixel::Hit(s), Channel::BaryV) => bits(s.weights[2]),
    })
}
