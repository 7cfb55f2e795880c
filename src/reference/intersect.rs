//! One ray against one triangle: sides of edges, ties, depth and weights.
//!
//! With `E_ij = ((v_i h - p) x (v_j - v_i)) . d` for the edge from `v_i` to `v_j`, a ray hits where `E_01`,
//! `E_12` and `E_20` have one sign. Each edge is evaluated from its smaller to its larger end (by position),
//! so that both triangles at an edge see one value. Signs are those of exact arithmetic: f64 where its
//! rounding bound proves them, [`exact`] sums elsewhere.
//!
//! The signs are those of the perturbed ray ([`crate::camera::perturb`]), so that an exact edge hit at the pixel's centre is
//! decided the same way here and in the kernels, however either rounds. Where the perturbed ray meets an edge line too, it is moved by
//! one infinitesimal step of its pixel: dx, far smaller dy, with dx >> dy >> dx^2 >> dx dy >> dy^2 (say dy = dx^1.5), so
//! the first non-zero derivative in that order decides, for all triangles alike. Signs so found belong to one true
//! configuration: no ray slips through a closed fan, none hits it twice.

use crate::arrays::MapEach;
use crate::camera::bundle::Bundle;
use crate::camera::perturb::{EDGE_ON, END_REACH, PERTURB};
use crate::geometry::exact::{self, Exact};
use glam::DVec3;

/// Bound of the error of an edge value, a numerator or a denominator, against the sum of its terms'
/// magnitudes: at most eight roundings of half an epsilon on the way from input to sum (difference, weight,
/// two of the cross product, its sum, the dot product's product and two sums), and a quarter more for
/// taking the magnitudes from rounded values.
pub const TERM_ROUNDING: f64 = 5.0 * f64::EPSILON;

/// The relative error of every `t`: numerator and denominator that f64 does not prove to half of this are
/// summed exactly. About 1e-9, far under the smallest gap in `t` that counts, 1e-6.
pub const T_ROUNDING: f64 = 1.0 / (1_u64 << 30) as f64;

/// A triangle's positions in ascending order, and how they lay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corners {
    /// Ascending by x, then y, then z.
    pub v: [DVec3; 3],
    /// Place of each in the triangle as given.
    slot: [u8; 3],
    /// 1 when the order is an even permutation of the given one, else -1.
    pub parity: i8,
}

/// Where a ray or a curve meets a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting {
    pub t: f64,
    /// The sign of the triangle's `E`s and of `N . D`, of its own winding: -1 where the front is seen, 0 where a curve
    /// touches the triangle.
    pub sign: i8,
    /// Weights of the second and third vertex as given.
    pub bary: [f64; 2],
}

/// The opposite edge of each corner, as (from, to, its sign in the cycle 0 -> 1 -> 2).
pub const OPPOSITE: [(usize, usize, i8); 3] = [(1, 2, 1), (0, 2, -1), (0, 1, 1)];

fn precedes(a: DVec3, b: DVec3) -> bool {
    (a.x, a.y, a.z) < (b.x, b.y, b.z)
}

impl Corners {
    pub fn new(given: [DVec3; 3]) -> Corners {
        let mut c = Corners { v: given, slot: [0, 1, 2], parity: 1 };
        for (i, j) in [(0, 1), (1, 2), (0, 1)] {
            if precedes(c.v[j], c.v[i]) {
                c.v.swap(i, j);
                c.slot.swap(i, j);
                c.parity = -c.parity;
            }
        }
        c
    }

    /// Two corners are in one place.
    pub fn is_degenerate(&self) -> bool {
        self.v[0] == self.v[1] || self.v[1] == self.v[2]
    }

    /// Place of sorted corner `k` in the triangle as given.
    pub fn slot(&self, k: usize) -> usize {
        self.slot[k].into()
    }

    /// Weights of the second and third vertex as given where a ray meets the plane, and by how much they change if the ray moves by
    /// `distance`; NaN where it runs along the plane.
    pub fn weights_on_plane(&self, origin: DVec3, direction: DVec3, distance: f64) -> ([f64; 2], f64) {
        let edge = |(i, j, sense): (usize, usize, i8)| {
            f64::from(sense) * (self.v[i] - origin).cross(self.v[j] - self.v[i]).dot(direction)
        };
        let e = OPPOSITE.map_each(edge);
        let mut weights = [0.0; 3];
        let sum = e[0] + e[1] + e[2];
        (0..3).for_each(|k| weights[self.slot(k)] = e[k] / sum);
        let edges = OPPOSITE.map_each(|(i, j, _)| (self.v[j] - self.v[i]).length());
        let change = distance * (edges[0] + edges[1] + edges[2]) * direction.length() / sum.abs();
        ([weights[1], weights[2]], change)
    }

    pub fn bounds(&self) -> (DVec3, DVec3) {
        let [a, b, c] = self.v;
        (a.min(b).min(c), a.max(b).max(c))
    }
}

/// Magnitudes that bound the terms of `v h - p`: the difference itself, and the product unless it is exact.
pub fn offset_size(v: DVec3, p: DVec3, h: f64) -> DVec3 {
    let size = (v * h - p).abs();
    if h == 0.0 || h == 1.0 { size } else { size + (v * h).abs() }
}

/// `a x b` with every term's magnitude added up.
pub fn cross_size(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x)
}

/// `E` of the edge `from -> to` for the central ray: value, and sign where proven, else 0.
fn edge_in_f64(b: &Bundle, from: DVec3, to: DVec3) -> (f64, i8) {
    let (p, d, h) = (b.p[0], b.d[0], b.h[0]);
    let edge = to - from;
    let value = (from * h - p).cross(edge).dot(d);
    let bound = TERM_ROUNDING * cross_size(offset_size(from, p, h), edge.abs()).dot(d.abs());
    (value, if value > bound { 1 } else { -i8::from(value < -bound) })
}

/// A pixel's rays: those about its centre for depths and weights, the perturbed ones for coverage.
#[derive(Debug, Clone, Copy)]
pub struct Aim {
    pub centre: Bundle,
    pub perturbed: Bundle,
    /// Largest distance between the two in x or y, px.
    pub px: f64,
}

impl Aim {
    /// In a scene of this size.
    pub fn new(centre: Bundle, scene_size: f64) -> Aim {
        let (perturbed, px) = centre.perturbed(scene_size);
        Aim { centre: centre.sloping(), perturbed, px }
    }

    /// One ray, not perturbed.
    pub fn straight(centre: Bundle) -> Aim {
        Aim { centre, perturbed: centre, px: 0.0 }
    }
}

/// The exact coefficients of `E(x, y)`: `F(a, b)` pairs the `a`-th part of `(p, h)` with the `b`-th of `d`.
struct ExactEdge<'b> {
    bundle: &'b Bundle,
    from: DVec3,
    to: DVec3,
}

impl ExactEdge<'_> {
    /// `h_a (from x to) . d_b - (p_a x (to - from)) . d_b`.
    fn term(&self, a: usize, b: usize) -> Exact {
        let (p, d, h) = (self.bundle.p[a], self.bundle.d[b], self.bundle.h[a]);
        let moment = exact::dot(&exact::cross(self.from, self.to), d).times(h);
        moment.minus(&exact::dot(&exact::cross(p, self.to), d)).plus(&exact::dot(&exact::cross(p, self.from), d))
    }

    /// The central value, and the sign next to it: of the value, else of the first non-zero of dx, dy, dxx,
    /// dxy, dyy, else 1.
    fn value_and_sign(&self) -> (f64, i8) {
        let value = self.term(0, 0);
        let parts: [&[(usize, usize)]; 5] =
            [&[(0, 1), (1, 0)], &[(0, 2), (2, 0)], &[(1, 1)], &[(1, 2), (2, 1)], &[(2, 2)]];
        let derivative =
            |pairs: &[(usize, usize)]| pairs.iter().fold(Exact::default(), |s, &(a, b)| s.plus(&self.term(a, b)));
        let sign = std::iter::once(value.sign())
            .chain(parts.iter().map(|pairs| derivative(pairs).sign()))
            .find(|&s| s != 0)
            .unwrap_or(1);
        (value.value(), sign)
    }
}

/// `E` of an edge for the bundle's central ray, and its sign, never 0.
fn edge_side(b: &Bundle, from: DVec3, to: DVec3) -> (f64, i8) {
    match edge_in_f64(b, from, to) {
        (_, 0) => ExactEdge { bundle: b, from, to }.value_and_sign(),
        proven => proven,
    }
}

/// The sign of a triangle's `E`s, of its own winding, for the bundle's central ray; 0 where they differ: outside.
pub fn sign_of(b: &Bundle, c: &Corners) -> i8 {
    let mut sign = OPPOSITE.map_each(|(i, j, sense)| edge_in_f64(b, c.v[i], c.v[j]).1 * sense);
    for (k, (i, j, sense)) in OPPOSITE.into_iter().enumerate() {
        if sign.contains(&1) && sign.contains(&-1) {
            return 0;
        }
        if sign[k] == 0 {
            sign[k] = edge_side(b, c.v[i], c.v[j]).1 * sense;
        }
    }
    if sign == [sign[0]; 3] { sign[0] * c.parity } else { 0 }
}

/// The ray of a pixel against the triangle, any `t`. `h > 0`.
pub fn meet(aim: &Aim, c: &Corners) -> Option<Meeting> {
    let sign = sign_of(&aim.perturbed, c);
    if sign == 0 {
        return None;
    }
    let t = match is_edge_on(&aim.centre, c) {
        true => depth(&aim.centre, c).and_then(|_| depth_between(&aim.perturbed, c))?,
        false => depth(&aim.centre, c)?,
    };
    let inside = f64::from(sign * c.parity);
    // the perturbed ray is inside; the centre's may be outside by the perturbation
    let e = OPPOSITE
        .map_each(|(i, j, sense)| (inside * f64::from(sense) * edge_side(&aim.centre, c.v[i], c.v[j]).0).max(0.0));
    let sum = e[0] + e[1] + e[2];
    let mut weight = [0.0; 3];
    for (k, e) in e.into_iter().enumerate() {
        weight[c.slot(k)] = if sum == 0.0 { 1.0 / 3.0 } else { e / sum };
    }
    Some(Meeting { t, sign, bary: [weight[1], weight[2]] })
}

/// `t = N . (v_0 h - p) / (N . d)` of the sorted corners, within [`T_ROUNDING`] of itself; `None` where the
/// ray is parallel to the plane.
fn depth(b: &Bundle, c: &Corners) -> Option<f64> {
    let (p, d, h) = (b.p[0], b.d[0], b.h[0]);
    let (e1, e2) = (c.v[1] - c.v[0], c.v[2] - c.v[0]);
    let normal = e1.cross(e2);
    let normal_size = cross_size(e1.abs(), e2.abs());
    let (above, below) = (normal.dot(c.v[0] * h - p), normal.dot(d));
    let above_bound = TERM_ROUNDING * normal_size.dot(offset_size(c.v[0], p, h));
    let below_bound = TERM_ROUNDING * normal_size.dot(d.abs());
    if above_bound < 0.25 * T_ROUNDING * above.abs() && below_bound < 0.25 * T_ROUNDING * below.abs() {
        return Some(above / below);
    }
    let [a, bb, cc] = c.v;
    let moment = exact::cross(bb, cc);
    let volume = exact::dot(&moment, a).times(h);
    let normal = exact::sum(exact::sum(exact::cross(a, bb), &moment), &exact::cross(cc, a));
    let below = exact::dot(&normal, d).value();
    (below != 0.0).then(|| volume.minus(&exact::dot(&normal, p)).value() / below)
}

/// The end of `t_range` at which a hit at `t` counts as a hit (`docs/reference/definitions.md`, Ends of t_range). `h > 0`.
pub fn end_at(b: &Bundle, c: &Corners, t: f64, t_range: [f64; 2], scene_size: f64) -> Option<f64> {
    if is_edge_on(b, c) {
        return None;
    }
    let (p, d, h) = (b.p[0], b.d[0], b.h[0]);
    let normal = (c.v[1] - c.v[0]).cross(c.v[2] - c.v[0]);
    let tolerance = plane_tolerance(normal, scene_size) * h;
    let is_on_plane = |end: f64| normal.dot(c.v[0] * h - p - end * d).abs() <= tolerance;
    let is_near = |end: f64| (t - end).abs() * d.abs().element_sum() <= END_REACH * scene_size * h;
    t_range.into_iter().find(|end| end.is_finite() && is_near(*end) && is_on_plane(*end))
}

/// The bundle's central ray runs almost along the triangle's plane.
pub fn is_edge_on(b: &Bundle, c: &Corners) -> bool {
    let size = |v: DVec3| v.abs().element_sum();
    let normal = (c.v[1] - c.v[0]).cross(c.v[2] - c.v[0]);
    normal.dot(b.d[0]).abs() < EDGE_ON * size(normal) * size(b.d[0])
}

/// The `t` at which the central ray, which passes between the corners, is nearest to their mean by the weights of its point in the triangle.
fn depth_between(b: &Bundle, c: &Corners) -> Option<f64> {
    let d = b.d[0];
    let e = OPPOSITE.map_each(|(i, j, _)| edge_side(b, c.v[i], c.v[j]).0.abs());
    let sum = e[0] + e[1] + e[2];
    let along = |k: usize| (c.v[k] * b.h[0] - b.p[0]).dot(d) / d.length_squared();
    (sum > 0.0).then(|| (0..3).map(|k| e[k] / sum * along(k)).sum())
}

/// The largest `N . (v_0 - X)` of a point `X` that counts as on the plane.
pub fn plane_tolerance(normal: DVec3, scene_size: f64) -> f64 {
    PERTURB * scene_size * normal.abs().element_sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Rng;

    fn looking_down_z(x: f64, y: f64) -> Bundle {
        Bundle {
            p: [DVec3::new(x, y, 0.0), DVec3::X, DVec3::Y],
            d: [DVec3::Z, DVec3::ZERO, DVec3::ZERO],
            h: [1.0, 0.0, 0.0],
        }
    }

    fn looking(x: f64, y: f64) -> Aim {
        Aim::straight(looking_down_z(x, y))
    }

    #[test]
    fn weights_and_depth_are_of_the_vertices_as_given() {
        let v = [DVec3::new(4.0, 0.0, 3.0), DVec3::new(0.0, 0.0, 1.0), DVec3::new(0.0, 4.0, 5.0)];
        for (order, sign) in [([0, 1, 2], -1), ([1, 2, 0], -1), ([0, 2, 1], 1), ([2, 1, 0], 1)] {
            let m = meet(&looking(1.0, 2.0), &Corners::new(order.map(|k| v[k]))).unwrap();
            let weight = [0.25, 0.25, 0.5];
            assert_eq!(m.bary, [weight[order[1]], weight[order[2]]]);
            assert_eq!(m.t, 0.25 * 3.0 + 0.25 * 1.0 + 0.5 * 5.0);
            assert_eq!(m.sign, sign);
        }
    }

    /// Notices a bound that is too small, or ten times larger than it need be.
    #[test]
    fn the_error_of_an_edge_value_is_under_its_bound_and_not_far_under() {
        let mut rng = Rng(1);
        let mut vector = || rng.vector();
        let mut worst = 0.0_f64;
        for _ in 0..20_000 {
            let b = Bundle { p: [vector(); 3], d: [vector(); 3], h: [1.0 + 0.1 * vector().x, 0.0, 0.0] };
            let (from, to) = (vector(), vector());
            let (value, _) = edge_in_f64(&b, from, to);
            let exact = ExactEdge { bundle: &b, from, to }.term(0, 0).minus(&Exact::product(value, 1.0)).value();
            let size = cross_size(offset_size(from, b.p[0], b.h[0]), (to - from).abs()).dot(b.d[0].abs());
            worst = worst.max(exact.abs() / (TERM_ROUNDING * size));
        }
        assert!(worst < 1.0 && worst > 0.1, "{worst}");
    }

    #[test]
    fn depth_is_as_exact_as_promised() {
        let mut rng = Rng(5);
        for k in 0..20_000 {
            // Nearly parallel to the ray, or nearly through its origin, by 2^-10 to 2^-50.
            let tiny = 0.5_f64.powi(10 + k % 41);
            let (x, y) = (DVec3::new(1.0, rng.signed(), rng.signed()), DVec3::new(rng.signed(), 1.0, rng.signed()));
            let d = x + rng.signed() * y + tiny * DVec3::Z;
            let at = rng.signed() * x + rng.signed() * y + DVec3::Z * [1.0, tiny][(k % 2) as usize];
            let c = Corners::new([at, at + x, at + y]);
            let b = Bundle { p: [DVec3::ZERO; 3], d: [d; 3], h: [1.0, 0.0, 0.0] };
            let [v0, v1, v2] = c.v;
            let normal = exact::sum(exact::sum(exact::cross(v0, v1), &exact::cross(v1, v2)), &exact::cross(v2, v0));
            // t (N . d) - N . v0 without rounding.
            let t = depth(&b, &c).unwrap();
            let above = exact::dot(&normal, v0);
            let rest = exact::dot(&normal, d).times(t).minus(&above).value();
            assert!(rest.abs() <= T_ROUNDING * above.value().abs(), "{k}: {rest} of {}", above.value());
        }
    }

    /// The slits of this camera are 10^-12 apart, and triangles between them and the image lie in a plane through both. The unperturbed ray meets
    /// the plane where it starts, far from the triangle.
    #[test]
    fn a_triangle_seen_edge_on_is_met_where_it_is() {
        let (slope, apart) = (0.0625, 6.48e-13);
        let c = Corners::new([DVec3::new(0.9, 0.9, -1.0), DVec3::new(0.0, 0.0, -0.5), DVec3::new(0.9, 0.9, -0.5)]);
        let mut met = 0;
        for k in 1..40 {
            let at = f64::from(k) / 32.0;
            let b = Bundle {
                p: [DVec3::new(at, at, 2.0), slope * DVec3::X, -slope * DVec3::Y],
                d: [DVec3::new(-at * (1.0 + apart), -at, -4.0), -slope * (1.0 + apart) * DVec3::X, slope * DVec3::Y],
                h: [1.0, 0.0, 0.0],
            };
            let aim = Aim::new(b, 16.0);
            assert!(is_edge_on(&aim.centre, &c) && depth(&aim.centre, &c) == Some(0.0));
            if let Some(m) = meet(&aim, &c) {
                met += 1;
                assert!((0.625..=0.75).contains(&m.t), "{k}: {}", m.t);
            }
        }
        assert!(met >= 3, "{met}");
    }

    #[test]
    fn a_ray_on_an_edge_belongs_to_the_side_it_is_moved_to() {
        let left = Corners::new([DVec3::ZERO, DVec3::new(-1.0, 0.0, 0.0), DVec3::new(0.0, 1.0, 0.0)]);
        let right = Corners::new([DVec3::ZERO, DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 1.0, 0.0)]);
        let on = looking_down_z(0.0, 0.5);
        assert!(meet(&Aim::straight(on), &left).is_none());
        assert_eq!(meet(&Aim::straight(on), &right).unwrap().bary, [0.0, 0.5]);
        assert!(meet(&looking(1.0, 0.0), &right).is_none());
    }

    #[test]
    fn second_derivatives_decide_where_the_first_vanish() {
        // The edge from 0 to Z: E = p_x d_y - p_y d_x.
        let sign = |px: [f64; 2], dy: [f64; 2]| {
            let b = Bundle {
                p: [DVec3::ZERO, DVec3::X * px[0], DVec3::X * px[1]],
                d: [DVec3::Z, DVec3::Y * dy[0], DVec3::Y * dy[1]],
                h: [1.0, 0.0, 0.0],
            };
            ExactEdge { bundle: &b, from: DVec3::ZERO, to: DVec3::Z }.value_and_sign()
        };
        let (x, y) = ([1.0, 0.0], [0.0, 1.0]);
        for (p, d, expected) in [
            (x, x, 1),
            (x, [-1.0, 9.0], -1),
            (x, y, 1),
            ([0.0, -1.0], [1.0, 9.0], -1),
            (y, y, 1),
            ([0.0, -1.0], y, -1),
            ([0.0, 0.0], y, 1),
        ] {
            assert_eq!(sign(p, d), (0.0, expected), "{p:?} {d:?}");
        }
    }

    #[test]
    fn an_edge_on_triangle_and_one_without_area_are_never_hit() {
        let upright = Corners::new([DVec3::ZERO, DVec3::X, DVec3::new(0.5, 0.0, 1.0)]);
        assert!(meet(&looking(0.5, 0.0), &upright).is_none());
        let line = [DVec3::new(0.1, 0.1, 0.1), DVec3::splat(0.3), DVec3::splat(0.7)];
        assert!(meet(&looking(0.2, 0.2), &Corners::new(line)).is_none());
        assert!(Corners::new([DVec3::X, DVec3::ZERO, DVec3::X]).is_degenerate());
        // The ray through a nearly edge-on triangle still has an exact depth.
        let tilted = Corners::new([DVec3::ZERO, DVec3::X, DVec3::new(0.5, 2.0_f64.powi(-60), 1.0)]);
        assert_eq!(meet(&looking(0.5, 2.0_f64.powi(-61)), &tilted).unwrap().t, 0.5);
    }
}
