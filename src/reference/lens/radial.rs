//! Radial models: the radius that is seen at a given one, on the branch from the middle to where the model first stops growing, or on one
//! behind a pole.

use crate::arrays::MapEach;
use crate::camera::calibration::Coefficients;
use std::ops::{Add, Div, Mul};

/// The numbers from the first to the second.
#[derive(Debug, Clone, Copy)]
pub struct Range(pub f64, pub f64);

impl Range {
    pub fn at(x: f64) -> Range {
        Range(x, x)
    }
}

impl Add for Range {
    type Output = Range;
    fn add(self, b: Range) -> Range {
        Range(self.0 + b.0, self.1 + b.1)
    }
}

impl Mul for Range {
    type Output = Range;
    fn mul(self, b: Range) -> Range {
        let all = [self.0 * b.0, self.0 * b.1, self.1 * b.0, self.1 * b.1];
        Range(all.iter().fold(f64::INFINITY, |m, v| m.min(*v)), all.iter().fold(f64::NEG_INFINITY, |m, v| m.max(*v)))
    }
}

/// The divisor must be over 0.
impl Div for Range {
    type Output = Range;
    fn div(self, b: Range) -> Range {
        self * Range(1.0 / b.1, 1.0 / b.0)
    }
}

/// 1 + c1 q + c2 q^2 + ..., and its derivative.
pub fn series(c: &[f64], q: Range) -> (Range, Range) {
    let (mut power, mut value, mut slope) = (Range::at(1.0), Range::at(1.0), Range::at(0.0));
    for (n, c) in c.iter().enumerate() {
        slope = slope + Range::at((n + 1) as f64 * c) * power;
        power = power * q;
        value = value + Range::at(*c) * power;
    }
    (value, slope)
}

/// d(r g)/dr of Brown's radial part at `r`, and a bound on its derivative over [lo, hi]; `None` where g's denominator may not have the
/// sign `side`.
pub fn slope(k: &Coefficients, side: f64, r: f64, [lo, hi]: [f64; 2]) -> Option<[f64; 2]> {
    // g = 1 + n, n = N / B with N = A - B: A and B nearly cancel in calibrations
    let (mut above, below) = (k.radial, k.below);
    above.iter_mut().zip(below).for_each(|(above, below)| *above -= below);
    let derivatives = |q: Range| {
        let sided = |(value, slope): (Range, Range)| (Range::at(side) * value, Range::at(side) * slope);
        let ((n, dn), (b, db)) = (sided(series(&above, q)), sided(series(&below, q)));
        let second = |c: &[f64]| {
            let terms = c.iter().enumerate().skip(1).rev();
            Range::at(side) * terms.fold(Range::at(0.0), |sum, (n, c)| sum * q + Range::at(((n + 1) * n) as f64 * c))
        };
        let minus = Range::at(-1.0);
        let n = (n + Range::at(-side)) / b;
        let dn = (dn + minus * n * db) / b;
        let ddn = (second(&above) + Range::at(-2.0) * dn * db + minus * n * second(&below)) / b;
        (n, dn, ddn, b.0 > 0.0)
    };
    let at = Range::at(r * r);
    let (n, dn, ..) = derivatives(at);
    let range = Range(lo, hi);
    let (_, of_range, bend, is_free) = derivatives(range * range);
    // d^2(r g)/dr^2 = 6 r n' + 4 r^3 n''
    let Range(least, most) = Range::at(6.0) * range * of_range + Range::at(4.0) * range * range * range * bend;
    is_free.then_some([1.0 + (n + Range::at(2.0) * at * dn).0, least.abs().max(most.abs())])
}

/// The sign of d(r g)/dr of Brown's radial part: d(r A / B)/dr = ((A + 2 q A') B - 2 q A B') / B^2. It counts as negative where B may not
/// have the sign `side`.
pub fn grows(k: &Coefficients, side: f64, r: Range) -> Range {
    let q = r * r;
    let ((a, da), (b, db)) = (series(&k.radial, q), series(&k.below, q));
    let slope = (a + Range::at(2.0) * q * da) * b + Range::at(-2.0) * q * a * db;
    let sided = Range::at(side) * b;
    if sided.0 > 0.0 { slope } else { Range(sided.0, slope.1) }
}

/// r g of Brown's radial part.
pub fn place(k: &Coefficients, r: f64) -> f64 {
    let q = Range::at(r * r);
    let [above, below] = [&k.radial[..], &k.below].map_each(|c| series(c, q).0.0);
    r * (above / below)
}

/// The radius that Brown's radial terms show at `radius`, on the branch of the middle.
pub fn brown(k: &Coefficients, radius: f64) -> Option<f64> {
    let grows = |r: Range| grows(k, 1.0, r);
    let seen = |r: f64| place(k, r);
    let mut start = 0.0;
    let mut end = 1.0;
    while end < f64::MAX.sqrt() {
        match first(&grows, &seen, [start, end], radius) {
            Found::At(r) => return Some(r),
            Found::Folded => return None,
            Found::Beyond => (start, end) = (end, 2.0 * end),
        }
    }
    None
}

/// The radius between two that Brown's radial terms show at `radius`, if they grow from the first to the second, which may be infinite.
pub fn between(k: &Coefficients, [lo, hi]: [f64; 2], radius: f64) -> Option<f64> {
    let seen = |r: f64| place(k, r);
    let mut end = hi.min(f64::max(1.0, 2.0 * lo));
    while seen(end) < radius && end < hi.min(f64::MAX.sqrt()) {
        end = hi.min(2.0 * end);
    }
    let is_between = seen(lo) <= radius && radius <= seen(end);
    // a secant would start from a pole
    is_between.then(|| bisect(|r| seen(r) >= radius, [lo, end]))
}

/// Where the condition begins to hold in (lo, hi], to the last bit.
pub fn bisect(holds: impl Fn(f64) -> bool, [mut lo, mut hi]: [f64; 2]) -> f64 {
    loop {
        let middle = lo + (hi - lo) / 2.0;
        if middle <= lo || middle >= hi {
            return hi;
        }
        if holds(middle) { hi = middle } else { lo = middle }
    }
}

/// The argument up to `end` at which `seen`, of slope `grows`, first comes to `radius`, while it grows.
pub fn in_range(grows: &impl Fn(Range) -> Range, seen: &impl Fn(f64) -> f64, end: f64, radius: f64) -> Option<f64> {
    match first(grows, seen, [0.0, end], radius) {
        Found::At(at) => Some(at),
        Found::Folded | Found::Beyond => None,
    }
}

/// Whether `seen`, of slope `grows`, grows from 0 to `end`.
pub fn grows_until(grows: &impl Fn(Range) -> Range, seen: &impl Fn(f64) -> f64, end: f64) -> bool {
    matches!(first(grows, seen, [0.0, end], f64::INFINITY), Found::Beyond)
}

enum Found {
    At(f64),
    Folded,
    /// The model grows up to the end, and its value there is smaller.
    Beyond,
}

/// An interval this short, relative to its end, is not divided further: 2^-28. Near a fold the model is flat, so it changes by some 2^-56
/// over it.
const NARROW: f64 = 1.0 / (1u64 << 28) as f64;

/// The first root of `seen = radius` in [lo, hi], for a model that grows up to `lo` and is smaller there.
fn first(grows: &impl Fn(Range) -> Range, seen: &impl Fn(f64) -> f64, [lo, hi]: [f64; 2], radius: f64) -> Found {
    if grows(Range(lo, hi)).0 > 0.0 {
        if seen(hi) < radius {
            return Found::Beyond;
        }
        return Found::At(root(seen, [lo, hi], radius));
    }
    if hi - lo <= NARROW * hi {
        // the model may be flat here and grow again
        let grows_on = grows(Range::at(hi)).0 > 0.0 && seen(hi) < radius;
        return if grows_on { Found::Beyond } else { Found::Folded };
    }
    let middle = lo + (hi - lo) / 2.0;
    match first(grows, seen, [lo, middle], radius) {
        Found::Beyond => first(grows, seen, [middle, hi], radius),
        found => found,
    }
}

/// The root of `seen = radius` in [lo, hi], over which the model grows: the secant method in a bracket, every third step a bisection.
fn root(seen: &impl Fn(f64) -> f64, [mut lo, mut hi]: [f64; 2], radius: f64) -> f64 {
    let (mut below, mut above) = (seen(lo) - radius, seen(hi) - radius);
    for k in 0.. {
        let middle = lo + (hi - lo) * if k % 3 == 2 { 0.5 } else { -below / (above - below) };
        let off = seen(middle) - radius;
        if off == 0.0 || middle <= lo || middle >= hi {
            return middle;
        }
        if off < 0.0 { (lo, below) = (middle, off) } else { (hi, above) = (middle, off) }
    }
    hi
}
