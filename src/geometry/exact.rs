//! Sums and products of f64 without rounding, for the few signs that f64 bounds do not prove.
//!
//! Expansions after Shewchuk, "Adaptive Precision Floating-Point Arithmetic" (1997). Exact as long as no
//! product leaves the range from 2^-969 to 2^1023: lengths from 1e-60 to 1e60 scene units are far inside.

use glam::DVec3;

/// A number as a sum of non-overlapping f64, smallest first, without zeros; the empty sum is 0.
#[derive(Debug, Clone, Default)]
pub struct Exact(Vec<f64>);

/// A vector of exact numbers.
pub type Exact3 = [Exact; 3];

/// `a + b` as its rounded value and the exact rest.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let b_part = s - a;
    (s, (a - (s - b_part)) + (b - b_part))
}

impl Exact {
    /// `a * b`.
    pub fn product(a: f64, b: f64) -> Exact {
        let mut x = Exact::default();
        x.add_product(a, b);
        x
    }

    fn add_product(&mut self, a: f64, b: f64) {
        let high = a * b;
        self.grow(a.mul_add(b, -high));
        self.grow(high);
    }

    fn grow(&mut self, b: f64) {
        let mut carry = b;
        let mut kept = 0;
        for i in 0..self.0.len() {
            let (sum, rest) = two_sum(carry, self.0[i]);
            if rest != 0.0 {
                self.0[kept] = rest;
                kept += 1;
            }
            carry = sum;
        }
        self.0.truncate(kept);
        if carry != 0.0 {
            self.0.push(carry);
        }
    }

    pub fn plus(mut self, other: &Exact) -> Exact {
        other.0.iter().for_each(|&c| self.grow(c));
        self
    }

    pub fn minus(mut self, other: &Exact) -> Exact {
        other.0.iter().for_each(|&c| self.grow(-c));
        self
    }

    /// `self * b`.
    pub fn times(&self, b: f64) -> Exact {
        let mut x = Exact::default();
        if b != 0.0 {
            self.0.iter().for_each(|&c| x.add_product(c, b));
        }
        x
    }

    /// `self * other`.
    pub fn by(&self, other: &Exact) -> Exact {
        other.0.iter().fold(Exact::default(), |sum, &c| sum.plus(&self.times(c)))
    }

    /// -1, 0 or 1: the largest term outweighs all others.
    pub fn sign(&self) -> i8 {
        self.0.last().map_or(0, |&c| if c > 0.0 { 1 } else { -1 })
    }

    /// The nearest f64 but for a few units in the last place; 0 only for 0.
    pub fn value(&self) -> f64 {
        self.0.iter().sum()
    }
}

/// `a x b`.
pub fn cross(a: DVec3, b: DVec3) -> Exact3 {
    let minor = |p: f64, q: f64, r: f64, s: f64| Exact::product(p, q).minus(&Exact::product(r, s));
    [minor(a.y, b.z, a.z, b.y), minor(a.z, b.x, a.x, b.z), minor(a.x, b.y, a.y, b.x)]
}

/// `a . b`.
pub fn dot(a: &Exact3, b: DVec3) -> Exact {
    a[0].times(b.x).plus(&a[1].times(b.y)).plus(&a[2].times(b.z))
}

/// `a . a`.
pub fn squared(a: &Exact3) -> Exact {
    a.iter().fold(Exact::default(), |sum, x| sum.plus(&x.by(x)))
}

/// `a + b` by components.
pub fn sum(a: Exact3, b: &Exact3) -> Exact3 {
    let [x, y, z] = a;
    [x.plus(&b[0]), y.plus(&b[1]), z.plus(&b[2])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Rng;

    #[test]
    fn cancellation_leaves_the_exact_rest() {
        // (1 + 2^-52)^2 - (1 + 2^-51) = 2^-104.
        let a = 1.0 + f64::EPSILON;
        let square = Exact::product(a, a).minus(&Exact::product(1.0 + 2.0 * f64::EPSILON, 1.0));
        assert_eq!(square.sign(), 1);
        assert_eq!(square.value(), f64::EPSILON * f64::EPSILON);
        assert_eq!(square.clone().minus(&square).sign(), 0);
    }

    #[test]
    fn integer_determinants_agree_with_integer_arithmetic() {
        let mut rng = Rng(7);
        let mut next = || rng.below(1 << 31) as i128 - (1 << 30);
        for _ in 0..2000 {
            let m: [[i128; 3]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| next()));
            let det = m[2][0] * (m[0][1] * m[1][2] - m[0][2] * m[1][1])
                + m[2][1] * (m[0][2] * m[1][0] - m[0][0] * m[1][2])
                + m[2][2] * (m[0][0] * m[1][1] - m[0][1] * m[1][0]);
            let v = |r: [i128; 3]| DVec3::new(r[0] as f64, r[1] as f64, r[2] as f64);
            let exact = dot(&cross(v(m[0]), v(m[1])), v(m[2]));
            let back: i128 = exact.0.iter().map(|&c| c as i128).sum();
            assert_eq!(back, det);
            assert_eq!(i128::from(exact.sign()), det.signum());
        }
    }
}
