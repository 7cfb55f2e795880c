//! Exact t of hits, and their order.

use crate::geometry::exact::Exact;
use std::cmp::Ordering;

/// `(above + side root) / below`, `root` being the root of a number that is not negative, `side` -1 or 1; `below` is not 0. Of all depths
/// with a root on one ray `below` is the same number above 0.
#[derive(Debug, Clone)]
pub struct Depth {
    pub above: Exact,
    pub root: Option<(i8, Exact)>,
    pub below: Exact,
}

impl Depth {
    /// Of a number.
    pub fn of(t: f64) -> Depth {
        Depth::fraction([Exact::product(t, 1.0), Exact::product(1.0, 1.0)])
    }

    pub fn fraction([above, below]: [Exact; 2]) -> Depth {
        Depth { above, root: None, below }
    }

    /// The order of two on one ray.
    pub fn compare(&self, other: &Depth) -> Ordering {
        let across = || self.above.by(&other.below).minus(&other.above.by(&self.below));
        let sign = match (&self.root, &other.root) {
            (None, None) => across().sign() * self.below.sign() * other.below.sign(),
            (Some((side, square)), None) => {
                with_root(&across(), &other.below.times(f64::from(*side)), square) * other.below.sign()
            }
            (None, Some(_)) => return other.compare(self).reverse(),
            (Some(one), Some(two)) => with_roots(&self.above.clone().minus(&other.above), one, two),
        };
        sign.cmp(&0)
    }
}

/// The sign of `p + q root`.
fn with_root(p: &Exact, q: &Exact, square: &Exact) -> i8 {
    let signs = [p.sign(), q.sign() * square.sign()];
    if signs[0] * signs[1] >= 0 {
        return (signs[0] + signs[1]).signum();
    }
    p.by(p).minus(&q.by(q).by(square)).sign() * signs[0]
}

/// The sign of `p` with the first root added and the second one taken away.
fn with_roots(p: &Exact, (one, first): &(i8, Exact), (two, second): &(i8, Exact)) -> i8 {
    let larger = first.clone().minus(second).sign();
    let roots = match one * two {
        // both act one way
        -1 => one * first.sign().max(second.sign()),
        _ => one * larger,
    };
    let sign = p.sign();
    if sign * roots >= 0 {
        return (sign + roots).signum();
    }
    // p^2 against the square of the roots' difference
    let p = p.by(p).minus(first).minus(second);
    let q = Exact::product(2.0 * f64::from(one * two), 1.0);
    with_root(&p, &q, &first.by(second)) * sign
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Rng;

    fn exact(x: f64) -> Exact {
        Exact::product(x, 1.0)
    }

    /// Small whole numbers, whose order f64 tells unless they are equal, which squares decide in whole numbers.
    #[test]
    fn depths_with_and_without_roots_are_ordered() {
        let mut rng = Rng(1);
        let mut below = |n: usize| rng.below(n) as i64;
        let mut equal = [0; 3];
        for _ in 0..20_000 {
            let whole = (1 + below(4)) as f64;
            let mut rooted = || {
                let side = if below(2) == 0 { -1 } else { 1 };
                let (above, square) = ((below(9) - 4) as f64, below(17) as f64);
                let depth = Depth { above: exact(above), root: Some((side, exact(square))), below: exact(whole) };
                (depth, (above + f64::from(side) * square.sqrt()) / whole)
            };
            let pair = [rooted(), rooted()];
            let denominator = [-3, -2, -1, 1, 2, 3][below(6) as usize] as f64;
            let numerator = (below(13) - 6) as f64;
            let plain = (Depth::fraction([exact(numerator), exact(denominator)]), numerator / denominator);
            for (k, (one, two)) in [(&pair[0], &pair[1]), (&pair[0], &plain), (&plain, &plain)].into_iter().enumerate()
            {
                // numbers of so few digits are equal, or differ by more than this
                let truth = if (one.1 - two.1).abs() < 1e-12 { Ordering::Equal } else { one.1.total_cmp(&two.1) };
                assert_eq!(one.0.compare(&two.0), truth, "{one:?} {two:?}");
                assert_eq!(two.0.compare(&one.0), truth.reverse(), "{one:?} {two:?}");
                equal[k] += usize::from(truth.is_eq());
            }
        }
        assert!(equal.iter().all(|n| *n > 100), "{equal:?}");
    }

    #[test]
    fn roots_that_differ_by_less_than_f64_are_told_apart() {
        // 2^26 + 1 against the root of its square and a little
        let x = 67_108_865.0;
        for (rest, truth) in [(1e-20, Ordering::Less), (0.0, Ordering::Equal), (-1e-20, Ordering::Greater)] {
            let square = exact(x * x).plus(&exact(rest));
            let root = Depth { above: exact(0.0), root: Some((1, square)), below: exact(1.0) };
            assert_eq!(Depth::of(x).compare(&root), truth);
        }
    }
}
