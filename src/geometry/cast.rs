//! Rays cast at a mesh, in f64: for cameras that look at the scene when they are built.
//!
//! Coverage is tested in exact arithmetic: a ray through the edge of two triangles hits exactly one. An exact 0 counts as positive
//! for the edge from its smaller to its larger vertex. For a ray that may hit a vertex, coverage is tested with a ray beside it
//! ([`Aim`]). The relative error of depths is at most 1e-9. Whether a ray meets a sphere or capsule is decided exactly, by the ray itself.

mod corners;
mod depth;
mod exactly;
mod round;

use crate::arrays::MapEach;
pub use exactly::ExactCaster;

use super::bvh::{Aabb, Bvh, NONE};
use super::mesh::Mesh;
use super::opacity::Threshold;
use super::primitive::Primitive;
use crate::parallel;
use corners::Corners;
use glam::DVec3;
pub use round::{OnRound, Round};

/// A ray `X(t) = origin + t * direction`, world units; the direction need not be unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    pub origin: DVec3,
    pub direction: DVec3,
}

/// A ray, and the perturbed ray that decides its coverage.
#[derive(Debug, Clone, Copy)]
pub struct Aim {
    /// Depths and weights are this ray's.
    pub ray: Ray,
    /// Decides which triangles are hit.
    pub perturbed: Ray,
}

/// The hit of a ray on a primitive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The ray parameter, or a distance for distance queries.
    pub t: f64,
    /// Its index in the mesh.
    pub triangle: u32,
    /// Weights of the triangle's second and third vertex; 0 of a sphere or capsule.
    pub bary: [f64; 2],
}

/// A mesh indexed for ray queries.
#[derive(Debug)]
pub struct Caster<'a> {
    mesh: &'a Mesh,
    bvh: Bvh,
}

/// Relative error of t.
const T_ROUNDING: f64 = 1.0 / (1_u64 << 30) as f64;
/// By how much a distance to a triangle may be off, against the coordinates: three products and two sums make a point of it, a
/// difference and a length the distance.
const DISTANCE_ROUNDING: f64 = 8.0 * f64::EPSILON;

impl<'a> Caster<'a> {
    /// Indexes the mesh: finite positions, indices in range. A triangle with two corners in one place is never met; a sphere is.
    pub fn new(mesh: &'a Mesh) -> Caster<'a> {
        Caster { mesh, bvh: hierarchy(mesh) }
    }

    /// The first visible hit with t in `range` (ends included): the lowest id among equals.
    pub fn first(&self, aim: &Aim, range: [f64; 2]) -> Option<Hit> {
        let mut best = None;
        self.each(aim, range, |hit| {
            best = nearer(best, hit);
            best.map_or(f64::INFINITY, |b: Hit| past(b.t, T_ROUNDING))
        });
        best
    }

    /// Every visible hit with t in `range`, mostly near to far. `visit` returns the largest t still of interest.
    fn each(&self, aim: &Aim, range: [f64; 2], mut visit: impl FnMut(Hit) -> f64) {
        let mut limit = f64::INFINITY;
        let ends = [-past(-range[0], T_ROUNDING), past(range[1], T_ROUNDING)];
        // where either ray may be
        let rays = [&aim.ray, &aim.perturbed].map_each(|ray| self.bvh.ray(ray.origin, ray.direction, ends));
        self.bvh.walk_rays(&rays, |leaf| {
            for id in self.items(leaf) {
                meet(self.mesh, id, aim, (T_ROUNDING, |_, _, _| 1.0), |Met { hit, .. }| {
                    if range[0] <= hit.t && hit.t <= range[1] {
                        limit = limit.min(visit(hit));
                    }
                });
            }
            limit
        });
    }

    fn items(&self, leaf: usize) -> impl Iterator<Item = u32> {
        self.bvh.leaf(leaf).into_iter().filter(|id| *id != NONE)
    }

    /// Of all places `of` the mesh that a line meets on either side of its origin, the nearest; `t` is the distance. The two rays start
    /// there, and their directions are opposite unit vectors.
    pub fn on_line(&self, rays: [&Aim; 2], of: impl Fn(&Hit) -> bool) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        for aim in rays {
            self.each(aim, [0.0, f64::INFINITY], |hit| {
                if of(&hit) {
                    best = nearer(best, hit);
                }
                best.map_or(f64::INFINITY, |b| past(b.t, T_ROUNDING))
            });
        }
        best
    }

    /// Of all primitives the places `of` the mesh that are nearest to `place`, by ascending id: several where it is nearest to an
    /// edge or a corner. `t` is the distance.
    pub fn nearest(&self, place: DVec3, of: impl Fn(&Hit) -> bool) -> Vec<Hit> {
        let mut hits = Vec::new();
        let mut limit = f64::INFINITY;
        self.bvh.walk_from(place, |leaf| {
            for id in self.items(leaf) {
                let hit = self.nearest_of(place, id);
                if of(&hit) {
                    limit = limit.min(as_near(place, hit.t));
                    hits.push(hit);
                }
            }
            limit
        });
        hits.retain(|hit| hit.t <= limit);
        hits.sort_unstable_by_key(|hit| hit.triangle);
        hits
    }

    fn nearest_of(&self, place: DVec3, id: u32) -> Hit {
        let corners = self.mesh.triangles[id as usize].map_each(|k| self.mesh.positions[k as usize]);
        let bary = nearest_weights(place, corners);
        let [a, b, c] = corners;
        if let Primitive::Round(capsule) = self.mesh.primitive(id) {
            let t = ((capsule.nearest(place) - place).length() - capsule.radius).abs();
            return Hit { t, triangle: id, bary: [0.0; 2] };
        }
        let t = ((1.0 - bary[0] - bary[1]) * a + bary[0] * b + bary[1] * c - place).length();
        Hit { t, triangle: id, bary }
    }
}

/// Over the triangles without two corners in one place, and the spheres and capsules.
fn hierarchy(mesh: &Mesh) -> Bvh {
    let boxed = |(id, t): (usize, &[u32; 3])| {
        if let Some(round) = Round::of(mesh, id as u32) {
            return Some((id as u32, round.bounds()));
        }
        let [a, b, c] = t.map_each(|k| mesh.positions[k as usize]);
        (a != b && b != c && c != a).then(|| (id as u32, Aabb::around(&[a, b, c])))
    };
    let items: Vec<(u32, Aabb)> = parallel::flat_map(0..mesh.triangles.len(), |id| boxed((id, &mesh.triangles[id])));
    Bvh::build(&items)
}

/// What a ray meets.
struct Met {
    hit: Hit,
    surface: Surface,
}

enum Surface {
    Triangle(Corners),
    Round(Round, OnRound),
}

/// Calls `found` with each meeting of a ray and a primitive, at any t, where it shows that face and has no hole. `rounding` is the
/// relative error of t, and `of_zero` as in [`Corners::sign`].
fn meet(
    mesh: &Mesh,
    id: u32,
    aim: &Aim,
    (rounding, of_zero): (f64, impl Fn(&Ray, DVec3, DVec3) -> f64),
    mut found: impl FnMut(Met),
) {
    let mut check = |hit: Hit, facing: f64, surface: Surface| {
        if shows(mesh, &hit, facing) {
            found(Met { hit, surface });
        }
    };
    if let Some(round) = Round::of(mesh, id) {
        for on in round.meetings(&aim.ray, rounding).into_iter().flatten() {
            check(Hit { t: on.t, triangle: id, bary: [0.0; 2] }, on.facing(), Surface::Round(round, on));
        }
        return;
    }
    let corners = Corners::new(mesh.triangles[id as usize].map_each(|k| mesh.positions[k as usize]));
    let Some(sign) = corners.sign(&aim.perturbed, of_zero) else { return };
    let Some(t) = corners.depth(&aim.ray, rounding) else { return };
    let hit = Hit { t, triangle: id, bary: corners.weights(&aim.ray, sign) };
    check(hit, sign * corners.parity, Surface::Triangle(corners));
}

/// Whether the primitive of a hit shows that face, and has no hole there; `facing` is below 0 at its front.
fn shows(mesh: &Mesh, hit: &Hit, facing: f64) -> bool {
    let shows = facing < 0.0 || mesh.material(hit.triangle).is_none_or(|m| m.two_sided);
    shows && mesh.is_there(hit.triangle, hit.bary, Threshold::HALF)
}

/// The nearer hit; the lower id among equals.
fn nearer(best: Option<Hit>, hit: Hit) -> Option<Hit> {
    best.filter(|b| (b.t, b.triangle) <= (hit.t, hit.triangle)).or(Some(hit))
}

/// The largest exact t whose computed value, of this relative error, may be as small as `t`.
fn past(t: f64, rounding: f64) -> f64 {
    t + 2.0 * rounding * t.abs()
}

/// Distances from `place` up to this are the same as `t`, by rounding.
pub fn as_near(place: DVec3, t: f64) -> f64 {
    past(t, T_ROUNDING) + DISTANCE_ROUNDING * place.abs().max_element()
}

/// The weights of the second and third corner where a triangle is nearest to a place.
fn nearest_weights(place: DVec3, v: [DVec3; 3]) -> [f64; 2] {
    let [a, b, c] = v.map_each(|v| v - place);
    let normal = (b - a).cross(c - a);
    let w = [b.cross(c), c.cross(a), a.cross(b)].map_each(|area| area.dot(normal));
    let sum = w[0] + w[1] + w[2];
    if sum > 0.0 && w.iter().all(|w| *w >= 0.0) {
        return [w[1] / sum, w[2] / sum];
    }
    let along = |from: DVec3, to: DVec3| {
        let s = (-from.dot(to - from) / (to - from).length_squared()).clamp(0.0, 1.0);
        (from.lerp(to, s).length_squared(), s)
    };
    let ((ab, s), (bc, t), (ca, u)) = (along(a, b), along(b, c), along(c, a));
    if ab <= bc && ab <= ca {
        [s, 0.0]
    } else if bc <= ca {
        [1.0 - t, t]
    } else {
        [0.0, 1.0 - u]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::generate::{cube, icosphere};
    use crate::testing::Rng;

    #[test]
    fn no_place_of_a_triangle_is_nearer_than_the_nearest() {
        let mut rng = Rng(3);
        let mut vector = || rng.vector();
        for _ in 0..500 {
            let (v, place) = ([vector(), vector(), vector()], 2.0 * vector());
            let at = |[s, t]: [f64; 2]| ((1.0 - s - t) * v[0] + s * v[1] + t * v[2] - place).length();
            let found = nearest_weights(place, v);
            assert!(found.iter().all(|w| *w >= 0.0) && found[0] + found[1] <= 1.0 + f64::EPSILON);
            let steps = (0..=20).flat_map(|i| (0..=20 - i).map(move |j| [f64::from(i) / 20.0, f64::from(j) / 20.0]));
            let least = steps.map(at).fold(f64::INFINITY, f64::min);
            assert!(at(found) <= least + 1e-14, "{} {least}", at(found));
        }
    }

    /// Both ways along a line, covered as if it were slightly perturbed.
    fn line(origin: DVec3, direction: DVec3) -> [Aim; 2] {
        let (e1, e2) = direction.any_orthonormal_pair();
        let beside = origin + 1e-12 * (e1 + 0.6 * e2);
        [direction, -direction]
            .map(|d| Aim { ray: Ray { origin, direction: d }, perturbed: Ray { origin: beside, direction: d } })
    }

    #[test]
    fn a_ball_is_met_on_the_radius_and_is_nearest_there() {
        let ball = icosphere(3);
        let caster = Caster::new(&ball);
        let mut rng = Rng(9);
        for _ in 0..300 {
            let out = rng.direction();
            let outer = |hit: &Hit| {
                let [a, b, c] = ball.triangles[hit.triangle as usize].map(|k| ball.positions[k as usize]);
                (b - a).cross(c - a).dot(out) > 0.0
            };
            for away in [0.5, 1.5] {
                let near = caster.nearest(away * out, |_| true);
                let met = caster.on_line(line(away * out, out).each_ref(), outer).unwrap();
                // the facets lie within 1 % of the sphere, and from inside the foot of another may be as near
                assert!((met.t - 0.5).abs() < 0.01 && met.t >= near[0].t - 1e-12, "{met:?} {near:?}");
                assert!((near[0].t - 0.5).abs() < 0.01);
            }
            // through the middle, both sides are as near but for their facets
            assert!(caster.on_line(line(DVec3::ZERO, out).each_ref(), |_| true).unwrap().t > 0.99);
        }
    }

    #[test]
    fn a_corner_is_nearest_to_all_its_triangles() {
        let cube = cube();
        let caster = Caster::new(&cube);
        let (lo, hi) = cube.bounds().unwrap();
        for corner in [lo, hi] {
            let out = corner - (lo + hi) / 2.0;
            let near = caster.nearest(corner + 0.1 * out, |_| true);
            let touching = |t: &&[u32; 3]| t.iter().any(|k| cube.positions[*k as usize] == corner);
            assert_eq!(near.len(), cube.triangles.iter().filter(touching).count());
            // the diagonal through it meets one of them there
            let met = caster.on_line(line(corner + 0.1 * out, out.normalize()).each_ref(), |_| true).unwrap();
            assert!((met.t - 0.1 * out.length()).abs() < 1e-12);
            assert!(near.iter().any(|hit| hit.triangle == met.triangle));
        }
    }
}
