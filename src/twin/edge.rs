//! On which side of a scene edge a pixel's ray passes: the rule by which all kernels' doubts are settled.

use super::Real;
use crate::camera::Bundle;
use glam::DVec3;

/// A side, and whether another correct evaluation of the same rule may find the other one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Side {
    /// 1 or -1.
    pub sign: i32,
    pub doubtful: bool,
}

/// Terms (a, b) of `E = e . (d x m)` at each step of the rule, `d_a x m_b` with 0 the value, 1 the slope along x and 2
/// that along y: the value, then its derivatives by x, y, xx, xy, yy.
const STEPS: [&[(usize, usize)]; 6] =
    [&[(0, 0)], &[(1, 0), (0, 1)], &[(2, 0), (0, 2)], &[(1, 1)], &[(1, 2), (2, 1)], &[(2, 2)]];

/// Rounding of the stored vertices and bundles and of the rule's own evaluation, in units of |e| |d| |m|: a cross
/// product of rounded factors and a dot product.
const EDGE_UNITS: f64 = 16.0;
/// Rounding of an edge as the difference of two stored vertices, in units of both their sizes.
const STORED_UNITS: f64 = 2.0;
/// An f64 evaluation is off by 16 |e| |d| |m| 2^-53, a 32nd of the bound; two of them by a 16th.
const EVALUATION_SHARE: f64 = 1.0 / 16.0;
/// The bound on a vertex's distance is wider than its evaluation is off by a thousandfold more.
const MEETING_SHARE: f64 = EVALUATION_SHARE / 1024.0;

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

    /// How far the middle ray passes, and how near it must to count as meeting the vertex.
    fn off_ray(&self, b: &Bundle, real: Real) -> (f64, f64) {
        let off = size(b.d[0].cross(self.m[0]));
        (off, real.at_ray() * EDGE_UNITS * real.unit() * size(b.d[0]) * self.size_m[0])
    }
}

/// An edge against a bundle.
struct Edge<'a> {
    b: &'a Bundle,
    e: DVec3,
    /// Where the edge starts.
    v: Seen,
    size_d: [f64; 3],
    size_e: f64,
    lost_e: f64,
}

impl Edge<'_> {
    fn new(b: &Bundle, v: DVec3, w: DVec3, real: Real) -> Edge<'_> {
        let (e, unit, sizes) = (w - v, real.unit(), size(v) + size(w));
        let size_e = EDGE_UNITS * unit * (size(e) + sizes * unit);
        Edge { b, e, v: Seen::new(b, v), size_d: b.d.map(size), size_e, lost_e: STORED_UNITS * unit * sizes }
    }

    /// One coefficient of `E` and what rounding may hide of it.
    fn step(&self, terms: &[(usize, usize)]) -> (f64, f64) {
        let g = terms.iter().map(|&(k, l)| self.b.d[k].cross(self.v.m[l])).sum::<DVec3>();
        let sizes = terms.iter().map(|&(k, l)| self.size_d[k] * self.v.size_m[l]).sum::<f64>();
        (self.e.dot(g), self.size_e * sizes + self.lost_e * size(g))
    }
}

/// The side of the bundle's middle ray with respect to the edge from `v` to `w`: the sign of the first of value and
/// derivatives that is not 0 within its rounding, and 1 where all are. The value counts as 0 where the ray meets `v` or
/// `w` within rounding, for all edges at that vertex alike.
pub fn side(b: &Bundle, v: DVec3, w: DVec3, real: Real) -> Side {
    let edge = Edge::new(b, v, w, real);
    let mut doubtful = false;
    let mut met = false;
    for (off, bound) in [edge.v.off_ray(b, real), Seen::new(b, w).off_ray(b, real)] {
        met |= off <= bound;
        doubtful |= (off - bound).abs() < MEETING_SHARE * bound;
    }
    for terms in STEPS.iter().skip(usize::from(met)) {
        let (value, bound) = edge.step(terms);
        doubtful |= match real {
            Real::F64 => (value.abs() - bound).abs() < EVALUATION_SHARE * bound,
            // the kernel's f32 value is off by the bound itself
            Real::F32 => value.abs() < 2.0 * bound,
        };
        if value.abs() > bound {
            return Side { sign: value.signum() as i32, doubtful };
        }
    }
    Side { sign: 1, doubtful }
}

/// The side on which all rays within `r` px of the bundle's middle pass beyond any doubt of [`side`]; 0: not proven.
pub fn side_over(b: &Bundle, v: DVec3, w: DVec3, real: Real, r: f64) -> i32 {
    // the ray may also count as meeting the edge's far end
    let ends = [Edge::new(b, v, w, real), Edge::new(b, w, v, real)];
    let doubts = DOUBT_BOUNDS * (1.0 + real.at_ray());
    let step = |terms| {
        let [(value, from_v), (_, from_w)] = [0, 1].map(|k: usize| ends[k].step(terms));
        (value, from_v.max(from_w))
    };
    let (value, bound) = step(STEPS[0]);
    let mut room = doubts * bound;
    for (terms, scale) in STEPS.iter().zip([0.0, r, r, r * r, r * r, r * r]) {
        let (value, bound) = step(terms);
        room += scale * (value.abs() + doubts * bound);
    }
    if value.abs() > room { value.signum() as i32 } else { 0 }
}

/// [`side`] doubts values up to twice its bound; as much again for the sizes' own growth over the square.
const DOUBT_BOUNDS: f64 = 4.0;
