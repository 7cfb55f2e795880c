//! The torus: a surface of fourth degree.

use glam::DVec3;

/// The points `X = centre + q` with `(|q|^2 + radius^2 - tube^2)^2 = 4 radius^2 r^2`, r their distance from the axis: at `tube`
/// from a circle of `radius` about it. The outside is where the left side is the larger: where the tube is wider than the
/// radius the surface crosses itself, and what is within it twice is outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Torus {
    pub centre: DVec3,
    /// Unit.
    pub axis: DVec3,
    pub radius: f64,
    pub tube: f64,
}

impl Torus {
    /// The radius of the ball that it just fits in.
    pub fn size(&self) -> f64 {
        self.radius + self.tube
    }

    /// A quarter of the gradient at `place` on the surface; points out. Zero where the surface crosses itself.
    pub fn normal(&self, place: DVec3) -> DVec3 {
        let q = place - self.centre;
        let away = q - q.dot(self.axis) * self.axis;
        (q.length_squared() + self.radius.powi(2) - self.tube.powi(2)) * q - 2.0 * self.radius.powi(2) * away
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_point_away_from_the_circle_but_for_what_is_within_twice() {
        let axis = DVec3::new(0.3, 1.0, -0.4).normalize();
        let (e1, e2) = axis.any_orthonormal_pair();
        for (radius, tube) in [(2.0, 0.5), (1.0, 0.01), (1.0, 1.3)] {
            let torus = Torus { centre: DVec3::new(0.2, -3.0, 1.0), axis, radius, tube };
            for k in 0..40 {
                let ((s, c), (sine, cosine)) = ((f64::from(k) * 0.7).sin_cos(), (f64::from(k) * 1.9).sin_cos());
                let out = c * e1 + s * e2;
                let n = cosine * out + sine * axis;
                let place = torus.centre + radius * out + tube * n;
                let side = if radius + tube * cosine < 0.0 { -1.0 } else { 1.0 };
                // some rounding of places of size 4 over the tube
                assert!((torus.normal(place).normalize() - side * n).length() < 1e-14 / tube, "{tube} {k}");
            }
        }
    }
}
