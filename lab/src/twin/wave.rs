//! Where rays meet a wave, with bounds on what a kernel may find.

use super::Real;
use super::along::Along;
use super::bounded::{Bounded, Bounded3, CIRCLE_UNITS};
use super::refract::BoundedRay;
use super::smooth::Root;
use anamorph::internals::gpu::layout::Wave;
use std::f64::consts::{PI, TAU};

/// The height that is searched, in amplitudes.
pub const MARGIN: f64 = 1.0625;

/// Steps of a kernel at most, and for every half wave along the ray.
pub const STEPS: u32 = 256;
pub const WAVE_STEPS: f64 = 64.0;

/// A wave as kernels read it, its pairs summed.
struct Terms {
    centre: Bounded3,
    half: Bounded,
    amplitude: Bounded,
    frequency: Bounded,
}

impl Terms {
    fn new(w: &Wave, real: Real) -> Terms {
        let pair = |hi, lo| Bounded::pair(hi, lo, real);
        Terms {
            centre: Bounded3::pair(w.centre_hi, w.centre_lo, real),
            half: pair(w.half_hi, w.half_lo),
            amplitude: pair(w.amplitude_hi, w.amplitude_lo),
            frequency: pair(w.frequency_hi, w.frequency_lo),
        }
    }
}

/// The part of a span in which p + t d is at most `half`.
fn clipped(part: [Bounded; 2], p: Bounded, d: Bounded, half: Bounded) -> [Bounded; 2] {
    if d.v == 0.0 {
        let within = p.abs().at_most(half);
        let sure = within.sure && d.e == 0.0;
        let end = if within.yes { part[1] } else { part[0] - Bounded::exact(1.0, Real::F64) };
        return if sure { [part[0], end] } else { [part[0].lost(), end.lost()] };
    }
    let (a, b) = ((-half - p) / d, (half - p) / d);
    [part[0].max(a.min(b)), part[1].min(a.max(b))]
}

/// Where the ray first meets the wave at a t in range; of a ray that starts on it, the next place.
pub fn first_root(wave: &Wave, ray: &BoundedRay, starts: bool, range: [Bounded; 2], real: Real) -> Root {
    let number = |v: f64| Bounded::exact(v, real);
    let w = Terms::new(wave, real);
    let o = ray.p - w.centre;
    let ([ox, oy, oz], [dx, dy, dz]) = (o.0, ray.d.0);
    let over = clipped(range, oy, dy, number(MARGIN) * w.amplitude);
    let mut part = clipped(clipped(over, ox, dx, w.half), oz, dz, w.half);
    if starts {
        part[0] = number(0.0);
    }

    // from a place on the ray; another kernel's own is another one of the same ray
    let enters = number(part[0].v);
    let [x, y, z] = (o + ray.d * enters).0;
    let (u, v) = (w.frequency * (x - z), w.frequency * (x + z));
    let (ku, kv) = (w.frequency * (dx - dz), w.frequency * (dx + dz));
    let [sine_x, sine_z] = [x, z].map(|x| (w.frequency * x).circle()[1]);
    let c = if starts { number(0.0) } else { y - w.amplitude * sine_x * sine_z };
    let function = |s: f64| {
        // a cosine's change over -2, and half of the sine behind it
        let swing = |u: Bounded, ku: Bounded| {
            let ((m, _), (h, _)) = ((TAU * (u.v + 0.5 * ku.v * s)).sin_cos(), (PI * ku.v * s).sin_cos());
            (m * h, 0.5 * (TAU * (u.v + ku.v * s)).sin())
        };
        let ((a, slope_a), (b, slope_b)) = (swing(u, ku), swing(v, kv));
        let slope = dy.v + w.amplitude.v * TAU * (ku.v * slope_a - kv.v * slope_b);
        [c.v + (dy.v * s + w.amplitude.v * (a - b)), slope]
    };
    let length = (part[1] - enters).v;
    let bend = {
        let [x, z] = [dx, dz].map(|d| TAU * w.frequency.v * d.v.abs());
        let sines = (sine_x.v.abs() + x * length).min(sine_z.v.abs() + z * length);
        w.amplitude.v * (x * x + z * z).min((x * x + z * z) * sines + 2.0 * x * z)
    };
    let span = if starts {
        [number(function(0.0)[1].abs() / bend), part[1]]
    } else {
        [number(0.0).off_by(part[0].e), number(length).off_by(part[1].e)]
    };

    // what goes with s: the place in both waves, how fast these pass, and the products
    let unit = c.unit();
    let swing_loss = |u: Bounded, ku: Bounded| {
        let (speed, revolutions) = (PI * ku.v.abs(), u.v.abs() + ku.v.abs() * length.abs());
        speed * (TAU * u.e + unit * (3.0 * CIRCLE_UNITS + TAU * revolutions)) + PI * ku.e
    };
    let swings = w.amplitude.v * (swing_loss(u, ku) + swing_loss(v, kv));
    let amplitude_loss = (w.amplitude.e + 3.0 * unit * w.amplitude.v) * PI * (ku.v.abs() + kv.v.abs());
    let error = [c.e + unit * c.v.abs(), dy.e + 3.0 * unit * dy.v.abs() + swings + amplitude_loss];
    let half_waves = 2.0 * length.max(0.0) * (ku.v.abs() + kv.v.abs());
    let root = Along { function, bends: [-bend, bend], error, span, most: STEPS + (WAVE_STEPS * half_waves) as u32 }
        .first_root();
    Root { t: root.t.map(|s| s + enters), ..root }
}

/// At `place`; points up.
pub fn normal(wave: &Wave, place: Bounded3, real: Real) -> Bounded3 {
    let w = Terms::new(wave, real);
    let [x, _, z] = (place - w.centre).0;
    let ([cx, sx], [cz, sz]) = ((w.frequency * x).circle(), (w.frequency * z).circle());
    let steep = Bounded::exact(-TAU, real) * w.frequency * w.amplitude;
    Bounded3([steep * cx * sz, Bounded::exact(1.0, real), steep * sx * cz])
}
