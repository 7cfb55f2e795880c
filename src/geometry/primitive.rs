//! Primitives: the shapes that a mesh is made of. `docs/architecture.md` lists the places that know of each.

use super::mesh::joined;
use glam::{DQuat, DVec3};

/// A triangle, or a sphere or capsule, at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Primitive {
    Triangle([DVec3; 3]),
    Round(Capsule),
}

/// All points within a radius of the segment between two ends. A sphere is a capsule whose ends are one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capsule {
    pub ends: [DVec3; 2],
    pub radius: f64,
}

impl Primitive {
    /// The primitive of these corners: a triangle, or, with a radius, a capsule from the first corner to the second.
    pub fn new(corners: [DVec3; 3], radius: Option<f64>) -> Primitive {
        let [a, b, _] = corners;
        radius.map_or(Primitive::Triangle(corners), |radius| Primitive::Round(Capsule { ends: [a, b], radius }))
    }

    /// Three points in the box around it, two of which are opposite corners of that if it is round.
    pub fn extremes(&self) -> [DVec3; 3] {
        match self {
            Primitive::Triangle(corners) => *corners,
            Primitive::Round(capsule) => {
                let (lo, hi) = capsule.bounds();
                [capsule.ends[0], lo, hi]
            }
        }
    }

    /// The corners of the box around it.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let [a, b, c] = self.extremes();
        (a.min(b).min(c), a.max(b).max(c))
    }

    pub fn capsule(&self) -> Option<Capsule> {
        if let Primitive::Round(capsule) = self { Some(*capsule) } else { None }
    }

    /// The length of the longest edge, or the radius.
    pub fn size(&self) -> f64 {
        match self {
            Primitive::Triangle([a, b, c]) => (*b - *a).length().max((*c - *b).length()).max((*a - *c).length()),
            Primitive::Round(capsule) => capsule.radius,
        }
    }

    /// A vector across the surface at a place on it; zero for a triangle without area.
    pub fn normal_at(&self, p: DVec3) -> DVec3 {
        match self {
            Primitive::Triangle([a, b, c]) => (*b - *a).cross(*c - *a),
            Primitive::Round(capsule) => p - capsule.nearest(p),
        }
    }
}

impl Capsule {
    /// The corners of the box around it.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let [a, b] = self.ends.map(|end| (end - self.radius, end + self.radius));
        joined(a, b)
    }

    /// Whether its ends are one point.
    pub fn is_sphere(&self) -> bool {
        self.ends[0] == self.ends[1]
    }

    /// The point of its segment that is nearest to a place.
    pub fn nearest(&self, p: DVec3) -> DVec3 {
        let [a, b] = self.ends;
        let axis = b - a;
        let share = (p - a).dot(axis) / axis.length_squared();
        if share.is_finite() { a + share.clamp(0.0, 1.0) * axis } else { a }
    }

    /// The place that moves with a place of this capsule when it becomes another: at the same fraction of the segment, as far from it. A sphere or
    /// capsule is not seen to turn about its segment.
    pub fn moved_to(&self, other: &Capsule, p: DVec3) -> DVec3 {
        let [a, b] = self.ends;
        let nearest = self.nearest(p);
        let share = ((nearest - a).length() / (b - a).length()).min(1.0);
        let [c, d] = other.ends;
        let then = if share.is_nan() { c } else { c + share * (d - c) };
        let turn = DQuat::from_rotation_arc((b - a).normalize_or(DVec3::X), (d - c).normalize_or(DVec3::X));
        let turn = if a == b || c == d { DQuat::IDENTITY } else { turn };
        then + other.radius / self.radius * (turn * (p - nearest))
    }

    /// Where a ray enters and leaves it; where it passes, twice the t of the ray's place nearest to it.
    pub fn nearest_meetings(&self, origin: DVec3, direction: DVec3) -> [f64; 2] {
        let [a, b] = self.ends;
        let ball = |end: DVec3| meetings(direction, end - origin, self.radius);
        let axis = (b - a).normalize_or_zero();
        let start = direction.dot(a - origin) / direction.length_squared();
        let m = a - origin - start * direction;
        let across = direction.cross(axis);
        if axis == DVec3::ZERO {
            return ball(a);
        }
        let tube = match across.length() > PARALLEL * direction.length() {
            true => meetings(across, m.cross(axis), self.radius).map(|t| t + start),
            false => [f64::NEG_INFINITY, f64::INFINITY],
        };
        let at = |k: usize| {
            let slope = direction.dot(axis);
            let place = if tube[k].is_finite() { (tube[k] - start) * slope - m.dot(axis) } else { tube[k] * slope };
            match place {
                _ if place < 0.0 => ball(a)[k],
                _ if place > (b - a).length() => ball(b)[k],
                _ => tube[k],
            }
        };
        [at(0), at(1)]
    }
}

/// The least sine between a ray and a capsule that it is not parallel to.
const PARALLEL: f64 = 1e-12;

/// Where `|t d - m| = r`, or twice the t where it is least.
fn meetings(d: DVec3, m: DVec3, r: f64) -> [f64; 2] {
    let a = d.length_squared();
    let along = d.dot(m);
    let below = a * r * r - d.cross(m).length_squared();
    if below <= 0.0 {
        return [along / a; 2];
    }
    let far = along + below.sqrt().copysign(along);
    let (one, other) = (far / a, (m.length_squared() - r * r) / far);
    [one.min(other), one.max(other)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn capsule(ends: [[f64; 3]; 2], radius: f64) -> Capsule {
        Capsule { ends: ends.map(DVec3::from_array), radius }
    }

    #[test]
    fn rays_enter_and_leave_spheres() {
        let ball = capsule([[0.0, 0.0, 3.0]; 2], 5.0);
        let meet = |x: f64| ball.nearest_meetings(DVec3::new(x, 0.0, -13.0), 2.0 * DVec3::Z);
        assert_eq!((meet(3.0), meet(6.0)), ([6.0, 10.0], [8.0; 2]));
    }

    /// Through the side, through both balls, along the axis, and past it.
    #[test]
    fn rays_enter_and_leave_capsules() {
        let rod = capsule([[-2.0, 0.0, 0.0], [2.0, 0.0, 0.0]], 1.0);
        let meet = |p: [f64; 3], d: [f64; 3]| rod.nearest_meetings(DVec3::from_array(p), DVec3::from_array(d));
        assert_eq!(meet([1.0, 0.0, -5.0], [0.0, 0.0, 1.0]), [4.0, 6.0]);
        assert_eq!(meet([2.6, 0.0, -5.0], [0.0, 0.0, 1.0]), [4.2, 5.8]);
        assert_eq!(meet([-9.0, 0.0, 0.0], [2.0, 0.0, 0.0]), [3.0, 6.0]);
        assert_eq!(meet([-9.0, 0.6, 0.0], [1.0, 0.0, 0.0]), [6.2, 11.8]);
        assert_eq!(meet([2.6, 0.9, -5.0], [0.0, 0.0, 1.0]), [5.0; 2]);
    }

    /// A place on the surface stays there, and at its share of the segment.
    #[test]
    fn places_move_with_their_capsule() {
        let [now, then] = [capsule([[0.0; 3], [2.0, 0.0, 0.0]], 1.0), capsule([[5.0, 0.0, 0.0], [5.0, 4.0, 0.0]], 2.0)];
        let moved = now.moved_to(&then, DVec3::new(0.5, 0.0, 1.0));
        assert!((moved - DVec3::new(5.0, 1.0, 2.0)).length() < 1e-12, "{moved}");
        assert_eq!(now.nearest(DVec3::new(-3.0, 1.0, 0.0)), DVec3::ZERO);
        assert_eq!(Primitive::Round(now).bounds(), (DVec3::splat(-1.0), DVec3::new(3.0, 1.0, 1.0)));
    }
}
