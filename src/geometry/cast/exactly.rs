//! Rays from anywhere, cast at a mesh without any rounding in what they meet: for users who ask for points, not pixels.
//!
//! Which triangles a ray meets is decided as if its origin were moved by (e, e^2, e^3) for an e smaller than all numbers: a ray that goes
//! into a closed surface, or out of it, through an edge or a vertex meets one triangle there. In which order it meets them, and whether t lies
//! in a range, is decided by exact fractions. Weights and t itself are rounded.
//!
//! Spheres are met by the ray itself, which hits one that it touches; t is then a fraction with a root, and as exactly compared.

use super::depth::Depth;
use super::{Aim, Hit, Met, Ray, Round, Surface, hierarchy, meet, past};
use crate::arrays::MapEach;
use crate::geometry::bvh::{Bvh, LEAF, NONE};
use crate::geometry::exact::Exact;
use crate::geometry::interleave::{KEY_BITS, interleaved};
use crate::geometry::mesh::Mesh;
use crate::parallel;
use glam::DVec3;
use std::cmp::Ordering;
use std::sync::Arc;

/// Relative error of t.
const T_ROUNDING: f64 = 1.0 / (1_u64 << 40) as f64;

/// Sizes of the coordinates, but for 0, whose products are exact: those of six, the last of an expansion's terms included, are far from the
/// ends of f64.
const EXACT_SIZES: std::ops::RangeInclusive<f64> = 1e-30..=1e30;

/// The same where there are spheres, and products of ten.
const EXACT_SIZES_OF_SPHERES: std::ops::RangeInclusive<f64> = 1e-12..=1e24;

/// A mesh indexed for such rays.
#[derive(Debug)]
pub struct ExactCaster {
    mesh: Arc<Mesh>,
    bvh: Bvh,
    leaves: Vec<Leaf>,
    /// All coordinates have such sizes.
    is_exact: bool,
    exact_sizes: std::ops::RangeInclusive<f64>,
}

impl ExactCaster {
    /// Indexes the mesh: finite positions, indices in range. A triangle without area is never met.
    pub fn new(mesh: Arc<Mesh>) -> ExactCaster {
        let exact_sizes = if mesh.has_spheres() { EXACT_SIZES_OF_SPHERES } else { EXACT_SIZES };
        let is_exact = !parallel::any(&mesh.positions, |p| !are_within(&exact_sizes, &p.to_array()))
            && are_within(&exact_sizes, &mesh.radii);
        let bvh = hierarchy(&mesh);
        let leaves = parallel::map(0..bvh.leaf_count(), |k| Leaf::new(&mesh, bvh.leaf(k)));
        ExactCaster { bvh, leaves, is_exact, exact_sizes, mesh }
    }

    /// The first hit with t in `range` (ends included): of those at the same t the one of the lowest id.
    pub fn first(&self, ray: &Ray, range: [f64; 2]) -> Option<Hit> {
        let mut best: Option<Met> = None;
        self.visit(ray, range, |met| {
            if best.as_ref().is_none_or(|b| met.compare(b, ray).is_lt()) {
                best = Some(met);
            }
            best.as_ref().map_or(f64::INFINITY, |b| past(b.hit.t, T_ROUNDING))
        });
        best.map(|met| met.hit)
    }

    /// Whether there is one.
    pub fn meets_any(&self, ray: &Ray, range: [f64; 2]) -> bool {
        let mut found = false;
        self.visit(ray, range, |_| {
            found = true;
            f64::NEG_INFINITY
        });
        found
    }

    /// All of them, in the order along the ray; those at the same t by id.
    pub fn all(&self, ray: &Ray, range: [f64; 2]) -> Vec<Hit> {
        let mut all = Vec::new();
        self.visit(ray, range, |met| {
            all.push(met);
            f64::INFINITY
        });
        all.sort_unstable_by(|a, b| a.compare(b, ray));
        all.into_iter().map(|met| met.hit).collect()
    }

    /// What `find` finds of each ray, in the order of the rays. Many are taken in another order, in which neighbours meet the same triangles.
    pub fn each<T: Send>(&self, rays: &[Ray], find: impl Fn(&Ray) -> T + Sync) -> Vec<T> {
        let is_sorted = rays.len() >= SORTED_RAYS && self.mesh.triangles.len() >= SORTED_TRIANGLES;
        let Some(bounds) = is_sorted.then(|| self.mesh.bounds()).flatten() else {
            return parallel::map(rays, find);
        };
        let mut order: Vec<(u64, u32)> = parallel::map(0..rays.len() as u32, |k| (key(&rays[k as usize], bounds), k));
        parallel::sort(&mut order);
        let found: Vec<T> = parallel::map(&order, |(_, k)| find(&rays[*k as usize]));
        let mut all: Vec<Option<T>> = rays.iter().map(|_| None).collect();
        order.iter().zip(found).for_each(|((_, k), found)| all[*k as usize] = Some(found));
        all.into_iter().flatten().collect()
    }

    /// Whether nothing was rounded in what such a ray meets.
    pub fn is_exact(&self, ray: &Ray) -> bool {
        self.is_exact && [ray.origin, ray.direction].iter().all(|v| are_within(&self.exact_sizes, &v.to_array()))
    }

    /// `None` of a triangle.
    pub fn round(&self, id: u32) -> Option<Round> {
        Round::of(&self.mesh, id)
    }

    /// Every visible triangle that the ray meets with t in `range`, and every place where it enters or leaves a sphere, mostly near to far.
    /// `visit` returns the largest t still of interest.
    fn visit(&self, ray: &Ray, range: [f64; 2], mut visit: impl FnMut(Met) -> f64) {
        let own = self.bvh.ray(ray.origin, ray.direction, [-past(-range[0], T_ROUNDING), past(range[1], T_ROUNDING)]);
        let mut limit = f64::INFINITY;
        self.bvh.walk_rays(&[own], |leaf| {
            let missed = self.leaves[leaf].is_missed(ray);
            for (id, _) in self.bvh.leaf(leaf).into_iter().zip(missed).filter(|(id, missed)| *id != NONE && !missed) {
                meet(&self.mesh, id, &Aim { ray: *ray, perturbed: *ray }, (T_ROUNDING, beside), |met| {
                    if met.is_within(range, ray) {
                        limit = limit.min(visit(met));
                    }
                });
            }
            limit
        });
    }
}

/// The corners of a leaf's triangles, by coordinates.
#[derive(Debug)]
struct Leaf {
    corners: [[[f64; LEAF]; 3]; 3],
}

/// Error of an edge value against the largest coordinates squared: at most seven roundings of half an epsilon of each of six products twice
/// as large, and as much again because of the roundings of that size.
const EDGE_ROUNDING: f64 = 14.0 * f64::EPSILON;

impl Leaf {
    /// Lanes without a triangle hold zeros.
    fn new(mesh: &Mesh, ids: [u32; LEAF]) -> Leaf {
        let mut corners = [[[0.0; LEAF]; 3]; 3];
        for (lane, id) in ids.into_iter().enumerate().filter(|(_, id)| *id != NONE) {
            for (corner, k) in corners.iter_mut().zip(mesh.triangles[id as usize]) {
                let place = mesh.positions[k as usize].to_array();
                corner.iter_mut().zip(place).for_each(|(all, x)| all[lane] = x);
            }
        }
        Leaf { corners }
    }

    /// Which triangles a ray passes by for certain: it is left of one edge and right of another.
    fn is_missed(&self, ray: &Ray) -> [bool; LEAF] {
        let (origin, d) = (ray.origin.to_array(), ray.direction.to_array());
        let mut relative = [[[0.0; LEAF]; 3]; 3];
        let mut largest = [0.0f64; LEAF];
        for (relative, corner) in relative.iter_mut().zip(&self.corners) {
            for axis in 0..3 {
                for k in 0..LEAF {
                    let x = corner[axis][k] - origin[axis];
                    relative[axis][k] = x;
                    largest[k] = if x.abs() > largest[k] { x.abs() } else { largest[k] };
                }
            }
        }
        let mut least = [f64::INFINITY; LEAF];
        let mut most = [f64::NEG_INFINITY; LEAF];
        for [a, b] in [[0, 1], [1, 2], [2, 0]].map_each(|edge| edge.map_each(|k| &relative[k])) {
            for k in 0..LEAF {
                let side = d[0] * (a[1][k] * b[2][k] - a[2][k] * b[1][k])
                    + d[1] * (a[2][k] * b[0][k] - a[0][k] * b[2][k])
                    + d[2] * (a[0][k] * b[1][k] - a[1][k] * b[0][k]);
                least[k] = if side < least[k] { side } else { least[k] };
                most[k] = if side > most[k] { side } else { most[k] };
            }
        }
        let steep = EDGE_ROUNDING * (d[0].abs() + d[1].abs() + d[2].abs());
        let mut missed = [false; LEAF];
        for k in 0..LEAF {
            let bound = steep * largest[k] * largest[k];
            missed[k] = least[k] < -bound && most[k] > bound;
        }
        missed
    }
}

/// So many rays are worth sorting, where the triangles do not stay in the nearest caches anyway.
const SORTED_RAYS: usize = 4096;
const SORTED_TRIANGLES: usize = 65_536;

/// A number that is near for rays that enter a box in near places and in near directions.
fn key(ray: &Ray, (lo, hi): (DVec3, DVec3)) -> u64 {
    let Ray { origin, direction } = *ray;
    let (a, b) = ((lo - origin) / direction, (hi - origin) / direction);
    // the components that are no number count as none
    let enter = a.min(b).to_array().into_iter().fold(0.0, f64::max);
    let place = (origin + enter * direction).clamp(lo, hi) - lo;
    let along = direction / direction.abs().max_element();
    let cells = f64::from((1 << KEY_BITS) - 1);
    interleaved([place / (hi - lo).max_element() * cells, (along + 1.0) / 2.0 * cells])
}

impl Met {
    fn depth(&self, ray: &Ray) -> Depth {
        match &self.surface {
            Surface::Triangle(corners) => Depth::fraction(corners.exact_depth(ray)),
            Surface::Round(round, on) => round.depth(ray, on),
        }
    }

    /// The order along the ray, and by id.
    fn compare(&self, other: &Met, ray: &Ray) -> Ordering {
        let [a, b] = [self.hit.t, other.hit.t];
        let by_t = if (a - b).abs() > T_ROUNDING * (a.abs() + b.abs()) {
            a.total_cmp(&b)
        } else {
            self.depth(ray).compare(&other.depth(ray))
        };
        by_t.then(self.hit.triangle.cmp(&other.hit.triangle))
    }

    fn is_within(&self, range: [f64; 2], ray: &Ray) -> bool {
        let t = self.hit.t;
        let compare_end = |end: f64| {
            if end.is_infinite() || (t - end).abs() > T_ROUNDING * (t.abs() + end.abs()) {
                return t.total_cmp(&end);
            }
            self.depth(ray).compare(&Depth::of(end))
        };
        compare_end(range[0]).is_ge() && compare_end(range[1]).is_le()
    }
}

/// The sign of `((from - P) x (to - from)) . D` where that is 0, for the origin moved by (e, e^2, e^3): of the first component of
/// `D x (to - from)` that is not 0. 0 if all are: the ray is parallel to the edge.
fn beside(ray: &Ray, from: DVec3, to: DVec3) -> f64 {
    let d = ray.direction;
    let component = |j: usize, k: usize| {
        let [a, b] = [(d[j], k), (d[k], j)];
        let part = |(d, at): (f64, usize)| Exact::product(d, to[at]).minus(&Exact::product(d, from[at]));
        part(a).minus(&part(b)).sign()
    };
    [(1, 2), (2, 0), (0, 1)].into_iter().map(|(j, k)| component(j, k)).find(|sign| *sign != 0).map_or(0.0, f64::from)
}

fn are_within(sizes: &std::ops::RangeInclusive<f64>, numbers: &[f64]) -> bool {
    numbers.iter().all(|x| *x == 0.0 || sizes.contains(&x.abs()))
}
