//! Order statistics of errors.

use std::fmt;

use serde::{Serialize, Serializer};

/// Nearest-rank quantiles of a set of errors: `p99` is the smallest error that 99 % do not exceed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quantiles {
    /// Half of the errors are at most this.
    pub median: Measure,
    /// 99 % of them.
    pub p99: Measure,
    /// 99.9 % of them.
    pub p999: Measure,
    /// All of them.
    pub max: Measure,
}

/// An error at or above 0, never NaN. JSON has no infinity: an infinite one is the text "inf" there,
/// so that it is not taken for a value that is missing.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Measure(pub f64);

impl Quantiles {
    /// `None` of no errors.
    pub(super) fn of(mut errors: Vec<f64>) -> Option<Quantiles> {
        errors.sort_unstable_by(f64::total_cmp);
        let last = errors.len().checked_sub(1)?;
        // The rank of `per_mille` thousandths, counted from 1 and rounded up, in whole numbers.
        let at = |per_mille: usize| Measure(errors[((last + 1) * per_mille).div_ceil(1000).max(1) - 1]);
        Some(Quantiles { median: at(500), p99: at(990), p999: at(999), max: Measure(errors[last]) })
    }
}

impl Serialize for Measure {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.0.is_infinite() { serializer.serialize_str("inf") } else { serializer.serialize_f64(self.0) }
    }
}

impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:.1e}", self.0)
    }
}

impl fmt::Display for Quantiles {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "median {} p99 {} p99.9 {} max {}", self.median, self.p99, self.p999, self.max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_the_nearest() {
        let of = |count: usize| Quantiles::of((0..count).rev().map(|i| (i + 1) as f64).collect()).unwrap();
        let values = |q: Quantiles| [q.median.0, q.p99.0, q.p999.0, q.max.0];
        assert_eq!(values(of(1)), [1.0; 4]);
        assert_eq!(values(of(2)), [1.0, 2.0, 2.0, 2.0]);
        assert_eq!(values(of(1000)), [500.0, 990.0, 999.0, 1000.0]);
        assert_eq!(values(of(10_000)), [5000.0, 9900.0, 9990.0, 10_000.0]);
        assert_eq!(Quantiles::of(vec![]), None);
    }

    #[test]
    fn infinity_stays_visible() {
        let q = Quantiles::of(vec![0.0, f64::INFINITY]).unwrap();
        assert!(serde_json::to_string(&q).unwrap().ends_with(r#""max":"inf"}"#));
        assert_eq!(q.to_string(), "median 0.0e0 p99 inf p99.9 inf max inf");
    }
}
