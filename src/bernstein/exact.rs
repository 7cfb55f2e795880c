//! The roots against exact arithmetic: of millions of polynomials, ordinary and made to be hard, none is missed and none is false
//! beyond what their own rounding hides.

use super::{Bernstein, Root, VALUE_ROUNDING};
use num_bigint::{BigInt, Sign};
use rayon::prelude::*;
use std::cmp::Ordering;

/// `m 2^e`, exactly.
#[derive(Debug, Clone)]
struct Dyadic {
    m: BigInt,
    e: i32,
}

impl Dyadic {
    fn of(x: f64) -> Dyadic {
        let bits = x.to_bits();
        let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
        let m = if exponent == 0 { fraction } else { fraction | 1 << 52 };
        if x == 0.0 {
            return Dyadic { m: BigInt::ZERO, e: 0 };
        }
        let sign = if x < 0.0 { Sign::Minus } else { Sign::Plus };
        Dyadic { m: BigInt::from_biguint(sign, m.into()), e: exponent.max(1) - 1075 }
    }

    fn at(&self, e: i32) -> BigInt {
        &self.m << (self.e - e) as usize
    }

    fn plus(&self, other: &Dyadic) -> Dyadic {
        let e = self.e.min(other.e);
        Dyadic { m: self.at(e) + other.at(e), e }
    }

    fn times(&self, other: &Dyadic) -> Dyadic {
        Dyadic { m: &self.m * &other.m, e: self.e + other.e }
    }

    fn sign(&self) -> i8 {
        match self.m.sign() {
            Sign::Minus => -1,
            Sign::NoSign => 0,
            Sign::Plus => 1,
        }
    }
}

/// Coefficients of powers, times some power of 2.
#[derive(Debug, Clone)]
struct Powers(Vec<BigInt>);

impl Powers {
    /// The polynomial of these Bernstein coefficients and `more` at every place.
    fn new(c: &[f64], more: f64) -> Powers {
        let c: Vec<Dyadic> = c.iter().map(|c| Dyadic::of(*c).plus(&Dyadic::of(more))).collect();
        let least = c.iter().map(|c| c.e).min().unwrap_or(0);
        let mut differences: Vec<BigInt> = c.iter().map(|c| c.at(least)).collect();
        let n = differences.len();
        for k in 1..n {
            (k..n).rev().for_each(|j| differences[j] = &differences[j] - &differences[j - 1]);
        }
        let mut choose = 1u32;
        for (k, difference) in differences.iter_mut().enumerate() {
            *difference *= choose;
            choose = choose * (n - 1 - k) as u32 / (k + 1) as u32;
        }
        Powers(differences).trimmed()
    }

    fn trimmed(mut self) -> Powers {
        while self.0.last().is_some_and(|c| c.sign() == Sign::NoSign) {
            self.0.pop();
        }
        self
    }

    fn sign_at(&self, t: &Dyadic) -> i8 {
        let zero = Dyadic { m: BigInt::ZERO, e: 0 };
        let whole = |c: &BigInt| Dyadic { m: c.clone(), e: 0 };
        self.0.iter().rev().fold(zero, |sum, c| sum.times(t).plus(&whole(c))).sign()
    }

    fn derivative(&self) -> Powers {
        Powers(self.0.iter().enumerate().skip(1).map(|(k, c)| c * k).collect())
    }

    /// Minus the remainder by `other`, times a positive number.
    fn minus_remainder(&self, other: &Powers) -> Powers {
        let mut rest = self.0.clone();
        let (lead, n) = (&other.0[other.0.len() - 1], other.0.len());
        while rest.len() >= n {
            let (top, shift) = (rest[rest.len() - 1].clone(), rest.len() - n);
            // times the magnitude of the leading coefficient, which is positive
            let turn = if lead.sign() == Sign::Minus { -&top } else { top };
            rest.iter_mut().for_each(|c| *c *= BigInt::from_biguint(Sign::Plus, lead.magnitude().clone()));
            other.0.iter().enumerate().for_each(|(k, c)| rest[k + shift] -= c * &turn);
            rest.pop();
            rest = Powers(rest).trimmed().0;
        }
        Powers(rest.into_iter().map(|c| -c).collect())
    }

    /// How many different roots there are in (a, b], neither of which is one (Sturm).
    fn roots_between(&self, a: &Dyadic, b: &Dyadic) -> usize {
        let mut chain = vec![self.clone(), self.derivative()];
        while chain[chain.len() - 1].0.len() > 1 {
            let next = chain[chain.len() - 2].minus_remainder(&chain[chain.len() - 1]);
            if next.0.is_empty() {
                break;
            }
            chain.push(next);
        }
        let changes = |t: &Dyadic| {
            let signs: Vec<i8> = chain.iter().map(|p| p.sign_at(t)).filter(|s| *s != 0).collect();
            signs.windows(2).filter(|s| s[0] != s[1]).count()
        };
        changes(a).saturating_sub(changes(b))
    }

    /// It is above 0 somewhere between `a` and `b`.
    fn is_above_between(&self, a: &Dyadic, b: &Dyadic) -> bool {
        let signs = [a, b].map(|t| self.sign_at(t));
        match (self.0.is_empty(), signs.contains(&1)) {
            (true, _) => false,
            (_, true) => true,
            _ => !signs.contains(&0) && self.0.len() > 1 && self.roots_between(a, b) > 1,
        }
    }

    fn negative(&self) -> Powers {
        Powers(self.0.iter().map(|c| -c).collect())
    }
}

/// Where the polynomial goes farther than `zero` from 0 between two places: above, below.
fn beyond(c: &[f64], zero: f64, a: f64, b: f64) -> [bool; 2] {
    let [a, b] = [a, b].map(Dyadic::of);
    [Powers::new(c, -zero), Powers::new(c, zero).negative()].map(|p| p.is_above_between(&a, &b))
}

/// What is wrong with the roots that were found, in a line.
fn fault(c: &[f64], zero: f64, roots: &[Root]) -> Option<String> {
    let size = c.iter().fold(0.0f64, |m, c| m.max(c.abs()));
    // what counts as 0, and the rounding of the value that is held against it
    let hidden = zero + VALUE_ROUNDING * size;
    let step = |t: f64| 4.0 * f64::EPSILON * t + f64::MIN_POSITIVE;
    for root in roots {
        let [before, after] = [root.t - step(root.t), root.t + step(root.t)].map(|t| t.clamp(0.0, 1.0));
        let exact = Powers::new(c, 0.0);
        let passes = exact.sign_at(&Dyadic::of(before)) != exact.sign_at(&Dyadic::of(after));
        if !passes && beyond(c, hidden, root.t, root.t).contains(&true) {
            return Some(format!("{} is no root", root.t));
        }
    }
    let places: Vec<f64> = roots.iter().map(|r| r.t).collect();
    let ends: Vec<f64> = [0.0].into_iter().chain(places).chain([1.0]).collect();
    let gaps: Vec<[bool; 2]> = ends
        .windows(2)
        .map(|gap| {
            // next to a root it may be on the other side by the root's own rounding
            let (a, b) = (gap[0] + step(gap[0]), gap[1] - step(gap[1]));
            let [a, b] = [if gap[0] == 0.0 { 0.0 } else { a }, if gap[1] == 1.0 { 1.0 } else { b }];
            if a < b { beyond(c, hidden, a, b) } else { [false, false] }
        })
        .collect();
    if let Some(k) = gaps.iter().position(|gap| *gap == [true, true]) {
        return Some(format!("a root is missed between {} and {}", ends[k], ends[k + 1]));
    }
    for (root, gaps) in roots.iter().zip(gaps.windows(2)) {
        let side = |gap: [bool; 2]| i8::from(gap[0]) - i8::from(gap[1]);
        let (before, after) = (side(gaps[0]), side(gaps[1]));
        let passes = match before.cmp(&after) {
            _ if before == 0 || after == 0 => continue,
            Ordering::Less => 1,
            Ordering::Equal => 0,
            Ordering::Greater => -1,
        };
        if passes != root.sign {
            return Some(format!("{} is passed by {passes} and not by {}", root.t, root.sign));
        }
    }
    None
}

/// SplitMix64.
struct Rng(u64);

impl Rng {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn below(&mut self, count: u64) -> u64 {
        self.next() % count
    }
}

/// Bernstein coefficients of the product of linear factors with these coefficients at 0 and 1.
fn product(factors: &[[f64; 2]]) -> Vec<f64> {
    let mut c = vec![1.0];
    for [a, b] in factors {
        let n = c.len() as f64;
        c = (0..=c.len())
            .map(|k| {
                let low = c.get(k).map_or(0.0, |c| c * a * (n - k as f64) / n);
                low + k.checked_sub(1).map_or(0.0, |j| c[j] * b * k as f64 / n)
            })
            .collect();
    }
    c
}

/// A polynomial of degree 1 to 4, of one of several kinds.
fn polynomial(rng: &mut Rng) -> Vec<f64> {
    let degree = 1 + rng.below(4) as usize;
    let near = |x: f64, rng: &mut Rng| x + rng.signed() * 10f64.powi(-(rng.below(17) as i32));
    match rng.below(6) {
        // any
        0 => (0..=degree).map(|_| rng.signed()).collect(),
        // of very different sizes
        1 => (0..=degree).map(|_| rng.signed() * 2f64.powi(rng.below(120) as i32 - 60)).collect(),
        // small whole numbers: exact double and threefold roots, and 0 at ends
        2 => (0..=degree).map(|_| rng.below(9) as f64 - 4.0).collect(),
        // roots near each other
        3 => {
            let t = 0.5 + 0.6 * rng.signed();
            let factors: Vec<[f64; 2]> = (0..degree).map(|_| near(t, rng)).map(|t| [-t, 1.0 - t]).collect();
            product(&factors)
        }
        // roots near the ends
        4 => {
            let factors: Vec<[f64; 2]> =
                (0..degree).map(|_| near(rng.below(2) as f64, rng)).map(|t| [-t, 1.0 - t]).collect();
            product(&factors)
        }
        // nearly of a lower degree
        _ => {
            let lower: Vec<f64> = (0..degree).map(|_| rng.signed()).collect();
            let n = degree as f64;
            let raised = |k: usize| {
                let below = k.checked_sub(1).map_or(0.0, |j| lower[j]);
                (k as f64 * below + (n - k as f64) * lower.get(k).copied().unwrap_or(0.0)) / n
            };
            (0..=degree).map(|k| near(raised(k), rng)).collect()
        }
    }
}

/// As many as `ANAMORPH_POLYNOMIALS` says.
fn count() -> u64 {
    std::env::var("ANAMORPH_POLYNOMIALS").ok().and_then(|n| n.parse().ok()).unwrap_or(60_000)
}

#[test]
fn no_root_is_missed_and_none_is_false() {
    const EACH: u64 = 1000;
    let found: usize = (0..count().div_ceil(EACH))
        .into_par_iter()
        .map(|seed| {
            let mut rng = Rng(seed);
            let mut found = 0;
            for _ in 0..EACH {
                let c = polynomial(&mut rng);
                let p = Bernstein::new(&c);
                let zero = VALUE_ROUNDING * p.size();
                let roots = p.roots(zero);
                found += roots.len();
                if let Some(fault) = fault(&c, zero, &roots) {
                    panic!("{c:?}: {fault}; found {roots:?}");
                }
            }
            found
        })
        .sum();
    println!("{found} roots of {} polynomials", count());
    assert!(found as u64 > count() / 2);
}

/// The check sees a root that is missing, one too many, one beside its place, and one that is passed the other way.
#[test]
fn the_check_can_fail() {
    let c = product(&[[-0.25, 0.75], [-0.5, 0.5], [-0.75, 0.25]]);
    let zero = VALUE_ROUNDING;
    let right = Bernstein::new(&c).roots(zero);
    assert_eq!((right.len(), fault(&c, zero, &right)), (3, None));
    for k in 0..3 {
        let missing: Vec<Root> = right.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, r)| *r).collect();
        assert!(fault(&c, zero, &missing).is_some_and(|f| f.contains("missed")));
        let mut moved = right.clone();
        moved[k].t += 1e-13;
        assert!(fault(&c, zero, &moved).is_some_and(|f| f.contains("no root")));
        let mut turned = right.clone();
        turned[k].sign = -turned[k].sign;
        assert!(fault(&c, zero, &turned).is_some_and(|f| f.contains("passed")));
    }
    let mut more = right.clone();
    more.insert(1, Root { t: 0.3, sign: 1 });
    assert!(fault(&c, zero, &more).is_some());
}
