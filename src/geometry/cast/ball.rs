//! A sphere against rays, in f64 where rounding cannot change the answer, and in exact arithmetic elsewhere.
//!
//! With `m = c - P` a ray is on the sphere at `t = (D . m -+ s) / (D . D)`, `s` being the root of `D . D r^2 - |D x m|^2`.

use super::Ray;
use super::corners::{TERM_ROUNDING, cross_size};
use super::depth::Depth;
use crate::arrays::MapEach;
use crate::geometry::bvh::Aabb;
use crate::geometry::exact::{Exact, Exact3, cross, dot, squared};
use crate::geometry::mesh::Mesh;
use glam::DVec3;

#[derive(Debug, Clone, Copy)]
pub struct Ball {
    centre: DVec3,
    radius: f64,
}

/// Lengths of directions whose squares, multiplied by those of coordinates, stay in f64.
const PLAIN_LENGTHS: std::ops::RangeInclusive<f64> = 1e-30..=1e30;

impl Ball {
    /// `None` of a triangle.
    pub fn of(mesh: &Mesh, id: u32) -> Option<Ball> {
        let radius = mesh.radius(id)?;
        Some(Ball { centre: mesh.positions[mesh.triangles[id as usize][0] as usize], radius })
    }

    /// The box around it, and around what rounding makes of its ends.
    pub fn bounds(&self) -> Aabb {
        let ends = |v: f64| [(v - self.radius).next_down(), (v + self.radius).next_up()];
        let [x, y, z] = self.centre.to_array().map_each(ends);
        Aabb { lo: DVec3::new(x[0], y[0], z[0]), hi: DVec3::new(x[1], y[1], z[1]) }
    }

    /// Where a ray enters and leaves it, each t to within `rounding` of itself; twice the same where it touches. `None` where it passes, and
    /// where numbers leave the range of f64.
    pub fn meetings(&self, ray: &Ray, rounding: f64) -> Option<[f64; 2]> {
        let (ray, scale) = scaled(ray);
        let d = ray.direction;
        let m = self.centre - ray.origin;
        let root = self.root(&ray, rounding)?;
        let mut along = d.dot(m);
        let mut far = along + root.copysign(along);
        if 4.0 * TERM_ROUNDING * d.abs().dot(m.abs()) > rounding * far.abs() {
            along = self.exact_along(&ray).value();
            far = along + root.copysign(along);
        }
        if far == 0.0 {
            return Some([0.0; 2]);
        }
        let mut beyond = m.length_squared() - self.radius * self.radius;
        if 4.0 * TERM_ROUNDING * (m.length_squared() + self.radius * self.radius) > rounding * beyond.abs() {
            beyond = self.exactly_beyond(&ray);
        }
        // the two t have the product beyond / a; the sum of numbers of one sign cancels nothing
        let [one, other] = [far / d.length_squared(), beyond / far].map_each(|t| scale * t);
        (one.is_finite() && other.is_finite()).then_some([one.min(other), one.max(other)])
    }

    /// Outwards, unit, where a ray is on it at `t`.
    pub fn normal(&self, ray: &Ray, t: f64) -> DVec3 {
        let (ray, scale) = scaled(ray);
        let d = ray.direction;
        let m = self.centre - ray.origin;
        let root = self.root(&ray, NORMAL_ROUNDING).unwrap_or(0.0);
        let side = t / scale * d.length_squared() - d.dot(m);
        (d.cross(d.cross(m)) + root.copysign(side) * d).normalize_or_zero()
    }

    /// The place of the surface there.
    pub fn place(&self, normal: DVec3) -> DVec3 {
        self.centre + self.radius * normal
    }

    /// t where it is entered, with -1, or left, with 1.
    pub fn exact_depth(&self, ray: &Ray, side: i8) -> Depth {
        let a = squared(&ray.direction.to_array().map_each(|x| Exact::product(x, 1.0)));
        Depth { above: self.exact_along(ray), root: Some((side, self.exactly_below(ray))), below: a }
    }

    /// The root of `d . d r^2 - |d x m|^2`, whose square is exact to within a quarter of `rounding`; `None` if there is none.
    fn root(&self, ray: &Ray, rounding: f64) -> Option<f64> {
        let d = ray.direction;
        let m = self.centre - ray.origin;
        let square = d.length_squared() * self.radius * self.radius;
        let size = cross_size(d.abs(), m.abs()).element_sum();
        let mut below = square - d.cross(m).length_squared();
        // the components of the cross product are off by TERM_ROUNDING of their sizes, so its square by twice that
        let bound = TERM_ROUNDING * (square + 3.0 * size * size);
        if 4.0 * bound > rounding * below.abs() {
            if below < -bound {
                return None;
            }
            below = self.exactly_below(ray).value();
        }
        (below >= 0.0).then(|| below.sqrt())
    }

    /// `m`.
    fn exact_offset(&self, ray: &Ray) -> Exact3 {
        [0, 1, 2].map_each(|k| Exact::product(self.centre[k], 1.0).minus(&Exact::product(ray.origin[k], 1.0)))
    }

    /// `d . m`.
    fn exact_along(&self, ray: &Ray) -> Exact {
        dot(&self.exact_offset(ray), ray.direction)
    }

    /// `d . d r^2 - |d x m|^2`.
    fn exactly_below(&self, ray: &Ray) -> Exact {
        let d = ray.direction;
        let [x, y, z] = cross(ray.origin, d);
        let [a, b, c] = cross(self.centre, d);
        let square = squared(&[a.minus(&x), b.minus(&y), c.minus(&z)]);
        let a = squared(&d.to_array().map_each(|x| Exact::product(x, 1.0)));
        a.by(&Exact::product(self.radius, self.radius)).minus(&square)
    }

    /// `m . m - r^2`.
    fn exactly_beyond(&self, ray: &Ray) -> f64 {
        squared(&self.exact_offset(ray)).minus(&Exact::product(self.radius, self.radius)).value()
    }
}

/// Relative error of the square of half a chord, for normals.
const NORMAL_ROUNDING: f64 = 1.0 / (1_u64 << 40) as f64;

/// The ray with a direction of about unit length, if its own is very short or long, and t of the one given over t of that one.
fn scaled(ray: &Ray) -> (Ray, f64) {
    let size = ray.direction.abs().max_element();
    if PLAIN_LENGTHS.contains(&size) {
        return (*ray, 1.0);
    }
    // a power of two, so that nothing is rounded
    let scale = (-size.log2().floor()).clamp(-1000.0, 1000.0).exp2();
    (Ray { direction: scale * ray.direction, ..*ray }, scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Rng;

    const ROUNDING: f64 = 1.0 / (1_u64 << 40) as f64;

    fn ray(origin: DVec3, direction: DVec3) -> Ray {
        Ray { origin, direction }
    }

    #[test]
    fn rays_enter_leave_touch_and_pass() {
        let ball = Ball { centre: DVec3::new(1.0, 2.0, 3.0), radius: 5.0 };
        // 3, 4, 5 and powers of two: no rounding, however long the direction is
        for length in [1.0, 0.25, 2f64.powi(300), 2f64.powi(-700)] {
            let meet = |p: DVec3, d: DVec3| Some(ball.meetings(&ray(p, length * d), ROUNDING)?.map(|t| t * length));
            assert_eq!(meet(DVec3::new(4.0, 2.0, -13.0), 2.0 * DVec3::Z), Some([6.0, 10.0]));
            assert_eq!(meet(DVec3::new(6.0, 2.0, -13.0), 2.0 * DVec3::Z), Some([8.0; 2]));
            assert_eq!(meet(DVec3::new(6.0_f64.next_up(), 2.0, -13.0), 2.0 * DVec3::Z), None);
            assert_eq!(meet(DVec3::new(4.0, 2.0, 3.0), DVec3::NEG_Z), Some([-4.0, 4.0]));
            assert_eq!(meet(DVec3::new(6.0, 2.0, 3.0), DVec3::Z), Some([0.0; 2]));
            assert_eq!(meet(DVec3::new(1.0, 2.0, 9.0), DVec3::NEG_Z), Some([1.0, 11.0]));
            let entering = ray(DVec3::new(4.0, 2.0, -13.0), length * DVec3::Z);
            for (t, z) in [(12.0, -0.8), (20.0, 0.8)] {
                assert!((ball.normal(&entering, t / length) - DVec3::new(0.6, 0.0, z)).length() < 4.0 * f64::EPSILON);
            }
        }
    }

    /// Each t has the relative error that is asked for, where f64 alone is off by a million times as much.
    #[test]
    fn small_spheres_far_away_are_met_as_exactly() {
        let mut rng = Rng(5);
        let mut met = 0;
        for n in 0..2000 {
            let mut vector = || rng.vector();
            let (d, centre, beside) = (vector(), 4.0 * vector(), vector());
            let radius = 1e-7;
            // every other ray starts on the sphere or about it
            let p = if n % 2 == 0 { centre - 3.0 * d + radius * beside } else { centre + radius * beside.normalize() };
            let (ball, own) = (Ball { centre, radius }, ray(p, d));
            let Some(t) = ball.meetings(&own, ROUNDING) else { continue };
            met += 1;
            for (t, side) in t.into_iter().zip([-1, 1]) {
                for (by, sign) in [(-2.0, 1), (2.0, -1)] {
                    let end = t + by * ROUNDING * t.abs();
                    let compared = ball.exact_depth(&own, side).compare(&Depth::of(end)) as i8;
                    assert!(t == 0.0 || compared == sign, "{n}: {t} {side}");
                }
            }
        }
        assert!(met > 500 && met < 1900, "{met}");
    }
}
