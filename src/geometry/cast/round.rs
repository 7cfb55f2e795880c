//! Spheres and capsules against rays, in f64 where rounding cannot change the answer, and in exact arithmetic elsewhere.
//!
//! With `m = c - P` a ray is on a ball at `t = (D . m -+ s) / (D . D)`, `s` being the root of `D . D r^2 - |D x m|^2`. With the axis `u` of a
//! segment it is on the tube about that where `|t D x u - m x u| = r |u|`: `t = ((D x u) . (m x u) -+ s) / |D x u|^2`, `s` being the root of
//! `|u|^2 (|D x u|^2 r^2 - (u . (D x m))^2)`. A capsule lies in its tube: a ray enters it where it enters the tube, if that is between the ends,
//! and else where it enters the ball about the end beyond which it entered the tube. It leaves in the same way.

use super::Ray;
use super::corners::{TERM_ROUNDING, cross_size};
use super::depth::Depth;
use crate::arrays::MapEach;
use crate::geometry::bvh::Aabb;
use crate::geometry::exact::{Exact, Exact3, cross, dot, squared};
use crate::geometry::mesh::Mesh;
use crate::geometry::primitive::{Capsule, Primitive};
use glam::DVec3;

/// A sphere or capsule.
#[derive(Debug, Clone, Copy)]
pub struct Round(Capsule);

/// Where a ray is on the surface of a sphere or capsule.
#[derive(Debug, Clone, Copy)]
pub struct OnRound {
    pub t: f64,
    part: Part,
    /// -1: the ray enters; 1: it leaves.
    side: i8,
}

/// The parts of the surface of a capsule: the ball about either end, and the tube between them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    First,
    Side,
    Last,
}

#[derive(Debug, Clone, Copy)]
struct Ball {
    centre: DVec3,
    radius: f64,
}

#[derive(Debug, Clone, Copy)]
struct Tube {
    ends: [DVec3; 2],
    radius: f64,
}

/// Lengths of directions whose squares, multiplied by those of coordinates, stay in f64.
const PLAIN_LENGTHS: std::ops::RangeInclusive<f64> = 1e-30..=1e30;

impl Round {
    /// `None` of a triangle.
    pub fn of(mesh: &Mesh, id: u32) -> Option<Round> {
        if let Primitive::Round(capsule) = mesh.primitive(id) { Some(Round(capsule)) } else { None }
    }

    /// The box around it, and around what rounding makes of its ends.
    pub fn bounds(&self) -> Aabb {
        let [a, b] = self.balls().map_each(|ball| ball.bounds());
        Aabb { lo: a.lo.min(b.lo), hi: a.hi.max(b.hi) }
    }

    fn balls(&self) -> [Ball; 2] {
        self.0.ends.map_each(|centre| Ball { centre, radius: self.0.radius })
    }

    fn tube(&self) -> Tube {
        Tube { ends: self.0.ends, radius: self.0.radius }
    }

    /// Where a ray enters and leaves it, each t to within `rounding` of itself; twice the same where it touches. `None` where it passes, and
    /// where numbers leave the range of f64.
    pub fn meetings(&self, ray: &Ray, rounding: f64) -> Option<[OnRound; 2]> {
        let [first, last] = self.balls();
        let whole = match first.centre == last.centre {
            true => None,
            false => Some(self.tube().meetings(ray, rounding)?),
        };
        let part = |k: usize| whole.map_or(Part::First, |whole| self.tube().part_at(ray, whole[k]));
        let at = |k: usize| {
            let (part, side) = (part(k), [-1, 1][k]);
            let t = match part {
                Part::First => first.meetings(ray, rounding)?[k],
                Part::Side => whole?[k],
                Part::Last => last.meetings(ray, rounding)?[k],
            };
            Some(OnRound { t, part, side })
        };
        let entered = at(0)?;
        let left = at(1).filter(|left| left.t >= entered.t);
        Some([entered, left.unwrap_or(OnRound { side: 1, ..entered })])
    }

    /// The place of a ray on it that is nearest to `t`, and the unit normal there, outwards.
    pub fn place_and_normal(&self, ray: &Ray, t: f64) -> (DVec3, DVec3) {
        let part = match self.0.ends[0] == self.0.ends[1] {
            true => Part::First,
            false => self.tube().part_at(ray, t),
        };
        let [first, last] = self.balls();
        let on_ball = |ball: Ball| {
            let normal = ball.normal(ray, t);
            (ball.centre + ball.radius * normal, normal)
        };
        match part {
            Part::First => on_ball(first),
            Part::Last => on_ball(last),
            Part::Side => {
                let nearest = self.0.nearest(ray.origin + t * ray.direction);
                let normal = (ray.origin + t * ray.direction - nearest).normalize_or_zero();
                (nearest + self.0.radius * normal, normal)
            }
        }
    }

    /// The t of a meeting: exact on a ball, and as computed on a tube, whose exact t has products of 32 numbers in a comparison.
    pub fn depth(&self, ray: &Ray, on: &OnRound) -> Depth {
        let [first, last] = self.balls();
        match on.part {
            Part::First => first.exact_depth(ray, on.side),
            Part::Side => Depth::of(on.t),
            Part::Last => last.exact_depth(ray, on.side),
        }
    }
}

impl OnRound {
    /// -1 at a front, 1 at a back.
    pub fn facing(&self) -> f64 {
        self.side.into()
    }
}

/// `D x u` squared, what is below the root without its factor `u . u`, `(D x u) . (m x u)`, and `|m x u|^2 - r^2 |u|^2`.
struct TubeNumbers {
    a: f64,
    below: f64,
    along: f64,
    beyond: f64,
}

impl Tube {
    fn axis(&self) -> DVec3 {
        self.ends[1] - self.ends[0]
    }

    /// The part of the capsule that a ray is beside at `t`.
    fn part_at(&self, ray: &Ray, t: f64) -> Part {
        let axis = self.axis();
        let slope = ray.direction.dot(axis);
        let place = if t.is_infinite() { t * slope } else { t * slope - (self.ends[0] - ray.origin).dot(axis) };
        match place {
            _ if place < 0.0 => Part::First,
            _ if place > axis.length_squared() => Part::Last,
            _ => Part::Side,
        }
    }

    /// As [`Round::meetings`]; without ends where a ray is parallel to the tube, and in it.
    fn meetings(&self, ray: &Ray, rounding: f64) -> Option<[f64; 2]> {
        let (ray, scale) = scaled(ray);
        let (d, u, m) = (ray.direction, self.axis(), self.ends[0] - ray.origin);
        let (across, away, side) = (d.cross(u), m.cross(u), u.dot(d.cross(m)));
        let sizes = [cross_size(d.abs(), u.abs()), cross_size(m.abs(), u.abs())].map_each(DVec3::element_sum);
        let side_size = u.abs().dot(cross_size(d.abs(), m.abs()));
        let square = self.radius * self.radius;
        let a = across.length_squared();
        let numbers = TubeNumbers {
            a,
            below: a * square - side * side,
            along: across.dot(away),
            beyond: away.length_squared() - square * u.length_squared(),
        };

        // components lose TERM_ROUNDING of their sizes, and half as much for the axis
        let unit = 2.0 * TERM_ROUNDING;
        let a_bound = 3.0 * unit * sizes[0] * sizes[0];
        let side_bound = unit * side_size;
        let below_bound =
            square * a_bound + unit * (a * square + side * side) + side_bound * (2.0 * side.abs() + side_bound);
        let beyond_bound = 3.0 * unit * (sizes[1] * sizes[1] + square * u.length_squared());
        let is_sure = |bound: f64, value: f64| 4.0 * bound <= rounding * value.abs();
        let is_proven = is_sure(a_bound, a) && (numbers.below < -below_bound || is_sure(below_bound, numbers.below));
        let far = numbers.far(u.length_squared());
        let numbers = match is_proven
            && is_sure(2.0 * unit * sizes[0] * sizes[1], far)
            && is_sure(beyond_bound, numbers.beyond)
        {
            true => numbers,
            false => self.exact_numbers(&ray),
        };
        numbers.meetings(u.length_squared()).map(|t| t.map_each(|t| scale * t))
    }

    fn exact_numbers(&self, ray: &Ray) -> TubeNumbers {
        let one = |x: f64| Exact::product(x, 1.0);
        let [first, last] = self.ends;
        let u: Exact3 = [0, 1, 2].map_each(|k| one(last[k]).minus(&one(first[k])));
        let m: Exact3 = [0, 1, 2].map_each(|k| one(first[k]).minus(&one(ray.origin[k])));
        let d: Exact3 = ray.direction.to_array().map_each(one);
        let square = Exact::product(self.radius, self.radius);
        let (across, away) = (exact_cross(&d, &u), exact_cross(&m, &u));
        let a = squared(&across);
        let side = exact_dot(&u, &exact_cross(&d, &m));
        TubeNumbers {
            below: a.by(&square).minus(&side.by(&side)).value(),
            along: exact_dot(&across, &away).value(),
            beyond: squared(&away).minus(&square.by(&squared(&u))).value(),
            a: a.value(),
        }
    }
}

impl TubeNumbers {
    fn far(&self, axis_squared: f64) -> f64 {
        self.along + (axis_squared * self.below.max(0.0)).sqrt().copysign(self.along)
    }

    fn meetings(&self, axis_squared: f64) -> Option<[f64; 2]> {
        if self.a == 0.0 {
            return (self.beyond <= 0.0).then_some([f64::NEG_INFINITY, f64::INFINITY]);
        }
        if self.below < 0.0 {
            return None;
        }
        let far = self.far(axis_squared);
        if far == 0.0 {
            return Some([0.0; 2]);
        }
        let [one, other] = [far / self.a, self.beyond / far];
        (one.is_finite() && other.is_finite()).then_some([one.min(other), one.max(other)])
    }
}

fn exact_dot(a: &Exact3, b: &Exact3) -> Exact {
    (0..3).fold(Exact::default(), |sum, k| sum.plus(&a[k].by(&b[k])))
}

fn exact_cross(a: &Exact3, b: &Exact3) -> Exact3 {
    let minor = |i: usize, j: usize| a[i].by(&b[j]).minus(&a[j].by(&b[i]));
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

impl Ball {
    fn bounds(&self) -> Aabb {
        let ends = |v: f64| [(v - self.radius).next_down(), (v + self.radius).next_up()];
        let [x, y, z] = self.centre.to_array().map_each(ends);
        Aabb { lo: DVec3::new(x[0], y[0], z[0]), hi: DVec3::new(x[1], y[1], z[1]) }
    }

    /// As [`Round::meetings`].
    fn meetings(&self, ray: &Ray, rounding: f64) -> Option<[f64; 2]> {
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
    fn normal(&self, ray: &Ray, t: f64) -> DVec3 {
        let (ray, scale) = scaled(ray);
        let d = ray.direction;
        let m = self.centre - ray.origin;
        let root = self.root(&ray, NORMAL_ROUNDING).unwrap_or(0.0);
        let side = t / scale * d.length_squared() - d.dot(m);
        (d.cross(d.cross(m)) + root.copysign(side) * d).normalize_or_zero()
    }

    /// t where it is entered, with -1, or left, with 1.
    fn exact_depth(&self, ray: &Ray, side: i8) -> Depth {
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

    /// Both t are on the surface, and the ray is in the capsule between them.
    #[test]
    fn rays_are_in_a_capsule_between_the_two_t() {
        let mut rng = Rng(6);
        let (mut met, mut on_side) = (0, 0);
        for n in 0..3000 {
            let radius = 10f64.powf(-3.0 * rng.unit());
            let end = rng.vector();
            let ends = [end, end + 10f64.powf(1.0 - 4.0 * rng.unit()) * rng.vector().normalize()];
            let round = Round(Capsule { ends, radius });
            let d = if n % 8 == 0 { ends[1] - ends[0] } else { rng.vector() };
            let aim = ends[0] + rng.unit() * (ends[1] - ends[0]) + 1.2 * radius * rng.vector();
            let own = ray(aim - 3.0 * d, d);
            let Some(both) = round.meetings(&own, ROUNDING) else { continue };
            met += 1;
            for on in &both {
                on_side += usize::from(on.part == Part::Side);
                let off = (own.origin + on.t * d - round.0.nearest(own.origin + on.t * d)).length() / radius;
                assert!((off - 1.0).abs() < 1e-6, "{n}: {off}");
            }
            let ordered = round.depth(&own, &both[0]).compare(&round.depth(&own, &both[1]));
            assert!(ordered.is_le(), "{n}: {both:?}");
            let middle = own.origin + 0.5 * (both[0].t + both[1].t) * d;
            assert!((middle - round.0.nearest(middle)).length() <= radius * (1.0 + 1e-9), "{n}");
        }
        assert!(met > 1000 && on_side > 500, "{met} {on_side}");
    }
}
