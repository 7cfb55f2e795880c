//! Polynomials in exact arithmetic, and polynomials that are hard for any other.

// every test binary uses a part of it
#![allow(dead_code)]

use num_bigint::{BigInt, Sign};

/// `m 2^e`, exactly.
#[derive(Debug, Clone)]
pub struct Dyadic {
    m: BigInt,
    e: i32,
}

impl Dyadic {
    pub fn of(x: f64) -> Dyadic {
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

    pub fn plus(&self, other: &Dyadic) -> Dyadic {
        let e = self.e.min(other.e);
        Dyadic { m: self.at(e) + other.at(e), e }
    }

    pub fn times(&self, other: &Dyadic) -> Dyadic {
        Dyadic { m: &self.m * &other.m, e: self.e + other.e }
    }

    pub fn sign(&self) -> i8 {
        match self.m.sign() {
            Sign::Minus => -1,
            Sign::NoSign => 0,
            Sign::Plus => 1,
        }
    }
}

/// Coefficients of powers, times some power of 2.
#[derive(Debug, Clone)]
pub struct Powers(Vec<BigInt>);

impl Powers {
    /// The polynomial of these Bernstein coefficients and `more` at every place.
    pub fn new(c: &[f64], more: f64) -> Powers {
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

    pub fn sign_at(&self, t: &Dyadic) -> i8 {
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
            let signed_top = if lead.sign() == Sign::Minus { -&top } else { top };
            rest.iter_mut().for_each(|c| *c *= BigInt::from_biguint(Sign::Plus, lead.magnitude().clone()));
            other.0.iter().enumerate().for_each(|(k, c)| rest[k + shift] -= c * &signed_top);
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
    pub fn is_above_between(&self, a: &Dyadic, b: &Dyadic) -> bool {
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
pub fn beyond(c: &[f64], zero: f64, a: f64, b: f64) -> [bool; 2] {
    let [a, b] = [a, b].map(Dyadic::of);
    [Powers::new(c, -zero), Powers::new(c, zero).negative()].map(|p| p.is_above_between(&a, &b))
}

/// SplitMix64.
pub struct Rng(pub u64);

impl Rng {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn below(&mut self, count: u64) -> u64 {
        self.next() % count
    }
}

/// Bernstein coefficients of the product of linear factors with these coefficients at 0 and 1.
pub fn product(factors: &[[f64; 2]]) -> Vec<f64> {
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
pub fn polynomial(rng: &mut Rng) -> Vec<f64> {
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
pub fn count() -> u64 {
    std::env::var("ANAMORPH_POLYNOMIALS").ok().and_then(|n| n.parse().ok()).unwrap_or(60_000)
}
