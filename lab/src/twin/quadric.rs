//! Where rays meet quadrics, with bounds on what a kernel may find.

use super::Real;
use super::bounded::{Bounded, Bounded3, Judged};
use super::refract::BoundedRay;
use super::smooth::Root;
use anamorph::internals::gpu::layout::Quadric;

/// Rounding of a place's height along the axis, in units of what is summed up to get the place: that much a cap counts
/// beyond its heights.
pub const HEIGHT_UNITS: f64 = 128.0;

/// A quadric as kernels read it, its pairs summed.
struct Terms {
    centre: Bounded3,
    diagonal: Bounded3,
    /// yz, xz, xy.
    beside: Bounded3,
    b: Bounded3,
    c: Bounded,
    axis: Bounded3,
    heights: [Bounded; 2],
    rim2: Bounded,
}

impl Terms {
    fn new(q: &Quadric, real: Real) -> Terms {
        let (v, s) = (|hi, lo| Bounded3::pair(hi, lo, real), |hi, lo| Bounded::pair(hi, lo, real));
        Terms {
            centre: v(q.centre_hi, q.centre_lo),
            diagonal: v(q.diagonal_hi, q.diagonal_lo),
            beside: v(q.beside_hi, q.beside_lo),
            b: v(q.b_hi, q.b_lo),
            c: s(q.c_hi, q.c_lo),
            axis: v(q.axis_hi, q.axis_lo),
            heights: [s(q.low_hi, q.low_lo), s(q.high_hi, q.high_lo)],
            rim2: s(q.rim2_hi, q.rim2_lo),
        }
    }

    /// A v.
    fn times(&self, v: Bounded3) -> Bounded3 {
        let ([xx, yy, zz], [yz, xz, xy]) = (self.diagonal.0, self.beside.0);
        Bounded3([Bounded3([xx, xy, xz]), Bounded3([xy, yy, yz]), Bounded3([xz, yz, zz])].map(|row| row.dot(v)))
    }

    /// Half of the gradient, `v` from the centre.
    fn normal(&self, v: Bounded3) -> Bounded3 {
        self.times(v) + self.b
    }

    /// The part of the surface at `v` from the centre is there, its height known up to `error`.
    fn contains(&self, v: Bounded3, error: Bounded) -> Judged {
        let z = v.dot(self.axis);
        let away = v - self.axis * z;
        let within = (self.heights[0] - error).at_most(z).and(z.at_most(self.heights[1] + error));
        within.and(away.dot(away).at_most(self.rim2))
    }
}

/// Where the ray first meets the quadric at a t in range; of a ray that starts on it, the other place.
pub fn first_root(q: &Quadric, ray: &BoundedRay, starts: bool, [t_min, t_max]: [Bounded; 2], real: Real) -> Root {
    let terms = Terms::new(q, real);
    let zero = Bounded::exact(0.0, real);
    let v = ray.p - terms.centre;
    let n = terms.normal(v);
    let a = ray.d.dot(terms.times(ray.d));
    let b = ray.d.dot(n);
    let c = v.dot(n) + v.dot(terms.b) + terms.c;
    let square = b * b - a * c;
    let root = square.sqrt();
    // of the two forms of a root the one in which nothing cancels
    let far = if b.v < 0.0 { root - b } else { -root - b };
    let list = if starts { vec![-(b + b) / a] } else { vec![far / a, c / far] };
    let real_roots = if starts { Judged { yes: true, sure: true } } else { zero.at_most(square) };
    let judge = |t: Bounded| {
        let in_range = t_min.at_most(t).and(t.at_most(t_max));
        let error = Bounded::exact(HEIGHT_UNITS * real.unit() * (v.size() + t.v.abs() * ray.d.size()), real);
        (t, real_roots.and(in_range).and(terms.contains(v + ray.d * t, error)))
    };
    first(list.into_iter().map(judge).filter(|(_, there)| !there.surely_not()).collect())
}

/// The first of the roots that are there.
fn first(roots: Vec<(Bounded, Judged)>) -> Root {
    let there = roots.iter().filter(|r| r.1.yes).map(|r| r.0);
    let t = there.reduce(|a, b| if b.v < a.v { b } else { a });
    // another one that is not surely behind it
    let behind = |r: &Bounded, t: &Bounded| r.v - r.e > t.v + t.e;
    let uncertain = match &t {
        Some(t) => roots.iter().any(|(r, there)| if r == t { !there.sure } else { !behind(r, t) }),
        None => !roots.is_empty(),
    };
    Root { t, uncertain }
}

/// At `place`, of any length; points out.
pub fn normal(q: &Quadric, place: Bounded3, real: Real) -> Bounded3 {
    let terms = Terms::new(q, real);
    terms.normal(place - terms.centre)
}
