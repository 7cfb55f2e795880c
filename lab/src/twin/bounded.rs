//! Numbers with bounds on the error of a kernel's value: running error analysis (Higham, Accuracy and Stability of
//! Numerical Algorithms, section 3.3). A formula written with them yields its value and its error bound.

use super::Real;
use glam::DVec3;
use std::f64::consts::TAU;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value in f64, and a bound on its distance to any other correct evaluation of the same formula.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounded {
    pub v: f64,
    pub e: f64,
    /// Rounding of one operation, relative: the kernel's and this one's own.
    unit: f64,
}

/// A truth value, and whether every correct evaluation must agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Judged {
    pub yes: bool,
    pub sure: bool,
}

impl Judged {
    pub fn surely_not(self) -> bool {
        self.sure && !self.yes
    }

    pub fn and(self, other: Judged) -> Judged {
        let no = self.surely_not() || other.surely_not();
        Judged { yes: self.yes && other.yes, sure: no || (self.sure && other.sure) }
    }
}

/// Units of rounding of a quotient and of a root, as Vulkan allows f32: 2.5 ulp, and that on top of 2 ulp of an inverse
/// root; an ulp is up to two units.
const DIV_UNITS: f64 = 5.0;
const SQRT_UNITS: f64 = 9.0;
/// Units of rounding of a cosine and of a sine, absolute: the product with 2 pi, of an eighth at most, and the last
/// three operations of the series.
pub const CIRCLE_UNITS: f64 = 4.0;
/// Smaller numbers than this may be flushed to 0.
const TINY: f64 = f32::MIN_POSITIVE as f64;

impl Bounded {
    pub fn exact(v: f64, real: Real) -> Bounded {
        Bounded { v, e: 0.0, unit: real.rounding() + Real::F64.rounding() }
    }

    /// A stored pair, summed up.
    pub fn pair(hi: f32, lo: f32, real: Real) -> Bounded {
        Bounded::exact(f64::from(hi), real) + Bounded::exact(f64::from(lo), real)
    }

    /// The same number with an error as large as any.
    pub fn lost(self) -> Bounded {
        Bounded { e: f64::INFINITY, ..self }
    }

    /// The result `v` of an operation that passes on the error `e` and rounds by so many units.
    fn rounded(self, v: f64, e: f64, units: f64) -> Bounded {
        let e = e + units * self.unit * (v.abs() + e);
        // what comes of infinite errors and results is no bound
        Bounded { v, e: if e.is_nan() { f64::INFINITY } else { e }, unit: self.unit }
    }

    /// Rounding of one operation, relative.
    pub fn unit(self) -> f64 {
        self.unit
    }

    /// The same number with this error.
    pub fn off_by(self, e: f64) -> Bounded {
        Bounded { e, ..self }
    }

    /// A number of the same arithmetic.
    pub fn like(self, v: f64) -> Bounded {
        Bounded { v, e: 0.0, ..self }
    }

    /// The smaller by its value.
    pub fn min(self, o: Bounded) -> Bounded {
        if o.v < self.v { o } else { self }
    }

    /// The larger by its value.
    pub fn max(self, o: Bounded) -> Bounded {
        if o.v > self.v { o } else { self }
    }

    /// Cosine and sine of an angle in revolutions.
    pub fn circle(self) -> [Bounded; 2] {
        let (s, c) = (TAU * (self.v - self.v.round())).sin_cos();
        let e = TAU * self.e + CIRCLE_UNITS * self.unit;
        [c, s].map(|v| Bounded { v, e, unit: self.unit })
    }

    fn is_zero(self) -> bool {
        self.v == 0.0 && self.e == 0.0
    }

    pub fn abs(self) -> Bounded {
        Bounded { v: self.v.abs(), ..self }
    }

    /// The square root; 0 for negative values.
    pub fn sqrt(self) -> Bounded {
        let root = self.v.max(0.0).sqrt();
        let least = self.v - self.e;
        // roots of numbers that far apart are no farther apart than its own root
        let e = if least > 0.0 { self.e / (root + least.sqrt()) } else { self.e.sqrt() };
        self.rounded(root, e, SQRT_UNITS)
    }

    /// `self <= other`; false for NaN.
    pub fn at_most(self, other: Bounded) -> Judged {
        let e = self.e + other.e;
        Judged { yes: self.v <= other.v, sure: e == 0.0 || (self.v - other.v).abs() > e }
    }

    pub fn is_negative(self) -> Judged {
        Judged { yes: self.v < 0.0, sure: self.e == 0.0 || self.v.abs() > self.e }
    }
}

impl Add for Bounded {
    type Output = Bounded;
    fn add(self, o: Bounded) -> Bounded {
        // nothing is rounded where nothing is added
        let units = if self.is_zero() || o.is_zero() { 0.0 } else { 1.0 };
        self.rounded(self.v + o.v, self.e + o.e, units)
    }
}

impl Neg for Bounded {
    type Output = Bounded;
    fn neg(self) -> Bounded {
        Bounded { v: -self.v, ..self }
    }
}

impl Sub for Bounded {
    type Output = Bounded;
    fn sub(self, o: Bounded) -> Bounded {
        self + -o
    }
}

impl Mul for Bounded {
    type Output = Bounded;
    fn mul(self, o: Bounded) -> Bounded {
        if self.is_zero() || o.is_zero() {
            return Bounded { v: 0.0, e: 0.0, unit: self.unit };
        }
        let e = self.v.abs() * o.e + o.v.abs() * self.e + self.e * o.e;
        self.rounded(self.v * o.v, e + TINY, 1.0)
    }
}

impl Div for Bounded {
    type Output = Bounded;
    /// Division by 0 certainly gives NaN or infinity.
    fn div(self, o: Bounded) -> Bounded {
        let q = self.v / o.v;
        if o.is_zero() {
            return Bounded { v: q, e: 0.0, unit: self.unit };
        }
        let least = o.v.abs() - o.e;
        let e = if least > 0.0 { (self.e + q.abs() * o.e) / least } else { f64::INFINITY };
        self.rounded(q, e + TINY, DIV_UNITS)
    }
}

/// A vector of such numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounded3(pub [Bounded; 3]);

impl Bounded3 {
    pub fn pair(hi: [f32; 3], lo: [f32; 3], real: Real) -> Bounded3 {
        Bounded3([0, 1, 2].map(|k| Bounded::pair(hi[k], lo[k], real)))
    }

    pub fn value(self) -> DVec3 {
        DVec3::from(self.0.map(|c| c.v))
    }

    /// Sum of the absolute components.
    pub fn size(self) -> f64 {
        self.0.iter().map(|c| c.v.abs()).sum()
    }

    /// The largest error of a component.
    pub fn error(self) -> f64 {
        self.0.iter().fold(0.0, |most, c| most.max(c.e))
    }

    pub fn lost(self) -> Bounded3 {
        Bounded3(self.0.map(Bounded::lost))
    }

    pub fn dot(self, o: Bounded3) -> Bounded {
        let [x, y, z] = [0, 1, 2].map(|k| self.0[k] * o.0[k]);
        x + y + z
    }

    pub fn cross(self, o: Bounded3) -> Bounded3 {
        let part = |a: usize, b: usize| self.0[a] * o.0[b] - self.0[b] * o.0[a];
        Bounded3([part(1, 2), part(2, 0), part(0, 1)])
    }

    pub fn norm(self) -> Bounded {
        self.dot(self).sqrt()
    }

    pub fn unit(self) -> Bounded3 {
        self / self.norm()
    }

    /// The sum of three vectors by weights whose own sum is 1 but for their rounding: only as far as the vectors differ do
    /// the weights' errors count.
    pub fn mixed(w: [Bounded; 3], of: [Bounded3; 3]) -> Bounded3 {
        Bounded3([0, 1, 2].map(|k| {
            let c = of.map(|v| v.0[k]);
            let unit = w[0].unit;
            let v = w[0].v * c[0].v + w[1].v * c[1].v + w[2].v * c[2].v;
            let spread_error = |j: usize| w[j].e * (c[j].v - c[0].v).abs() + (w[j].v.abs() + w[j].e) * c[j].e;
            // each weight's own quotient and their sum's; a product and two sums
            let sizes: f64 = (0..3).map(|j| w[j].v.abs() * c[j].v.abs()).sum();
            let e =
                spread_error(0) + spread_error(1) + spread_error(2) + unit * (DIV_UNITS + 6.0) * (sizes + c[0].v.abs());
            Bounded { v, e: if e.is_nan() { f64::INFINITY } else { e + TINY }, unit }
        }))
    }
}

impl Add for Bounded3 {
    type Output = Bounded3;
    fn add(self, o: Bounded3) -> Bounded3 {
        Bounded3([0, 1, 2].map(|k| self.0[k] + o.0[k]))
    }
}

impl Neg for Bounded3 {
    type Output = Bounded3;
    fn neg(self) -> Bounded3 {
        Bounded3(self.0.map(Bounded::neg))
    }
}

impl Sub for Bounded3 {
    type Output = Bounded3;
    fn sub(self, o: Bounded3) -> Bounded3 {
        self + -o
    }
}

impl Mul<Bounded> for Bounded3 {
    type Output = Bounded3;
    fn mul(self, s: Bounded) -> Bounded3 {
        Bounded3(self.0.map(|c| c * s))
    }
}

impl Div<Bounded> for Bounded3 {
    type Output = Bounded3;
    fn div(self, s: Bounded) -> Bounded3 {
        Bounded3(self.0.map(|c| c / s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A formula with cancellation, a quotient and a root, in f32 and with its bound.
    fn both(a: f32, b: f32, c: f32) -> (f64, Bounded) {
        let single = ((a * b - c) / (a + c)).max(0.0).sqrt() + b;
        let n = |v: f32| Bounded::exact(f64::from(v), Real::F32);
        (f64::from(single), ((n(a) * n(b) - n(c)) / (n(a) + n(c))).sqrt() + n(b))
    }

    #[test]
    fn f32_lies_within_the_bound_and_the_bound_near_it() {
        let mut most = 0.0_f64;
        for k in 1..2000u32 {
            let number = |m: u32| (k.wrapping_mul(m) >> 8) as f32 / 16_777_216.0 + 1e-3;
            let (a, b) = (number(0x9e37_79b1), number(0x85eb_ca77));
            let (single, bounded) = both(a, b, a * b * (1.0 - 1e-4 * number(0xc2b2_ae3d)));
            let off = (single - bounded.v).abs();
            assert!(off <= bounded.e, "{k}: {single} for {bounded:?}");
            most = most.max(off / bounded.e);
        }
        assert!(most > 0.02, "a bound that nothing comes bounded: {most}");
    }

    #[test]
    fn a_sign_within_rounding_is_not_sure() {
        let n = |v: f64| Bounded::exact(v, Real::F32);
        assert!(n(1.0).at_most(n(1.0)) == Judged { yes: true, sure: true });
        let third = n(1.0) / n(3.0);
        assert!(!(third * n(3.0)).at_most(n(1.0)).sure);
        assert!((third * n(3.0)).at_most(n(1.001)).sure);
        assert!((n(0.0) / n(0.0)).at_most(n(1.0)).surely_not());
        assert!(!(third - third).is_negative().sure);
    }
}
