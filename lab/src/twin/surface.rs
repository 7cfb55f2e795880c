//! Surface attributes of a triangle at a pixel, with bounds on the error of an f32 kernel.

use super::raster::Corners;
use super::rays::PixelRays;
use super::shade::UNIT;
use super::{KernelInputs, Real};
use anamorph::internals::engine::clusters::CORNER_ORDERS;
use anamorph::internals::gpu::layout::NONE;
use glam::{DVec3, DVec4};

/// A unit vector from a given one: length 3, division 2.5 (as a Vulkan driver may).
pub(super) const NORMALIZE_UNITS: f64 = 6.0;
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
/// Texture coordinates: three products and sums, and a rounding.
const UV_UNITS: f64 = 6.0;
/// A sum of three weighted normals.
const SUM_UNITS: f64 = 5.0;

/// A triangle at a pixel.
pub struct Surface<'a> {
    pub input: &'a KernelInputs<'a>,
    pub rays: &'a PixelRays,
    pub corners: Corners,
    pub slot: u32,
}

impl Surface<'_> {
    /// Sizes that an f32 kernel sums up to a direction: those of the cell's bundle over half a tile, over h.
    pub fn direction_size(&self) -> f64 {
        let b = &self.rays.bundle;
        let half = f64::from(anamorph::internals::camera::TILE);
        let h = b.h[0].abs();
        let d = b.d[0].length() + half * (b.d[1].length() + b.d[2].length());
        let size_h = h + half * (b.h[1].abs() + b.h[2].abs());
        if self.input.rays.is_some() { b.d[0].length() } else { d / h * (size_h / h) }
    }

    /// Weights of the stored corners: each opposite edge's value over their sum, which is `h N . d`; and the error of
    /// arithmetic with `rounding`, `stored` units of reach lost in each vertex.
    fn stored_weights(&self, rounding: f64, stored: f64) -> ([f64; 3], f64) {
        let [v0, v1, v2] = self.corners.v;
        let b = &self.rays.bundle;
        let d = b.d[0];
        let edge = |from: DVec3, e: DVec3| e.dot(d.cross(from * b.h[0] - b.p[0]));
        let w = [edge(v1, v2 - v1), edge(v0, v0 - v2), edge(v0, v1 - v0)];
        let sum = (v1 - v0).cross(v2 - v0).dot(d) * b.h[0];
        let reach = self.corners.reach();
        let size_e = (v1 - v0).length().max((v2 - v1).length()).max((v2 - v0).length());
        let size_m = (v0 * b.h[0] - b.p[0]).length().max((v1 * b.h[0] - b.p[0]).length());
        let error_m = OFFSET_UNITS * (reach * self.rays.size_h + self.rays.size_p);
        let sum_error =
            rounding * self.rays.size_d * (size_m * (EDGE_UNITS * size_e + stored * reach) + error_m * size_e);
        // a weight's own edge, and three in the sum
        let error = 4.0 * sum_error / (sum.abs() - 3.0 * sum_error).max(0.0);
        (w.map(|w| w / sum), error)
    }

    fn in_file_order(&self, w: [f64; 3]) -> [f64; 3] {
        let order = (self.input.triangles[self.slot as usize][3] >> 28 & 7) as usize;
        CORNER_ORDERS[order].map(|k| w[k].clamp(0.0, 1.0))
    }

    /// Weights of the file's corners, rounded to f32 at the end.
    pub fn weights(&self, real: Real) -> ([f64; 3], f64) {
        let stored = if real == Real::F32 { STORED_UNITS } else { 0.0 };
        let (w, error) = self.stored_weights(real.rounding(), stored);
        (self.in_file_order(w), error + UNIT)
    }

    /// Texture coordinates and a bound on their error, 0 without any. Kernels compute the weights from rays and corners rounded to f32.
    pub fn uv(&self) -> ([f64; 2], f64) {
        let own = self.input.uvs.get(self.slot as usize).filter(|uv| uv.iter().all(|v| v.is_finite()));
        let Some(uv) = own else { return ([0.0; 2], 0.0) };
        let (w, error) = self.stored_weights(UNIT, STORED_UNITS);
        let w = self.in_file_order(w);
        let [u, down] = [0, 1].map(|k| (0..3).map(|corner| w[corner] * f64::from(uv[2 * corner + k])).sum::<f64>());
        let size: f64 = uv.iter().map(|v| f64::from(v.abs())).sum();
        ([u, 1.0 - down], error * size + UNIT * UV_UNITS * (1.0 + size))
    }

    /// Lambert from every light, or one headlight along the ray, and a small ambient term.
    pub fn colour(&self, direction_error: f64) -> ([f64; 3], f64) {
        let appearance = self.input.appearance;
        let view = self.rays.direction().normalize();
        let view_error = direction_error + UNIT * NORMALIZE_UNITS;
        let (n, n_error) = self.normal(view, view_error);
        let lambert = |travel: DVec3| (-n.dot(travel)).max(0.0);
        let ambient = f64::from(appearance.shading.ambient);
        let lights = appearance.lights.iter().map(|l| DVec3::new(l[0].into(), l[1].into(), l[2].into()));
        let (direct, lights_error) = if appearance.lights.is_empty() {
            (lambert(view), n_error + view_error + LIGHT_UNITS * UNIT)
        } else {
            (lights.map(lambert).sum::<f64>(), appearance.lights.len() as f64 * (n_error + LIGHT_UNITS * UNIT))
        };
        let received = ambient + (1.0 - ambient) * direct;
        let colour = self.albedo().map(|c| f64::from(c) * received);
        (colour, lights_error + LIGHT_UNITS * UNIT * received)
    }

    /// The diffuse colour.
    pub fn albedo(&self) -> [f32; 3] {
        let material = self.input.surfaces[self.slot as usize][3];
        self.input.appearance.materials[material as usize].diffuse
    }

    /// The normal on the viewer's side: from the file, or else the triangle's.
    pub fn normal(&self, view: DVec3, view_error: f64) -> (DVec3, f64) {
        let [v0, v1, v2] = self.corners.v;
        let (e1, e2) = (v1 - v0, v2 - v0);
        let cross = e1.cross(e2);
        let reach = self.corners.reach();
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
        let appearance = self.input.appearance;
        let surface = self.input.surfaces[self.slot as usize];
        let corners = [surface[0], surface[1], surface[2]];
        if corners.contains(&NONE) {
            return None;
        }
        let (w, error) = self.stored_weights(UNIT, STORED_UNITS);
        let w = self.in_file_order(w);
        let normals = corners.map(|k| DVec4::from(appearance.normals[k as usize].map(f64::from)).truncate());
        let sum: DVec3 = (0..3).map(|k| w[k] * normals[k]).sum();
        let smooth = sum.try_normalize()?;
        // weights add up to 1, so their errors change the sum only by the differences of the normals
        let spread: f64 = normals.iter().map(|n| (*n - normals[0]).length()).sum();
        Some((smooth, (error * spread + SUM_UNITS * UNIT) / sum.length() + NORMALIZE_UNITS * UNIT))
    }
}
