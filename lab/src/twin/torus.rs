//! Where rays meet a torus, with bounds on what a kernel may find.

use super::Real;
use super::along::Along;
use super::bounded::{Bounded, Bounded3};
use super::refract::BoundedRay;
use super::smooth::Root;
use anamorph::internals::gpu::layout::Torus;

/// Square of the radius of the ball that is searched, in units of the size.
pub const MARGIN: f64 = 1.125;

/// Steps of a kernel at most.
pub const STEPS: u32 = 256;

/// Units of rounding of a quartic's value, of its terms: four products and four sums.
const HORNER_UNITS: f64 = 8.0;

/// A torus as kernels read it, its pairs summed.
struct Terms {
    centre: Bounded3,
    size: Bounded,
    axis: Bounded3,
    ring: Bounded,
}

impl Terms {
    fn new(g: &Torus, real: Real) -> Terms {
        let (v, s) = (|hi, lo| Bounded3::pair(hi, lo, real), |hi, lo| Bounded::pair(hi, lo, real));
        Terms {
            centre: v(g.centre_hi, g.centre_lo),
            size: s(g.size_hi, g.size_lo),
            axis: v(g.axis_hi, g.axis_lo),
            ring: s(g.ring_hi, g.ring_lo),
        }
    }
}

/// Where the ray first meets the torus at a t in range; of a ray that starts on it, the next place.
pub fn first_root(torus: &Torus, ray: &BoundedRay, starts: bool, [t_min, t_max]: [Bounded; 2], real: Real) -> Root {
    let number = |v: f64| Bounded::exact(v, real);
    let g = Terms::new(torus, real);
    let o = ray.p - g.centre;
    // a place on the ray, and a scale; those of another kernel are others of the same ray
    let middle = number(if starts { 0.0 } else { -o.dot(ray.d).v / ray.d.dot(ray.d).v });
    let d_length = number(ray.d.norm().v);
    let q = (o + ray.d * middle) / g.size;
    let u = ray.d / d_length;
    let speed = d_length / g.size;
    let (z, w, b, qq) = (q.dot(g.axis), u.dot(g.axis), q.dot(u), q.dot(q));
    let one = number(1.0);
    let k = qq + g.ring + g.ring - one;
    let four = number(4.0) * g.ring * g.ring;
    let c0 = if starts { number(0.0) } else { k * k - four * (qq - z * z) };
    let c1 = number(4.0) * k * b - (four + four) * (b - z * w);
    let c2 = number(4.0) * b * b + k + k - four * (one - w * w);
    let c3 = number(4.0) * b;

    let square = b * b + number(MARGIN) - qq;
    if square.v < 0.0 {
        return Root::NONE;
    }
    let chord = square.sqrt();
    let (from, to) = ((-b - chord).max((t_min - middle) * speed), (chord - b).min((t_max - middle) * speed));
    let [a0, a1, a2, a3] = [c0, c1, c2, c3].map(|c| c.v);
    let bend = |s: f64| 2.0 * a2 + s * (6.0 * a3 + 12.0 * s);
    let bends = [2.0 * a2 - 0.75 * a3 * a3, bend(from.v).max(bend(to.v))];
    let from = if starts { number(a1.abs() / bends[1].max(-bends[0])) } else { from };

    // a value's terms are no larger than at the farther end
    let reach = from.v.abs().max(to.v.abs());
    let loss = |c: Bounded| c.e + HORNER_UNITS * c.unit() * c.v.abs();
    let beyond = loss(c1) + reach * (loss(c2) + reach * (loss(c3) + reach * HORNER_UNITS * one.unit()));
    let error = if starts { [0.0, beyond] } else { [loss(c0) + reach * beyond, 0.0] };
    let function = |s: f64| {
        let value = a0 + s * (a1 + s * (a2 + s * (a3 + s)));
        [value, a1 + s * (2.0 * a2 + s * (3.0 * a3 + 4.0 * s))]
    };
    let root = Along { function, bends, error, span: [from, to], most: STEPS }.first_root();
    Root { t: root.t.map(|s| middle + s / speed), ..root }
}

/// A quarter of the gradient at `place`.
pub fn normal(torus: &Torus, place: Bounded3, real: Real) -> Bounded3 {
    let g = Terms::new(torus, real);
    let q = (place - g.centre) / g.size;
    let away = q - g.axis * q.dot(g.axis);
    q * (q.dot(q) + g.ring + g.ring - Bounded::exact(1.0, real)) - away * ((g.ring + g.ring) * g.ring)
}
