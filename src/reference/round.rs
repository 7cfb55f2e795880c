//! One ray or curve against one sphere or capsule: `docs/reference/definitions.md`, Spheres and capsules.
//!
//! Of the ray `X(t) = (p + t d) / h` and the ball about `c` let `m = c h - p` and `R = r h`. It is met where `|t d - m| = R`, that is,
//! at `t = (d . m -+ s) / d . d`, `s` being the root of `d . d R^2 - |d x m|^2`. Where f64 does not prove what is below the root, or
//! `m . m - R^2`, to half of [`T_ROUNDING`], these are summed exactly.
//!
//! The tube about the line through `c` along `u` is met where `|t d x u - m x u| = R |u|`. As `(d x u) x (m x u) = (u . (d x m)) u`, what is
//! below the root is `|u|^2 (|d x u|^2 R^2 - (u . (d x m))^2)`. A capsule lies in its tube: a ray enters it where it enters the tube, if that
//! is between the ends, and else where it enters the ball about the end beyond which it entered the tube. It leaves in the same way.
//!
//! A curve is on a ball where `|X(t) - c|^2 - r^2` is 0, a polynomial of twice its degree, and on a tube where the same is true of its offset
//! from the axis: all roots are found ([`crate::geometry::bernstein`]).

use super::curve::{POINT_ROUNDING, blur};
use super::intersect::{T_ROUNDING, TERM_ROUNDING, cross_size, offset_size};
use super::margin::GAP;
use crate::arrays::MapEach;
use crate::camera::bundle::Bundle;
use crate::camera::curve::Curve;
use crate::geometry::bernstein::{Bernstein, Root, VALUE_ROUNDING};
use crate::geometry::exact::{Exact, Exact3};
use crate::geometry::mesh::joined;
use crate::geometry::primitive::Capsule;
use glam::DVec3;

/// A sphere or capsule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Round(pub Capsule);

/// The ball about an end.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ball {
    centre: DVec3,
    radius: f64,
}

/// The tube about the line through two points.
#[derive(Debug, Clone, Copy)]
struct Tube {
    ends: [DVec3; 2],
    radius: f64,
}

/// How a ray meets a tube.
enum ThroughTube {
    Passes,
    /// All along it, inside.
    Inside,
    /// Between two t.
    Between([f64; 2]),
}

/// The parts of the surface of a capsule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    First,
    Side,
    Last,
}

/// By how much of its radius a place on a capsule may lie beyond the end of a part: the parts touch there, so that the surface is off by half the
/// square of that.
const SEAM: f64 = 1.0 / (1_u64 << 20) as f64;

impl Round {
    /// The box around it, and around what rounding makes of its ends.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let [first, last] = self.balls().map(|ball| ball.bounds());
        joined(first, last)
    }

    fn balls(&self) -> [Ball; 2] {
        let radius = self.0.radius;
        self.0.ends.map_each(|centre| Ball { centre, radius })
    }

    /// `None` of a sphere.
    fn tube(&self) -> Option<Tube> {
        let Capsule { ends, radius } = self.0;
        (ends[0] != ends[1]).then_some(Tube { ends, radius })
    }

    /// Where the bundle's central ray enters and leaves it, at any t; twice the same where it touches it. `h > 0`.
    pub fn meetings(&self, b: &Bundle) -> Option<[f64; 2]> {
        let [first, last] = self.balls();
        let Some(tube) = self.tube() else { return first.meetings(b) };
        let whole = match tube.meetings(b) {
            ThroughTube::Passes => return None,
            ThroughTube::Inside => [f64::NEG_INFINITY, f64::INFINITY],
            ThroughTube::Between(whole) => whole,
        };
        let part = |k: usize| match tube.part_at(b, whole[k]) {
            Part::First => Some(first.meetings(b)?[k]),
            Part::Side => Some(whole[k]),
            Part::Last => Some(last.meetings(b)?[k]),
        };
        let entered = part(0)?;
        Some([entered, part(1).map_or(entered, |left| left.max(entered))])
    }

    /// Where a curve passes or touches the surface, ascending: where it enters, the sign is -1.
    pub fn roots(&self, curve: &Curve) -> Vec<Root> {
        let mut roots: Vec<Root> = self.heights().flat_map(|part| self.roots_on(part, curve)).collect();
        roots.sort_unstable_by(|a, b| a.t.total_cmp(&b.t));
        roots
    }

    fn heights(&self) -> impl Iterator<Item = Part> {
        let others = self.tube().map(|_| [Part::Side, Part::Last]);
        [Part::First].into_iter().chain(others.into_iter().flatten())
    }

    fn roots_on(&self, part: Part, curve: &Curve) -> Vec<Root> {
        let (height, zero) = self.height(part, curve);
        let mut roots = height.roots(zero);
        roots.retain(|root| self.is_on(part, curve.at(root.t)));
        roots
    }

    /// Whether a place on a ball or the tube is on the capsule too.
    fn is_on(&self, part: Part, p: DVec3) -> bool {
        let Some(Tube { ends: [a, b], radius }) = self.tube() else { return true };
        let length = (b - a).length();
        let place = (p - a).dot(b - a) / length;
        let seam = SEAM * radius;
        match part {
            Part::First => place <= seam,
            Part::Side => place >= -seam && place <= length + seam,
            Part::Last => place >= length - seam,
        }
    }

    /// The curve meets the surface so flat at `t` that the place is not sure to [`GAP`].
    pub fn is_flat(&self, curve: &Curve, t: f64) -> bool {
        let p = curve.at(t);
        let is_flat = |part: Part| {
            let (height, zero) = self.height(part, curve);
            2.0 * blur(&height, zero, t) > GAP * t.max(GAP)
        };
        self.heights().filter(|part| self.is_on(*part, p)).any(is_flat)
    }

    /// The polynomial of a part, and up to which values it may be 0.
    fn height(&self, part: Part, curve: &Curve) -> (Bernstein, f64) {
        let Capsule { ends: [first, last], radius } = self.0;
        let axis = (last - first).normalize_or_zero();
        let points = curve.points();
        let from = |p: &DVec3| match part {
            Part::First => *p - first,
            Part::Side => *p - first - (*p - first).dot(axis) * axis,
            Part::Last => *p - last,
        };
        let offsets: Vec<DVec3> = points.iter().map(from).collect();
        let degree = points.len() - 1;
        let coefficient = |j: usize| {
            let terms = (0..=degree).filter(|i| *i <= j && j - i <= degree);
            let sum: f64 =
                terms.map(|i| choose(degree, i) * choose(degree, j - i) * offsets[i].dot(offsets[j - i])).sum();
            sum / choose(2 * degree, j) - radius * radius
        };
        let height = Bernstein::new(&(0..=2 * degree).map(coefficient).collect::<Vec<_>>());
        let reach =
            |(p, offset): (&DVec3, &DVec3)| if part == Part::Side { (*p - first).length() } else { offset.length() };
        let far = points.iter().zip(&offsets).map(reach).fold(radius, f64::max);
        let coordinate = points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        // a square of sums of three terms, a weight, a sum of up to four products: twice as many roundings as an edge value has; and
        // the control points' own, on each axis; an offset from an axis takes as many again
        let times = if part == Part::Side { 2.0 } else { 1.0 };
        let zero = times * (2.0 * TERM_ROUNDING * far * far + 2.0 * 3.0f64.sqrt() * far * POINT_ROUNDING * coordinate)
            + 2.0 * VALUE_ROUNDING * height.size();
        (height, zero)
    }
}

impl Tube {
    fn axis(&self) -> DVec3 {
        self.ends[1] - self.ends[0]
    }

    /// The part of the capsule that a ray is beside at `t`. `h > 0`.
    fn part_at(&self, b: &Bundle, t: f64) -> Part {
        let (p, d, h) = (b.p[0], b.d[0], b.h[0]);
        let axis = self.axis();
        let slope = d.dot(axis);
        let place = if t.is_infinite() { t * slope } else { t * slope - (self.ends[0] * h - p).dot(axis) };
        match place {
            _ if place < 0.0 => Part::First,
            _ if place > axis.length_squared() * h => Part::Last,
            _ => Part::Side,
        }
    }

    fn meetings(&self, b: &Bundle) -> ThroughTube {
        let (p, d, h) = (b.p[0], b.d[0], b.h[0]);
        let (m, large, u) = (self.ends[0] * h - p, self.radius * h, self.axis());
        let offset = offset_size(self.ends[0], p, h);
        let (across, across_size) = (d.cross(u), cross_size(d.abs(), u.abs()).element_sum());
        let (away, away_size) = (m.cross(u), cross_size(offset, u.abs()).element_sum());
        let (side, side_size) = (u.dot(d.cross(m)), u.abs().dot(cross_size(d.abs(), offset)));
        let square = large * large;
        let a = across.length_squared();
        let [below, along, beyond] =
            [a * square - side * side, across.dot(away), away.length_squared() - square * u.length_squared()];

        // components lose TERM_ROUNDING of their sizes, and half as much for the axis
        let unit = 2.0 * TERM_ROUNDING;
        let a_error = 3.0 * unit * across_size * across_size;
        let side_error = unit * side_size;
        let below_error =
            square * a_error + unit * (a * square + side * side) + side_error * (2.0 * side.abs() + side_error);
        let beyond_error = 3.0 * unit * (away_size * away_size + square * u.length_squared());
        let along_error = 2.0 * unit * across_size * away_size;
        let is_sure = |error: f64, value: f64| 4.0 * error <= T_ROUNDING * value.abs();
        let far = along + (u.length_squared() * below.max(0.0)).sqrt().copysign(along);
        let is_proven = is_sure(a_error, a) && (below < -below_error || is_sure(below_error, below));
        let numbers = match is_proven && is_sure(along_error, far) && is_sure(beyond_error, beyond) {
            true => TubeNumbers { a, below, along, beyond },
            false => self.exact_numbers(p, d, h),
        };
        numbers.meetings(u.length_squared())
    }

    fn exact_numbers(&self, p: DVec3, d: DVec3, h: f64) -> TubeNumbers {
        let one = |x: f64| Exact::product(x, 1.0);
        let [first, last] = self.ends;
        let u: Exact3 = [0, 1, 2].map_each(|k| one(last[k]).minus(&one(first[k])));
        let m: Exact3 = [0, 1, 2].map_each(|k| Exact::product(first[k], h).minus(&one(p[k])));
        let d: Exact3 = d.to_array().map_each(one);
        let large = Exact::product(self.radius, h);
        let square = large.by(&large);
        let (across, away) = (exact_cross(&d, &u), exact_cross(&m, &u));
        let a = exact_dot(&across, &across);
        let side = exact_dot(&u, &exact_cross(&d, &m));
        TubeNumbers {
            below: a.by(&square).minus(&side.by(&side)).value(),
            along: exact_dot(&across, &away).value(),
            beyond: exact_dot(&away, &away).minus(&square.by(&exact_dot(&u, &u))).value(),
            a: a.value(),
        }
    }
}

fn exact_dot(a: &Exact3, b: &Exact3) -> Exact {
    (0..3).fold(Exact::default(), |sum, k| sum.plus(&a[k].by(&b[k])))
}

fn exact_cross(a: &Exact3, b: &Exact3) -> Exact3 {
    let minor = |i: usize, j: usize| a[i].by(&b[j]).minus(&a[j].by(&b[i]));
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

/// A ray is on a tube at `t = (along -+ root of u . u below) / a`, whose product is `beyond / a`.
struct TubeNumbers {
    a: f64,
    below: f64,
    along: f64,
    beyond: f64,
}

impl TubeNumbers {
    fn meetings(&self, axis_squared: f64) -> ThroughTube {
        if self.a == 0.0 {
            return if self.beyond <= 0.0 { ThroughTube::Inside } else { ThroughTube::Passes };
        }
        if self.below < 0.0 {
            return ThroughTube::Passes;
        }
        let far = self.along + (axis_squared * self.below).sqrt().copysign(self.along);
        if far == 0.0 {
            return ThroughTube::Between([0.0; 2]);
        }
        let (one, other) = (far / self.a, self.beyond / far);
        ThroughTube::Between([one.min(other), one.max(other)])
    }
}

impl Ball {
    fn bounds(&self) -> (DVec3, DVec3) {
        let ends = |v: f64| [(v - self.radius).next_down(), (v + self.radius).next_up()];
        let [x, y, z] = self.centre.to_array().map_each(ends);
        (DVec3::new(x[0], y[0], z[0]), DVec3::new(x[1], y[1], z[1]))
    }

    /// Where the bundle's central ray enters and leaves it, as [`Round::meetings`].
    fn meetings(&self, b: &Bundle) -> Option<[f64; 2]> {
        let (p, d, h) = (b.p[0], b.d[0], b.h[0]);
        let (m, large) = (self.centre * h - p, self.radius * h);
        let offset = offset_size(self.centre, p, h);
        let (w, w_size) = (d.cross(m), cross_size(d.abs(), offset));
        let (a, along) = (d.length_squared(), d.dot(m));

        let mut below = a * large * large - w.length_squared();
        let w_error = TERM_ROUNDING * w_size.element_sum();
        let w_size = w_size.element_sum();
        let below_error = TERM_ROUNDING * (a * large * large + w_size * w_size) + 2.0 * w_size * w_error;
        if 4.0 * below_error > T_ROUNDING * below.abs() {
            below = self.exactly_below(p, d, h);
        }
        if below < 0.0 {
            return None;
        }
        let mut beyond = m.length_squared() - large * large;
        let beyond_error = 4.0 * TERM_ROUNDING * (offset.length_squared() + large * large);
        if 4.0 * beyond_error > T_ROUNDING * beyond.abs() {
            beyond = self.exactly_beyond(p, h);
        }
        // the two t have the product beyond / a; the sum of numbers of one sign cancels nothing
        let far = along + below.sqrt().copysign(along);
        if far == 0.0 {
            return Some([0.0; 2]);
        }
        let (one, other) = (far / a, beyond / far);
        Some([one.min(other), one.max(other)])
    }

    /// `m`.
    fn exact_offset(&self, p: DVec3, h: f64) -> Exact3 {
        let one = |k: usize| Exact::product(self.centre[k], h).minus(&Exact::product(p[k], 1.0));
        [one(0), one(1), one(2)]
    }

    /// `R^2`.
    fn exact_square(&self, h: f64) -> Exact {
        let large = Exact::product(self.radius, h);
        large.by(&large)
    }

    /// `d . d R^2 - |d x m|^2`.
    fn exactly_below(&self, p: DVec3, d: DVec3, h: f64) -> f64 {
        let m = self.exact_offset(p, h);
        let squares = |v: &Exact3| v.iter().fold(Exact::default(), |sum, x| sum.plus(&x.by(x)));
        let minor = |i: usize, j: usize| m[j].times(d[i]).minus(&m[i].times(d[j]));
        let a = squares(&d.to_array().map_each(|x| Exact::product(x, 1.0)));
        a.by(&self.exact_square(h)).minus(&squares(&[minor(1, 2), minor(2, 0), minor(0, 1)])).value()
    }

    /// `m . m - R^2`.
    fn exactly_beyond(&self, p: DVec3, h: f64) -> f64 {
        let m = self.exact_offset(p, h);
        let square = m.iter().fold(Exact::default(), |sum, x| sum.plus(&x.by(x)));
        square.minus(&self.exact_square(h)).value()
    }
}

fn choose(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |c, j| c * (n - j) as f64 / (j + 1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Rng;

    /// A parabola and a circle around the same place: closed forms, and a touch.
    #[test]
    fn curves_enter_leave_and_touch() {
        // X = (2 t - 1, (2 t - 1)^2, 0)
        let curve = Curve::new(&[DVec3::new(-1.0, 1.0, 0.0), DVec3::new(0.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0)]);
        let roots = |centre: DVec3, radius: f64| sphere(centre, radius).roots(&curve);
        // x^2 + x^4 = r^2
        for radius in [0.3_f64, 0.7, 1.2] {
            let x = (0.5 * ((1.0 + 4.0 * radius * radius).sqrt() - 1.0)).sqrt();
            let found = roots(DVec3::ZERO, radius);
            assert_eq!(found.iter().map(|r| r.sign).collect::<Vec<_>>(), [-1, 1]);
            for (root, x) in found.iter().zip([-x, x]) {
                assert!((root.t - 0.5 * (x + 1.0)).abs() < 1e-14, "{} {x}", root.t);
            }
        }
        let touch = roots(DVec3::new(0.0, -2.0, 0.0), 2.0);
        assert_eq!((touch.len(), touch[0].sign), (1, 0));
        assert!((touch[0].t - 0.5).abs() < 1e-7);
        assert!(roots(DVec3::new(0.0, -2.0, 0.0), 1.999).is_empty());
        // four times through one ball
        assert_eq!(roots(DVec3::new(0.0, 0.6, 0.0), 0.595).iter().map(|r| r.sign).collect::<Vec<_>>(), [-1, 1, -1, 1]);
    }

    fn sphere(centre: DVec3, radius: f64) -> Round {
        Round(Capsule { ends: [centre; 2], radius })
    }

    fn ray(p: DVec3, d: DVec3, h: f64) -> Bundle {
        Bundle { p: [p * h, DVec3::ZERO, DVec3::ZERO], d: [d * h, DVec3::ZERO, DVec3::ZERO], h: [h, 0.0, 0.0] }
    }

    #[test]
    fn rays_enter_leave_touch_and_pass() {
        let sphere = sphere(DVec3::new(1.0, 2.0, 3.0), 5.0);
        // 3, 4, 5 and powers of two: no rounding
        for h in [1.0, 0.5, 4.0] {
            let through = ray(DVec3::new(4.0, 2.0, -13.0), 2.0 * DVec3::Z, h);
            assert_eq!(sphere.meetings(&through), Some([6.0, 10.0]));
            let touching = ray(DVec3::new(6.0, 2.0, -13.0), 2.0 * DVec3::Z, h);
            assert_eq!(sphere.meetings(&touching), Some([8.0; 2]));
            let passing = ray(DVec3::new(6.0_f64.next_up(), 2.0, -13.0), 2.0 * DVec3::Z, h);
            assert_eq!(sphere.meetings(&passing), None);
            let inside = ray(DVec3::new(4.0, 2.0, 3.0), -DVec3::Z, h);
            assert_eq!(sphere.meetings(&inside), Some([-4.0, 4.0]));
            let at_the_middle = ray(DVec3::new(6.0, 2.0, 3.0), DVec3::Z, h);
            assert_eq!(sphere.meetings(&at_the_middle), Some([0.0; 2]));
        }
    }

    /// The point at t is on the sphere to within the error of t, which is relative; f64 alone is off by a million times as much.
    #[test]
    fn small_spheres_far_away_are_met_as_exactly() {
        let mut rng = Rng(3);
        let mut met = 0;
        for _ in 0..2000 {
            let mut vector = || rng.vector();
            let (d, centre, beside) = (vector(), 4.0 * vector(), vector());
            let radius = 1e-7;
            let p = centre - 3.0 * d + radius * beside;
            let ball = Ball { centre, radius };
            let Some(t) = ball.meetings(&ray(p, d, 1.0)) else { continue };
            met += 1;
            // m and t d - m without rounding
            let m = ball.exact_offset(p, 1.0);
            for t in t {
                let rest: Exact = (0..3).fold(Exact::default(), |sum, k| {
                    let x = Exact::product(d[k], t).minus(&m[k]);
                    sum.plus(&x.by(&x))
                });
                let off = rest.minus(&ball.exact_square(1.0)).value().abs();
                assert!(off <= 4.0 * T_ROUNDING * t.abs() * d.length() * radius, "{off}");
            }
        }
        assert!(met > 500 && met < 1900, "{met}");
    }

    #[test]
    fn its_box_holds_it() {
        let ball = Ball { centre: DVec3::splat(1e9 / 3.0), radius: 1.0 / 3.0 };
        let (lo, hi) = ball.bounds();
        let end = |sign: f64| Exact::product(ball.centre.x, 1.0).plus(&Exact::product(sign * ball.radius, 1.0));
        assert_eq!(end(-1.0).minus(&Exact::product(lo.x, 1.0)).sign(), 1);
        assert_eq!(end(1.0).minus(&Exact::product(hi.x, 1.0)).sign(), -1);
    }

    /// Capsules of all shapes, and how far a place is from the segment of one, in radii.
    fn any_capsule(rng: &mut Rng) -> Round {
        let radius = 10f64.powf(-2.0 * rng.unit());
        let length = 10f64.powf(1.0 - 4.0 * rng.unit());
        let end = rng.vector();
        Round(Capsule { ends: [end, end + length * rng.vector().normalize()], radius })
    }

    fn distance(round: &Round, p: DVec3) -> f64 {
        (p - round.0.nearest(p)).length() / round.0.radius
    }

    /// A capsule is convex: a ray is in it between the two t, and nowhere else. Every fourth ray is parallel to the axis, or nearly so.
    #[test]
    fn rays_are_in_a_capsule_between_the_two_t() {
        let mut rng = Rng(11);
        let (mut met, mut passed) = (0, 0);
        for n in 0..40_000 {
            let round = any_capsule(&mut rng);
            let [a, b] = round.0.ends;
            let aim = a + rng.unit() * (b - a) + 1.2 * round.0.radius * rng.vector();
            let d = match n % 8 {
                0 => b - a,
                1 => b - a + 1e-9 * rng.vector(),
                _ => rng.vector(),
            };
            let p = aim - 3.0 * d;
            let place = |t: f64| distance(&round, p + t * d);
            // the place of the ray that is nearest to the segment, by halving
            let far = 20.0 + 4.0 * round.0.radius / d.length();
            let (mut lo, mut hi) = (-far, far);
            for _ in 0..200 {
                let [one, two] = [lo + 0.4 * (hi - lo), lo + 0.6 * (hi - lo)];
                if place(one) < place(two) { hi = two } else { lo = one }
            }
            let nearest = place(0.5 * (lo + hi));
            match round.meetings(&ray(p, d, 1.0)) {
                Some([entered, left]) => {
                    met += 1;
                    assert!(nearest < 1.0 + 1e-9, "{n}: {nearest}");
                    // a root loses half of the digits where the ray touches
                    for t in [entered, left] {
                        assert!((place(t) - 1.0).abs() < 1e-7, "{n}: {} at {t}", place(t));
                    }
                    assert!(place(0.5 * (entered + left)) <= 1.0 + 1e-9, "{n}");
                }
                None => {
                    passed += 1;
                    assert!(nearest > 1.0 - 1e-9, "{n}: {nearest}");
                }
            }
        }
        assert!(met > 10_000 && passed > 3000, "{met} {passed}");
    }

    /// f64 and exact sums give the same t.
    #[test]
    fn tubes_are_met_alike_in_f64_and_exactly() {
        let mut rng = Rng(12);
        for n in 0..2000 {
            let Round(Capsule { ends, radius }) = any_capsule(&mut rng);
            let tube = Tube { ends, radius };
            let d = rng.vector();
            let p = ends[0] + 0.5 * radius * rng.vector() - 2.0 * d;
            let exact = tube.exact_numbers(p, d, 1.0).meetings(tube.axis().length_squared());
            match (tube.meetings(&ray(p, d, 1.0)), exact) {
                (ThroughTube::Between(one), ThroughTube::Between(two)) => {
                    let off = (0..2).map(|k| (one[k] - two[k]).abs() / two[k].abs()).fold(0.0, f64::max);
                    assert!(off <= T_ROUNDING, "{n}: {one:?} {two:?}");
                }
                (one, two) => assert_eq!(std::mem::discriminant(&one), std::mem::discriminant(&two), "{n}"),
            }
        }
    }

    /// Roots lie on the surface, enter and leave in turn, and no place between two has another side.
    #[test]
    fn curves_enter_and_leave_capsules_in_turn() {
        let mut rng = Rng(13);
        let mut met = 0;
        for n in 0..4000 {
            let round = any_capsule(&mut rng);
            let points: Vec<DVec3> = (0..2 + rng.below(3)).map(|_| round.0.ends[0] + 2.0 * rng.vector()).collect();
            let curve = Curve::new(&points);
            let roots = round.roots(&curve);
            let heights = |t: f64| distance(&round, curve.at(t)) - 1.0;
            for root in &roots {
                assert!(heights(root.t).abs() < 1e-6, "{n}: {}", heights(root.t));
            }
            let mut inside = heights(0.0) < 0.0;
            let mut ends = vec![0.0];
            ends.extend(roots.iter().filter(|root| root.sign != 0).map(|root| root.t));
            ends.push(1.0);
            // the parts of the surface may both have a root on their seam
            ends.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
            for pair in ends.windows(2) {
                let middle = heights(0.5 * (pair[0] + pair[1]));
                assert!(middle.abs() < 1e-6 || (middle < 0.0) == inside, "{n}: {middle} between {pair:?} of {roots:?}");
                inside = !inside;
            }
            met += roots.len();
        }
        assert!(met > 500, "{met}");
    }
}
