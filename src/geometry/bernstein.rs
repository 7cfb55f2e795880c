//! Polynomials of degree up to 6 over [0, 1] in Bernstein form, and all their roots there.
//!
//! The interval is split where the slope is 0; between the splits the polynomial is monotone, so it has a root exactly where
//! its ends differ in sign. Nothing is sampled and nothing can be stepped over: a root is lost, or two taken for one,
//! only where the polynomial is 0 within the bound of its own rounding.

use crate::arrays::MapEach;

/// `sum of Bernstein(i, degree)(t) * c[i]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bernstein {
    c: [f64; DEGREE_MAX + 1],
    degree: usize,
}

/// The largest degree.
const DEGREE_MAX: usize = 6;

/// Where a polynomial is 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Root {
    pub t: f64,
    /// 1: it rises through 0; -1: it falls; 0: it touches 0 without passing.
    pub sign: i8,
}

/// Bound of the error of [`Bernstein::at`], against the largest coefficient: three levels of `a + t (b - a)`, each with
/// three roundings of half an epsilon of numbers up to twice as large; of degree 4 a third more, and of degree 6 twice as much.
pub const VALUE_ROUNDING: f64 = 9.0 * f64::EPSILON;

/// Steps of the root finder at most: each second one halves the bracket, and [0, 1] has no more halves than f64 has
/// exponents and bits.
const STEPS: usize = 2 * (1074 + 53);

impl Bernstein {
    /// From 2 to 7 coefficients.
    pub fn new(c: &[f64]) -> Bernstein {
        let mut all = [0.0; DEGREE_MAX + 1];
        all[..c.len()].copy_from_slice(c);
        Bernstein { c: all, degree: c.len() - 1 }
    }

    /// From the coefficients of the powers of a number from `from` to `to`, 2 to 7 of them.
    pub fn of_powers(powers: &[f64], [from, to]: [f64; 2]) -> Bernstein {
        let mut c = powers.to_vec();
        let n = c.len();
        // about `from`: Horner's scheme, again and again
        for k in 0..n {
            (k..n - 1).rev().for_each(|j| c[j] += from * c[j + 1]);
        }
        // what the power k adds to k-th differences: its coefficient on [0, 1] over the binomial of the degree and k
        let (mut scale, mut choose) = (1.0, 1.0);
        for (k, difference) in c.iter_mut().enumerate() {
            *difference *= scale / choose;
            scale *= to - from;
            choose *= (n - 1 - k) as f64 / (k + 1) as f64;
        }
        for k in 1..n {
            (k..n).rev().for_each(|j| c[j] += c[j - 1]);
        }
        Bernstein::new(&c)
    }

    fn coefficients(&self) -> &[f64] {
        &self.c[..=self.degree]
    }

    /// The largest magnitude of a coefficient: the polynomial is nowhere larger.
    pub fn size(&self) -> f64 {
        self.coefficients().iter().fold(0.0, |m, c| c.abs().max(m))
    }

    /// All coefficients are farther than `zero` on one side of 0, so the polynomial is too.
    pub fn keeps_off(&self, zero: f64) -> bool {
        let c = self.coefficients();
        c.iter().all(|c| *c > zero) || c.iter().all(|c| *c < -zero)
    }

    /// The value, by de Casteljau's construction; exact at 0 and 1.
    pub fn at(&self, t: f64) -> f64 {
        let mut c = self.c;
        for n in (1..=self.degree).rev() {
            for k in 0..n {
                c[k] = (1.0 - t) * c[k] + t * c[k + 1];
            }
        }
        c[0]
    }

    pub fn derivative(&self) -> Bernstein {
        let mut c = [0.0; DEGREE_MAX + 1];
        for (k, slope) in c.iter_mut().enumerate().take(self.degree) {
            *slope = self.degree as f64 * (self.c[k + 1] - self.c[k]);
        }
        Bernstein { c, degree: self.degree.saturating_sub(1) }
    }

    /// The roots in [0, 1], ascending, where values up to `zero` count as 0. None where it is 0 all over.
    pub fn roots(&self, zero: f64) -> Vec<Root> {
        if self.keeps_off(zero) || self.size() <= zero {
            return Vec::new();
        }
        let points = self.split_points();
        let value: Vec<f64> = points.iter().map(|&t| self.at(t)).collect();
        let side: Vec<i8> = value.iter().map(|v| if v.abs() <= zero { 0 } else { v.signum() as i8 }).collect();
        let mut roots = Vec::new();
        let mut before = 0;
        for k in 0..points.len() {
            if side[k] == 0 {
                // of neighbouring points at 0 the first stands for all
                if k == 0 || side[k - 1] != 0 {
                    let after = side[k..].iter().copied().find(|s| *s != 0).unwrap_or(0);
                    // a side that is beyond the interval is taken for the other one
                    let (from, to) =
                        (if before == 0 { -after } else { before }, if after == 0 { -before } else { after });
                    roots.push(Root { t: points[k], sign: if from == to { 0 } else { to } });
                }
                continue;
            }
            if k > 0 && side[k - 1] == -side[k] {
                roots.push(Root { t: self.root_between(points[k - 1], points[k], f64::from(side[k])), sign: side[k] });
            }
            before = side[k];
        }
        roots
    }

    /// 0, 1 and between them the places where the slope is 0, ascending.
    fn split_points(&self) -> Vec<f64> {
        let mut points = vec![0.0];
        let slope = self.derivative();
        let extrema = match slope.degree {
            3.. => slope.roots(0.0).iter().map(|r| r.t).collect(),
            _ => slope.roots_to_degree_2().into_iter().flatten().collect::<Vec<_>>(),
        };
        points.extend(extrema.into_iter().filter(|t| 0.0 < *t && *t < 1.0));
        points.push(1.0);
        points.sort_unstable_by(f64::total_cmp);
        points.dedup();
        points
    }

    /// The real roots of a polynomial of degree 2 at most, anywhere; without the cancellation of the school formula.
    fn roots_to_degree_2(&self) -> [Option<f64>; 2] {
        let [c0, c1, c2, ..] = self.c;
        match self.degree {
            2 => {
                // c0 + 2 h t + a t^2
                let (h, a) = (c1 - c0, c0 - 2.0 * c1 + c2);
                let q = -(h + h.signum() * (h * h - a * c0).max(0.0).sqrt());
                [Some(q / a), Some(c0 / q)].map_each(|t| t.filter(|t| t.is_finite()))
            }
            1 => [Some(c0 / (c0 - c1)).filter(|t| t.is_finite()), None],
            _ => [None, None],
        }
    }

    /// The root between `a` and `b`, where the value has the sign `rising` at `b` and the other at `a`: Newton's steps,
    /// halving where one would leave the bracket or shrinks too slowly.
    fn root_between(&self, mut a: f64, mut b: f64, rising: f64) -> f64 {
        let slope = self.derivative();
        let mut t = 0.5 * (a + b);
        let (mut step, mut last) = (b - a, b - a);
        for _ in 0..STEPS {
            let value = rising * self.at(t);
            if value == 0.0 {
                break;
            }
            if value < 0.0 {
                a = t;
            } else {
                b = t;
            }
            let newton = t - value / (rising * slope.at(t));
            let fast = newton > a && newton < b && (newton - t).abs() < 0.5 * last;
            let next = if fast { newton } else { 0.5 * (a + b) };
            (last, step) = (step, (next - t).abs());
            if next == t || next <= a || next >= b {
                break;
            }
            t = next;
        }
        t
    }
}

#[cfg(test)]
mod exact;
#[cfg(test)]
mod tests;
