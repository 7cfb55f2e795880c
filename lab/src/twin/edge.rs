//! On which side of a scene edge a pixel's ray passes: the rule of every recheck.

use super::Real;
use super::rays::PixelRays;
use anamorph::internals::camera::Bundle;
use anamorph::internals::camera::perturb::PERTURB_PX;
use glam::{DVec2, DVec3, Vec3Swizzles};

/// A side, and whether another correct evaluation of the same rule may differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Side {
    /// 1 or -1.
    pub sign: i32,
    pub uncertain: bool,
}

/// Terms (a, b) of `E = e . (d x m)` as it changes over a pixel, `d_a x m_b` with 0 the value, 1 the slope along x and 2
/// that along y: the value, then its derivatives by x, y, xx, xy, yy.
const STEPS: [&[(usize, usize)]; 6] =
    [&[(0, 0)], &[(1, 0), (0, 1)], &[(2, 0), (0, 2)], &[(1, 1)], &[(1, 2), (2, 1)], &[(2, 2)]];

/// Rounding of the stored vertices and bundles and of E, in units of |e| |d| |m|: a cross product of rounded factors and a dot
/// product.
const EDGE_UNITS: f64 = 16.0;
/// Rounding of an edge as the difference of two stored vertices, in units of both their sizes.
const STORED_UNITS: f64 = 2.0;
/// A corner in the plane: a product and a difference for m, a quotient, a product and a difference, of what is up to
/// twice as large.
const PLANE_UNITS: f64 = 16.0;

fn size(v: DVec3) -> f64 {
    v.x.abs() + v.y.abs() + v.z.abs()
}

/// A vertex `v` seen from a bundle: `m = v h - p`, and the sizes that were subtracted to get it.
struct Seen {
    m: [DVec3; 3],
    size_m: [f64; 3],
}

impl Seen {
    fn new(b: &Bundle, v: DVec3) -> Seen {
        let m = [0, 1, 2].map(|k| v * b.h[k] - b.p[k]);
        let mut size_m = [0, 1, 2].map(|k| size(m[k]) + size(v) * b.h[k].abs());
        size_m[0] += size(b.p[0]);
        Seen { m, size_m }
    }
}

/// An edge against a bundle.
struct Edge<'a> {
    b: &'a Bundle,
    e: DVec3,
    /// The edge's start.
    v: Seen,
    size_d: [f64; 3],
    size_e: f64,
    error_e: f64,
}

impl Edge<'_> {
    fn new(b: &Bundle, v: DVec3, w: DVec3, real: Real) -> Edge<'_> {
        let (e, unit, sizes) = (w - v, real.unit(), size(v) + size(w));
        let size_e = EDGE_UNITS * unit * (size(e) + sizes * unit);
        Edge { b, e, v: Seen::new(b, v), size_d: b.d.map(size), size_e, error_e: STORED_UNITS * unit * sizes }
    }

    /// One coefficient of `E` and its error bound.
    fn step(&self, terms: &[(usize, usize)]) -> (f64, f64) {
        let g = terms.iter().map(|&(k, l)| self.b.d[k].cross(self.v.m[l])).sum::<DVec3>();
        let sizes = terms.iter().map(|&(k, l)| self.size_d[k] * self.v.size_m[l]).sum::<f64>();
        (self.e.dot(g), self.size_e * sizes + self.error_e * size(g))
    }
}

/// A corner along the ray onto a plane, as `in_plane` of sides.wgsl has it, and how far another adapter's may be from it.
fn in_plane(rays: &PixelRays, v: DVec3, real: Real) -> (DVec2, f64) {
    let (b, axis) = (&rays.bundle, rays.bundle.d[0].abs().max_position());
    let rotated = |v: DVec3| DVec3::from_array([1, 2, 3].map(|k| v[(axis + k) % 3]));
    let (d, m) = (rotated(b.d[0]), rotated(v * b.h[0] - b.p[0]));
    let slope = d.xy() / d.z;
    let place = m.xy() - slope * m.z;
    let sizes = size(v) * rays.size_h + rays.size_p + size(m) * (rays.size_d / d.z.abs());
    (place, PLANE_UNITS * real.rounding() * sizes)
}

/// The side of the bundle's central ray with respect to the edge from `v` to `w`, in the plane. Places of another adapter may be
/// apart by their rounding.
pub fn side(rays: &PixelRays, v: DVec3, w: DVec3, real: Real) -> Side {
    let ((u, off_u), (v, off_v)) = (in_plane(rays, v, real), in_plane(rays, w, real));
    let value = u.perp_dot(v);
    let bound = off_u * (v.abs().element_sum() + off_v) + off_v * u.abs().element_sum();
    let first = [value, u.y - v.y, v.x - u.x].into_iter().find(|s| *s != 0.0);
    Side { sign: first.map_or(1, |s| s.signum() as i32), uncertain: value.abs() <= bound }
}

/// The side on which all rays within `r` px of the bundle's centre pass, perturbed or not, for certain of [`side`]; 0: not proven.
pub fn side_over(b: &Bundle, v: DVec3, w: DVec3, real: Real, r: f64) -> i32 {
    let r = r + 2.0 * PERTURB_PX;
    // bounds from either end
    let ends = [Edge::new(b, v, w, real), Edge::new(b, w, v, real)];
    let step = |terms| {
        let [(value, from_v), (_, from_w)] = [0, 1].map(|k: usize| ends[k].step(terms));
        (value, from_v.max(from_w))
    };
    let (value, bound) = step(STEPS[0]);
    let mut error = UNCERTAIN_BOUNDS * bound;
    for (terms, scale) in STEPS.iter().zip([0.0, r, r, r * r, r * r, r * r]) {
        let (value, bound) = step(terms);
        error += scale * (value.abs() + UNCERTAIN_BOUNDS * bound);
    }
    if value.abs() > error { value.signum() as i32 } else { 0 }
}

/// In units of the bound: the error of [`side`], which is smaller than one, and the growth of the sizes over the square; twice each.
const UNCERTAIN_BOUNDS: f64 = 4.0;
