//! What of the mesh is near a place: along a line through it, or at all.

use super::bvh::Probe;
use super::{Hit, Reference, nearer, past};
use crate::camera::bundle::Bundle;
use glam::DVec3;

/// By how much a distance to a triangle may be off, against the coordinates: three products and two sums make a point of it,
/// a difference and a length the distance.
const DISTANCE_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Everything around a place; `t` is the distance.
struct Around(DVec3);

impl Probe for Around {
    fn span(&self, lo: DVec3, hi: DVec3, range: [f64; 2]) -> Option<[f64; 2]> {
        let distance = (self.0.max(lo).min(hi) - self.0).length();
        (distance <= range[1]).then_some([distance, f64::INFINITY])
    }
}

impl Reference<'_> {
    /// Of all places `of` the mesh that the line through `place` along a unit `direction` meets, either way, the nearest; `t` is
    /// the distance. A line through an edge or a corner is moved aside as the ray of a pixel is, and meets one triangle there.
    pub fn on_line(&self, place: DVec3, direction: DVec3, of: impl Fn(&Hit) -> bool) -> Option<Hit> {
        let (e1, e2) = direction.any_orthonormal_pair();
        let mut best: Option<Hit> = None;
        for d in [direction, -direction] {
            let line = Bundle { p: [place, e1, e2], d: [d, DVec3::ZERO, DVec3::ZERO], h: [1.0, 0.0, 0.0] };
            self.each_hit_of_ray(&line, [0.0, f64::INFINITY], |hit| {
                if of(&hit) {
                    best = nearer(best, hit);
                }
                best.map_or(f64::INFINITY, |b| past(b.t))
            });
        }
        best
    }

    /// Of all triangles the places `of` the mesh that are nearest to `place`, by ascending id: several where it is nearest to an
    /// edge or a corner. `t` is the distance.
    pub fn nearest(&self, place: DVec3, of: impl Fn(&Hit) -> bool) -> Vec<Hit> {
        let mut hits = Vec::new();
        let mut limit = f64::INFINITY;
        self.bvh.walk(&Around(place), [0.0, f64::INFINITY], |id| {
            let hit = self.nearest_of(place, id);
            if of(&hit) {
                limit = limit.min(as_near(place, hit.t));
                hits.push(hit);
            }
            limit
        });
        hits.retain(|hit| hit.t <= limit);
        hits.sort_unstable_by_key(|hit| hit.triangle);
        hits
    }

    fn nearest_of(&self, place: DVec3, id: u32) -> Hit {
        let corners = self.mesh.triangles[id as usize].map(|k| self.mesh.positions[k as usize]);
        let bary = nearest_weights(place, corners);
        let [a, b, c] = corners;
        let t = ((1.0 - bary[0] - bary[1]) * a + bary[0] * b + bary[1] * c - place).length();
        Hit { t, triangle: id, bary }
    }
}

/// Distances from `place` up to this are the same as `t`, by rounding.
pub fn as_near(place: DVec3, t: f64) -> f64 {
    past(t) + DISTANCE_ROUNDING * place.abs().max_element()
}

/// The weights of the second and third corner where a triangle is nearest to a place.
fn nearest_weights(place: DVec3, v: [DVec3; 3]) -> [f64; 2] {
    let [a, b, c] = v.map(|v| v - place);
    let normal = (b - a).cross(c - a);
    let w = [b.cross(c), c.cross(a), a.cross(b)].map(|area| area.dot(normal));
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
    use crate::scene::generate::{cube, icosphere};

    /// Deterministic numbers from -1 to 1.
    fn numbers(mut state: u64) -> impl FnMut() -> f64 {
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }
    }

    #[test]
    fn no_place_of_a_triangle_is_nearer_than_the_nearest() {
        let mut next = numbers(3);
        let mut vector = || DVec3::new(next(), next(), next());
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

    #[test]
    fn a_ball_is_met_on_the_radius_and_is_nearest_there() {
        let ball = icosphere(3);
        let reference = Reference::build(&ball);
        let mut next = numbers(9);
        for _ in 0..300 {
            let out = DVec3::new(next(), next(), next()).normalize();
            let outer = |hit: &Hit| {
                let [a, b, c] = ball.triangles[hit.triangle as usize].map(|k| ball.positions[k as usize]);
                (b - a).cross(c - a).dot(out) > 0.0
            };
            for away in [0.5, 1.5] {
                let near = reference.nearest(away * out, |_| true);
                let met = reference.on_line(away * out, out, outer).unwrap();
                // the facets lie within 1 % of the sphere, and from inside the foot of another may be as near
                assert!((met.t - 0.5).abs() < 0.01 && met.t >= near[0].t - 1e-12, "{met:?} {near:?}");
                assert!((near[0].t - 0.5).abs() < 0.01);
            }
            // through the middle, both sides are as near but for their facets
            assert!(reference.on_line(DVec3::ZERO, out, |_| true).unwrap().t > 0.99);
        }
    }

    #[test]
    fn a_corner_is_nearest_to_all_its_triangles() {
        let cube = cube();
        let reference = Reference::build(&cube);
        let (lo, hi) = cube.bounds().unwrap();
        for corner in [lo, hi] {
            let out = corner - (lo + hi) / 2.0;
            let near = reference.nearest(corner + 0.1 * out, |_| true);
            let touching = |t: &&[u32; 3]| t.iter().any(|k| cube.positions[*k as usize] == corner);
            assert_eq!(near.len(), cube.triangles.iter().filter(touching).count());
            // the diagonal through it meets one of them there
            let met = reference.on_line(corner + 0.1 * out, out.normalize(), |_| true).unwrap();
            assert!((met.t - 0.1 * out.length()).abs() < 1e-12);
            assert!(near.iter().any(|hit| hit.triangle == met.triangle));
        }
    }
}
