//! A triangle's edges and plane against rays, in f64 where its rounding leaves no doubt and in exact arithmetic elsewhere.

use super::Ray;
use crate::arrays::MapEach;
use crate::geometry::exact::{self, Exact};
use glam::DVec3;

/// Error of an edge value or of a numerator of t, against the sum of its terms' magnitudes: at most seven roundings of half an epsilon
/// (two differences, two of the cross product, the dot product's product and two sums), and less than half as much again because the
/// magnitudes are rounded too.
pub const TERM_ROUNDING: f64 = 5.0 * f64::EPSILON;

/// A triangle's corners in ascending order by x, y and z, so that both triangles at an edge compute one value.
pub struct Corners {
    v: [DVec3; 3],
    /// Place of each in the triangle as given.
    slot: [usize; 3],
    /// -1 where the order is an odd permutation of the given one, else 1.
    pub parity: f64,
}

/// The edge opposite to each corner, from its smaller to its larger end, and its sign in the cycle 0, 1, 2.
const OPPOSITE: [(usize, usize, f64); 3] = [(1, 2, 1.0), (0, 2, -1.0), (0, 1, 1.0)];

impl Corners {
    pub fn new(given: [DVec3; 3]) -> Corners {
        let mut slot = [0, 1, 2];
        slot.sort_by(|a, b| given[*a].to_array().partial_cmp(&given[*b].to_array()).expect("positions are finite"));
        let even = [[0, 1, 2], [1, 2, 0], [2, 0, 1]].contains(&slot);
        Corners { v: slot.map_each(|k| given[k]), slot, parity: if even { 1.0 } else { -1.0 } }
    }

    /// The sign of all edge values of a ray that meets the triangle; `of_zero` gives the sign of one that is exactly 0, from the ray and the
    /// edge's smaller and larger end, or 0.
    pub fn sign(&self, ray: &Ray, of_zero: impl Fn(&Ray, DVec3, DVec3) -> f64) -> Option<f64> {
        let side = |k: usize| {
            let (i, j, sense) = OPPOSITE[k];
            let (from, to) = (self.v[i], self.v[j]);
            let (value, bound) = edge(ray, from, to);
            if value.abs() > bound {
                return sense * value.signum();
            }
            match exact_edge(ray, from, to).sign() {
                0 => sense * of_zero(ray, from, to),
                sign => sense * f64::from(sign),
            }
        };
        let first = side(0);
        (first != 0.0 && side(1) == first && side(2) == first).then_some(first)
    }

    /// `t = N . (v - P) / (N . D)` to within `rounding` of itself; `None` where the ray is parallel to the plane.
    pub fn depth(&self, ray: &Ray, rounding: f64) -> Option<f64> {
        let [a, b, c] = self.v;
        let (e1, e2) = (b - a, c - a);
        let normal = e1.cross(e2);
        let size = cross_size(e1.abs(), e2.abs());
        let (above, below) = (normal.dot(a - ray.origin), normal.dot(ray.direction));
        let bounds = [size.dot((a - ray.origin).abs()), size.dot(ray.direction.abs())].map_each(|s| TERM_ROUNDING * s);
        if bounds[0] < 0.25 * rounding * above.abs() && bounds[1] < 0.25 * rounding * below.abs() {
            return Some(above / below);
        }
        let [above, below] = self.exact_depth(ray);
        let below = below.value();
        (below != 0.0).then(|| above.value() / below)
    }

    /// The numerator and the denominator of t.
    pub fn exact_depth(&self, ray: &Ray) -> [Exact; 2] {
        let [a, b, c] = self.v;
        let moment = exact::cross(b, c);
        let volume = exact::dot(&moment, a);
        let normal = exact::sum(exact::sum(exact::cross(a, b), &moment), &exact::cross(c, a));
        [volume.minus(&exact::dot(&normal, ray.origin)), exact::dot(&normal, ray.direction)]
    }

    /// Weights of the second and third corner as given. A perturbed ray may be inside where this one is outside, by rounding.
    pub fn weights(&self, ray: &Ray, sign: f64) -> [f64; 2] {
        let e = OPPOSITE.map_each(|(i, j, sense)| {
            let (value, bound) = edge(ray, self.v[i], self.v[j]);
            let value = if value.abs() > bound { value } else { exact_edge(ray, self.v[i], self.v[j]).value() };
            (sign * sense * value).max(0.0)
        });
        let sum = e[0] + e[1] + e[2];
        let mut weights = [0.0; 3];
        (0..3).for_each(|k| weights[self.slot[k]] = if sum == 0.0 { 1.0 / 3.0 } else { e[k] / sum });
        [weights[1], weights[2]]
    }
}

/// `((from - P) x (to - from)) . D` and a bound of its error.
fn edge(ray: &Ray, from: DVec3, to: DVec3) -> (f64, f64) {
    let (p, edge) = (from - ray.origin, to - from);
    (p.cross(edge).dot(ray.direction), TERM_ROUNDING * cross_size(p.abs(), edge.abs()).dot(ray.direction.abs()))
}

fn exact_edge(ray: &Ray, from: DVec3, to: DVec3) -> Exact {
    let Ray { origin: p, direction: d } = *ray;
    let moment = exact::dot(&exact::cross(from, to), d);
    moment.minus(&exact::dot(&exact::cross(p, to), d)).plus(&exact::dot(&exact::cross(p, from), d))
}

/// `a x b` with every term's magnitude added up.
pub fn cross_size(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x)
}
