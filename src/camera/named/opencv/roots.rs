//! The least positive root of a polynomial, which no step may jump over.

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

/// The least place over 0 where the polynomial changes its sign; infinite where there is none.
pub fn first(c: &[f64]) -> f64 {
    sign_changes(c).first().copied().unwrap_or(f64::INFINITY)
}

/// All places over 0 where the sign changes, ascending: between two neighbouring extrema there is one at most.
fn sign_changes(c: &[f64]) -> Vec<f64> {
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
