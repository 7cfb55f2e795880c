//! The least positive root of a polynomial, found with certainty; the root of a function in a bracket.

/// The value at `x` of the polynomial with these coefficients, constant first.
pub fn value(c: &[f64], x: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// The coefficients of the derivative.
pub fn derivative(c: &[f64]) -> Vec<f64> {
    c.iter().enumerate().skip(1).map(|(k, c)| k as f64 * c).collect()
}

pub fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut c = vec![0.0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            c[i + j] += x * y;
        }
    }
    c
}

/// Bounds of the polynomial for x in [lo, hi], 0 <= lo, up to rounding: Horner's scheme in intervals.
pub fn bounds(c: impl DoubleEndedIterator<Item = f64>, (lo, hi): (f64, f64)) -> (f64, f64) {
    c.rev().fold((0.0, 0.0), |(least, most), c| {
        let least = least * if least >= 0.0 { lo } else { hi };
        let most = most * if most >= 0.0 { hi } else { lo };
        (least + c, most + c)
    })
}

/// A bracket this narrow, relative to its upper end, is a root: four epsilons. The smallest step is half of that.
const BRACKET: f64 = 4.0 * f64::EPSILON;

/// The only root of `f(x) = (value, derivative)` in [0, hi], f(0) <= 0 <= f(hi), from a guess.
///
/// Newton's method, with bisection where a Newton step is not half the one before. The iteration ends by the width of the bracket, never
/// by the size of a step.
pub fn in_bracket(guess: f64, mut hi: f64, f: impl Fn(f64) -> (f64, f64)) -> f64 {
    let (mut lo, mut x, mut last) = (0.0, guess.clamp(0.0, hi), hi);
    let mut best = (f64::INFINITY, x);
    loop {
        let (value, slope) = f(x);
        if value.abs() < best.0 {
            best = (value.abs(), x);
        }
        if value > 0.0 {
            hi = x
        } else {
            lo = x
        }
        if value == 0.0 || hi - lo <= BRACKET * hi {
            return best.1;
        }
        // long enough to cross the root despite rounding
        let step = value / slope;
        let step = step.signum() * step.abs().max(0.5 * BRACKET * x);
        let newton = x - step;
        let next = if lo < newton && newton < hi && step.abs() <= 0.5 * last { newton } else { lo + (hi - lo) / 2.0 };
        if next <= lo || next >= hi {
            return best.1;
        }
        last = (next - x).abs();
        x = next;
    }
}

/// The least place over 0 where the polynomial changes its sign; infinite where there is none.
pub fn first(c: &[f64]) -> f64 {
    sign_changes(c).first().copied().unwrap_or(f64::INFINITY)
}

/// All places over 0 where the sign changes, ascending: between two neighbouring extrema there is one at most.
pub fn sign_changes(c: &[f64]) -> Vec<f64> {
    let degree = c.iter().rposition(|c| *c != 0.0).unwrap_or(0);
    if degree == 0 {
        return Vec::new();
    }
    let c = &c[..=degree];
    // Cauchy: no root lies beyond
    let far = 1.0 + c[..degree].iter().fold(0.0, |m: f64, x| m.max((x / c[degree]).abs()));
    let ends = [0.0].into_iter().chain(sign_changes(&derivative(c))).chain([far.min(f64::MAX)]);
    let ends: Vec<f64> = ends.collect();
    ends.windows(2).filter_map(|w| bisect(c, w[0], w[1])).collect()
}

/// The place in (lo, hi] where the sign becomes that of `hi`, to the last bit.
fn bisect(c: &[f64], mut lo: f64, mut hi: f64) -> Option<f64> {
    let last = value(c, hi) > 0.0;
    if (value(c, lo) > 0.0) == last {
        return None;
    }
    loop {
        let middle = lo + (hi - lo) / 2.0;
        if middle <= lo || middle >= hi {
            return Some(hi);
        }
        if (value(c, middle) > 0.0) == last { hi = middle } else { lo = middle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_root_in_a_bracket_is_found_from_any_guess() {
        let cubic = |x: f64| (x * x * x - 2.0, 3.0 * x * x);
        for guess in [0.0, 1e-300, 1.0, 1.26, 5.0, 1e6] {
            let root = in_bracket(guess, 1e6, cubic);
            assert!((root - 2f64.cbrt()).abs() <= 4.0 * f64::EPSILON, "{guess}: {root}");
        }
        // a zero slope at the end of the bracket, and everywhere
        let barrel = |x: f64| (x - x * x * x / 3.0 - 2.0 / 3.0, 1.0 - x * x);
        assert!((in_bracket(0.5, 1.0, barrel) - 1.0).abs() < 1e-7);
        assert!((in_bracket(0.5, 8.0, |x| (x - 3.0, 0.0)) - 3.0).abs() <= 4.0 * f64::EPSILON);
        assert_eq!(in_bracket(0.0, 2.0, |x| (x, 1.0)), 0.0);
    }

    #[test]
    fn bounds_hold_all_values_and_are_tight_at_a_point() {
        let c = [1.0, -3.0, 0.5, 0.25];
        for k in 0..40 {
            let (lo, hi) = (0.1 * f64::from(k), 0.1 * f64::from(k + 1));
            let (least, most) = bounds(c.into_iter(), (lo, hi));
            for s in 0..=10 {
                let v = value(&c, lo + 0.1 * (hi - lo) * f64::from(s));
                assert!(least - 1e-12 <= v && v <= most + 1e-12, "{lo}: {least} {v} {most}");
            }
        }
        let (least, most) = bounds(c.into_iter(), (2.0, 2.0));
        assert_eq!((least, most), (value(&c, 2.0), value(&c, 2.0)));
    }

    #[test]
    fn the_first_root_is_found_however_close_the_next() {
        let with_roots = |r: &[f64]| r.iter().fold(vec![1.0], |p, r| product(&p, &[-r, 1.0]));
        for roots in [&[0.5, 0.5001, 3.0][..], &[-1.0, 2.0], &[1e-3, 1e3, 2e3, 4e3], &[7.0]] {
            let expected = roots.iter().copied().find(|r| *r > 0.0).unwrap();
            let found = first(&with_roots(roots));
            // the coefficients round, which moves a root by 2^-53 over its distance to the next
            assert!((found - expected).abs() <= 1e-10 * expected, "{found}, not {expected}");
        }
        assert_eq!(first(&[1.0, 0.0, 1.0]), f64::INFINITY);
        assert_eq!(first(&[1.0, 2.0, 0.0]), f64::INFINITY);
        assert_eq!(first(&[3.0, 0.0]), f64::INFINITY);
        assert_eq!(first(&[1.0, -0.25]), 4.0);
    }
}
