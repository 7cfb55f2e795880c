//! What rays meet, by code of its own: boxes in f64 that are widened, signs in f64 where its rounding leaves no doubt, and whole numbers of any
//! size elsewhere.
//!
//! The rule: a ray meets the triangles that it would meet with its origin moved by (e, e^2, e^3), e smaller than all numbers; in the order of
//! t, and of their ids where t is the same.

use crate::meshes::Closed;
use glam::DVec3;
use num_bigint::BigInt;
use std::cell::Cell;
use std::cmp::Ordering;

/// Triangles of a leaf.
const LEAF: usize = 4;

/// By how much boxes are widened: a bound of t is off by a few units of 2^-53 of numbers below 16, and so are places at that t, which are
/// below 16 as well where the ray is near the mesh.
const WIDENED: f64 = 1e-12;

/// Every coordinate is a multiple of 2^-21.
const BITS: i32 = 21;

pub struct Truth<'a> {
    mesh: &'a Closed,
    /// In order of a depth-first walk: a box, and the index after all below it.
    nodes: Vec<([DVec3; 2], usize, Option<Vec<u32>>)>,
}

/// All triangles that a ray meets, in order.
pub struct Answer {
    pub triangles: Vec<u32>,
    pub by_fractions: bool,
}

impl<'a> Truth<'a> {
    pub fn new(mesh: &'a Closed) -> Truth<'a> {
        let mut truth = Truth { mesh, nodes: Vec::new() };
        truth.add((0..mesh.triangles.len() as u32).collect());
        truth
    }

    fn corners(&self, id: u32) -> [DVec3; 3] {
        self.mesh.triangles[id as usize].map(|k| self.mesh.vertices[k as usize])
    }

    fn add(&mut self, mut ids: Vec<u32>) {
        let all = |points: &mut dyn Iterator<Item = DVec3>| {
            points.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[lo, hi], p| [lo.min(p), hi.max(p)])
        };
        let [lo, hi] = all(&mut ids.iter().flat_map(|id| self.corners(*id)));
        let own = self.nodes.len();
        self.nodes.push(([lo - WIDENED, hi + WIDENED], 0, None));
        if ids.len() <= LEAF {
            self.nodes[own].2 = Some(ids);
        } else {
            let axis = (0..3).max_by(|a, b| (hi - lo)[*a].total_cmp(&(hi - lo)[*b])).unwrap_or(0);
            let middle = |id: &u32| self.corners(*id).iter().map(|p| p[axis]).sum::<f64>();
            ids.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
            let right = ids.split_off(ids.len() / 2);
            self.add(ids);
            self.add(right);
        }
        self.nodes[own].1 = self.nodes.len();
    }

    /// Of the triangles in the boxes that the ray may enter.
    pub fn all(&self, ray: &[[f64; 3]; 2]) -> Answer {
        let [p, d] = ray.map(DVec3::from_array);
        let mut ids = Vec::new();
        let mut k = 0;
        while k < self.nodes.len() {
            let ([lo, hi], after, leaf) = &self.nodes[k];
            let (mut near, mut far) = (0.0, f64::INFINITY);
            let mut is_beside = false;
            for axis in 0..3 {
                if d[axis] == 0.0 {
                    is_beside |= p[axis] < lo[axis] || p[axis] > hi[axis];
                    continue;
                }
                let ends = [(lo[axis] - p[axis]) / d[axis], (hi[axis] - p[axis]) / d[axis]];
                near = ends[0].min(ends[1]).max(near);
                far = ends[0].max(ends[1]).min(far);
            }
            if is_beside || near > far + WIDENED * (1.0 + far.abs()) {
                k = *after;
                continue;
            }
            ids.extend(leaf.iter().flatten().copied());
            k += 1;
        }
        self.met(&ids, p, d)
    }

    /// Of all triangles.
    pub fn by_all(&self, ray: &[[f64; 3]; 2]) -> Vec<u32> {
        let ids: Vec<u32> = (0..self.mesh.triangles.len() as u32).collect();
        let [p, d] = ray.map(DVec3::from_array);
        self.met(&ids, p, d).triangles
    }

    fn met(&self, ids: &[u32], p: DVec3, d: DVec3) -> Answer {
        let by_fractions = Cell::new(false);
        let mut met: Vec<u32> =
            ids.iter().copied().filter(|id| is_met(self.corners(*id), p, d, &by_fractions)).collect();
        met.sort_by(|a, b| by_depth(self.corners(*a), self.corners(*b), p, d, &by_fractions).then(a.cmp(b)));
        Answer { triangles: met, by_fractions: by_fractions.get() }
    }
}

/// Rounding of a determinant of differences of coordinates below 8, each exact: products of three numbers below 16, six of them, in ten
/// operations of 2^-53: below 10 x 6 x 4096 x 2^-53.
const DETERMINANT_ROUNDING: f64 = 10.0 * 6.0 * 4096.0 / (1u64 << 53) as f64;

fn is_met(corners: [DVec3; 3], p: DVec3, d: DVec3, by_fractions: &Cell<bool>) -> bool {
    let mut signs = [Ordering::Equal; 3];
    for (sign, [i, j]) in signs.iter_mut().zip([[0, 1], [1, 2], [2, 0]]) {
        let (a, b) = (corners[i] - p, corners[j] - p);
        let value = d.dot(a.cross(b));
        *sign = if value.abs() > DETERMINANT_ROUNDING {
            value.total_cmp(&0.0)
        } else {
            by_fractions.set(true);
            exact_side(corners[i], corners[j], p, d)
        };
    }
    signs[0] != Ordering::Equal && signs.iter().all(|sign| *sign == signs[0]) && !is_behind(corners, p, d, by_fractions)
}

/// The sign of `D . ((a - P) x (b - P))` with P moved: of what comes first in powers of e.
fn exact_side(a: DVec3, b: DVec3, p: DVec3, d: DVec3) -> Ordering {
    let [a, b, p, d] = [a, b, p, d].map(big);
    let value = dot(&d, &cross(&minus(&a, &p), &minus(&b, &p)));
    // moving P by one unit along an axis adds that component of D x (b - a)
    let slopes = cross(&d, &minus(&b, &a));
    let zero = BigInt::from(0);
    [value].iter().chain(slopes.iter()).map(|v| v.cmp(&zero)).find(|sign| sign.is_ne()).unwrap_or(Ordering::Equal)
}

/// The numerator and the denominator of t as whole numbers; the denominator is positive.
fn exact_depth(corners: [DVec3; 3], p: DVec3, d: DVec3) -> [BigInt; 2] {
    let [a, b, c] = corners.map(big);
    let normal = cross(&minus(&b, &a), &minus(&c, &a));
    let (above, below) = (dot(&normal, &minus(&a, &big(p))), dot(&normal, &big(d)));
    if below < BigInt::from(0) { [-above, -below] } else { [above, below] }
}

fn is_behind(corners: [DVec3; 3], p: DVec3, d: DVec3, by_fractions: &Cell<bool>) -> bool {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a);
    let (above, below) = (normal.dot(a - p), normal.dot(d));
    if above.abs() > DETERMINANT_ROUNDING && below.abs() > DETERMINANT_ROUNDING {
        return above.signum() != below.signum();
    }
    by_fractions.set(true);
    exact_depth(corners, p, d)[0] < BigInt::from(0)
}

fn by_depth(a: [DVec3; 3], b: [DVec3; 3], p: DVec3, d: DVec3, by_fractions: &Cell<bool>) -> Ordering {
    // t, and a bound on its error: twice what both determinants bring
    let depth = |[a, b, c]: [DVec3; 3]| {
        let normal = (b - a).cross(c - a);
        let (above, below) = (normal.dot(a - p), normal.dot(d));
        let t = above / below;
        (t, 2.0 * t.abs() * (DETERMINANT_ROUNDING / above.abs() + DETERMINANT_ROUNDING / below.abs()))
    };
    let (own, other) = (depth(a), depth(b));
    if (own.0 - other.0).abs() > own.1 + other.1 && own.1 + other.1 < 0.1 {
        return own.0.total_cmp(&other.0);
    }
    by_fractions.set(true);
    let ([n, m], [k, l]) = (exact_depth(a, p, d), exact_depth(b, p, d));
    (n * l).cmp(&(k * m))
}

type Big3 = [BigInt; 3];

/// In units of 2^-21.
fn big(v: DVec3) -> Big3 {
    v.to_array().map(|x| {
        let units = x * f64::from(1 << BITS);
        assert!(units.fract() == 0.0 && units.abs() < 1e15, "{x} is no multiple of 2^-{BITS}");
        BigInt::from(units as i64)
    })
}

fn minus(a: &Big3, b: &Big3) -> Big3 {
    [0, 1, 2].map(|k| &a[k] - &b[k])
}

fn cross(a: &Big3, b: &Big3) -> Big3 {
    [(1, 2), (2, 0), (0, 1)].map(|(j, k)| &a[j] * &b[k] - &a[k] * &b[j])
}

fn dot(a: &Big3, b: &Big3) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}
