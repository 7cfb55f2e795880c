//! Quadrics: surfaces of second degree that rays meet in closed form.

use crate::arrays::MapEach;
use crate::geometry::bvh::Aabb;
use glam::{DMat3, DVec3};

/// The points `X = centre + q` with `q . A q + 2 b . q + c = 0` that lie within a cylinder about the axis: no farther than
/// `rim` from it, and between two heights along it. The gradient `2 (A q + b)` points out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quadric {
    pub centre: DVec3,
    /// Symmetric.
    pub a: DMat3,
    pub b: DVec3,
    pub c: f64,
    /// Unit.
    pub axis: DVec3,
    /// Infinite: the whole surface.
    pub rim: f64,
    pub heights: [f64; 2],
}

impl Quadric {
    pub fn sphere(centre: DVec3, radius: f64) -> Quadric {
        Quadric {
            centre,
            a: DMat3::IDENTITY * (1.0 / radius),
            b: DVec3::ZERO,
            c: -radius,
            axis: DVec3::Y,
            rim: f64::INFINITY,
            heights: [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// A surface of revolution as lens makers give it: at a distance r from the axis, at most `rim`, it lies
    /// `curvature r^2 / (1 + sqrt(1 - (1 + conic) curvature^2 r^2))` along the unit `axis` from `vertex`. Its outside is
    /// where the axis comes from, or with `flipped` where it goes to. `None` where it does not reach the rim.
    pub fn cap(vertex: DVec3, axis: DVec3, curvature: f64, conic: f64, rim: f64, flipped: bool) -> Option<Quadric> {
        let k = 1.0 + conic;
        let sag = sag(curvature, conic, rim)?;
        let out = if flipped { -1.0 } else { 1.0 };
        let along = DMat3::from_cols(axis * axis.x, axis * axis.y, axis * axis.z);
        // c (r^2 + k z^2) = 2 z, with r^2 = |q|^2 - z^2
        let a = (DMat3::IDENTITY + along * (k - 1.0)) * (out * curvature);
        // of the two halves of an ellipsoid, or of a hyperboloid, the one at the vertex ends at z = 1 / (k c)
        let rounding = CAP_ROUNDING * (sag.abs() + rim);
        let heights = [sag.min(0.0) - rounding, sag.max(0.0) + rounding];
        Some(Quadric { centre: vertex, a, b: -out * axis, c: 0.0, axis, rim, heights })
    }

    /// A cylinder's wall between two heights along the unit `axis` from `centre`.
    pub fn wall(centre: DVec3, axis: DVec3, radius: f64, heights: [f64; 2]) -> Quadric {
        let along = DMat3::from_cols(axis * axis.x, axis * axis.y, axis * axis.z);
        let a = (DMat3::IDENTITY - along) * (1.0 / radius);
        Quadric { centre, a, b: DVec3::ZERO, c: -radius, axis, rim: f64::INFINITY, heights }
    }

    /// The gradient at `place` on the surface, halved; points out.
    pub fn normal(&self, place: DVec3) -> DVec3 {
        self.a * (place - self.centre) + self.b
    }

    /// Whether a place of the surface, `q` from the centre and its height known up to `error`, is on the part that is there: within the rim
    /// and the heights.
    pub fn contains(&self, q: DVec3, error: f64) -> bool {
        let z = q.dot(self.axis);
        let r2 = (q - z * self.axis).length_squared();
        z >= self.heights[0] - error && z <= self.heights[1] + error && r2 <= self.rim * self.rim
    }

    /// A box around it.
    pub fn bounds(&self) -> Aabb {
        // where nothing else ends it, it is a ball or a wall about its centre
        let radius = |along: DVec3| (-self.c / along.dot(self.a * along)).sqrt();
        let rim = if self.rim.is_finite() { self.rim } else { radius(self.axis.any_orthonormal_vector()) };
        let heights = self.heights.map_each(|h| if h.is_finite() { h } else { h.signum() * radius(self.axis) });
        let disc = rim * (DVec3::ONE - self.axis * self.axis).max(DVec3::ZERO).map(f64::sqrt);
        let corners = |h: f64| [h * self.axis - disc, h * self.axis + disc].map_each(|q| self.centre + q);
        Aabb::around(&heights.map_each(corners).concat())
    }
}

/// How far beyond its rim's height a cap counts, relative to its size: rounding of the height. The other sheet of the
/// surface, or its other half, lies farther but where the rim is that of the half itself.
const CAP_ROUNDING: f64 = 1.0 / (1u64 << 40) as f64;

/// How far along its axis a cap lies at a distance `r` from it; `None` where it does not reach that far.
pub fn sag(curvature: f64, conic: f64, r: f64) -> Option<f64> {
    let root = 1.0 - (1.0 + conic) * (curvature * r).powi(2);
    (root >= 0.0).then(|| curvature * r * r / (1.0 + root.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn caps_are_the_lens_makers_formula_with_the_outside_where_they_say() {
        let axis = DVec3::new(1.0, 2.0, -0.5).normalize();
        let across = axis.any_orthonormal_vector();
        let vertex = DVec3::new(0.3, -1.0, 2.0);
        for (curvature, conic) in [(0.5, 0.0), (-0.5, 0.0), (0.8, -1.0), (0.7, -2.5), (0.3, 0.9), (0.0, 0.0)] {
            for flipped in [false, true] {
                let cap = Quadric::cap(vertex, axis, curvature, conic, 1.2, flipped).unwrap();
                for r in [0.0, 0.4, 1.2] {
                    let at = vertex + r * across + sag(curvature, conic, r).unwrap() * axis;
                    let q = at - vertex;
                    let value = q.dot(cap.a * q) + 2.0 * cap.b.dot(q) + cap.c;
                    assert!(value.abs() < 1e-15, "{curvature} {conic}: {value}");
                    assert!(r == 1.2 || cap.contains(q, 0.0));
                    let out = cap.normal(at).dot(axis) * if flipped { 1.0 } else { -1.0 };
                    assert!(out > 0.0, "{curvature} {conic} {flipped}: {out}");
                }
            }
        }
        // an ellipsoid does not reach farther than its half axis
        assert!(Quadric::cap(vertex, axis, 0.5, 0.0, 2.1, false).is_none());
    }

    #[test]
    fn bounds_hold_the_surface_and_little_more() {
        let axis = DVec3::new(1.0, 2.0, -0.5).normalize();
        let across = axis.any_orthonormal_vector();
        let centre = DVec3::new(0.3, -1.0, 2.0);
        let cap = Quadric::cap(centre, axis, 0.5, 0.0, 1.2, false).unwrap();
        let top = sag(0.5, 0.0, 1.2).unwrap();
        let wall = Quadric::wall(centre, axis, 1.2, [-1.0, 3.0]);
        let ball = Quadric::sphere(centre, 1.2);
        for (quadric, heights, r) in [(cap, [0.0, top], 1.2), (wall, [-1.0, 3.0], 1.2), (ball, [-1.2, 1.2], 0.0)] {
            let bounds = quadric.bounds();
            let around = |k: usize| (DQuat::from_axis_angle(axis, k as f64 * 1e-3) * across) * r;
            let rims: Vec<DVec3> = (0..6284)
                .flat_map(|k| heights.map(|h| centre + if r > 0.0 { h * axis } else { DVec3::splat(h) } + around(k)))
                .collect();
            let tight = Aabb::around(&rims);
            assert!((bounds.lo - tight.lo).abs().max_element() < 1e-5, "{bounds:?} {tight:?}");
            assert!((bounds.hi - tight.hi).abs().max_element() < 1e-5, "{bounds:?} {tight:?}");
        }
    }

    #[test]
    fn balls_and_walls_face_outside_and_end_at_their_heights() {
        let ball = Quadric::sphere(DVec3::ONE, 2.0);
        assert!((ball.normal(DVec3::new(3.0, 1.0, 1.0)) - DVec3::X).length() < 1e-15);
        let wall = Quadric::wall(DVec3::ZERO, DVec3::Y, 0.5, [0.0, 3.0]);
        assert!(wall.contains(DVec3::new(0.5, 2.0, 0.0), 0.0) && !wall.contains(DVec3::new(0.5, 3.5, 0.0), 0.0));
    }
}
