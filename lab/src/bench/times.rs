//! Times of frames: medians with intervals that assume no distribution (Hoefler and Belli 2015, section 3.1.3).

use serde::{Deserialize, Serialize};

/// An interval that leaves the median by more than this share of it is wide.
pub const CLOSE: f64 = 0.05;

/// Wall times of frames, ms.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Times {
    pub median: f64,
    /// It holds the median of all frames that could be with 95 % probability; `None` of fewer than 6 frames: there is none.
    #[serde(default)]
    pub interval: Option<[f64; 2]>,
    pub runs: usize,
    /// Of each frame.
    #[serde(default)]
    pub each: Vec<f64>,
}

impl Times {
    pub fn of(each: &[f64]) -> Times {
        let sorted = sorted(each);
        Times { median: median(&sorted), interval: interval(&sorted), runs: each.len(), each: each.to_vec() }
    }

    /// The longest time.
    pub fn slowest(&self) -> f64 {
        self.each.iter().copied().fold(self.median, f64::max)
    }

    /// The interval is within [`CLOSE`] of the median.
    pub fn is_settled(&self) -> bool {
        self.interval.is_some_and(|[lo, hi]| lo >= (1.0 - CLOSE) * self.median && hi <= (1.0 + CLOSE) * self.median)
    }

    /// There is an interval, and it is wide.
    pub fn is_wide(&self) -> bool {
        self.interval.is_some() && !self.is_settled()
    }
}

/// How many times as long as other frames some took: the median over the rounds in which both ran, and its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ratio {
    pub median: f64,
    pub interval: Option<[f64; 2]>,
}

impl Ratio {
    /// `None` if there was no such round. Rounds are in order; a time is `None` where the frame did not run.
    pub fn of(own: &[Option<f64>], others: &[Option<f64>]) -> Option<Ratio> {
        let ratios: Vec<f64> = own.iter().zip(others).filter_map(|(a, b)| Some((*a)? / (*b)?)).collect();
        let sorted = sorted(&ratios);
        (!sorted.is_empty()).then(|| Ratio { median: median(&sorted), interval: interval(&sorted) })
    }
}

fn sorted(numbers: &[f64]) -> Vec<f64> {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// Of an even count the mean of the two in the middle.
pub fn median(sorted: &[f64]) -> f64 {
    let count = sorted.len();
    match count {
        0 => f64::NAN,
        _ => (sorted[(count - 1) / 2] + sorted[count / 2]) / 2.0,
    }
}

/// From the k-th smallest to the k-th largest, with the largest k for which the median of the distribution lies outside with a probability
/// of 5 % at most: fewer than k of n independent numbers are below it with the probability of fewer than k heads in n throws of a coin.
fn interval(sorted: &[f64]) -> Option<[f64; 2]> {
    let count = sorted.len();
    // the probability of exactly `heads` heads
    let mut exactly = 0.5f64.powi(count as i32);
    let (mut fewer, mut k) = (0.0, 0);
    for heads in 0..count / 2 {
        fewer += exactly;
        if 2.0 * fewer > 0.05 {
            break;
        }
        k = heads + 1;
        exactly *= (count - heads) as f64 / (heads + 1) as f64;
    }
    (k > 0).then(|| [sorted[k - 1], sorted[count - k]])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ranks that tables of order statistics give for 95 % at least.
    #[test]
    fn intervals_are_between_the_ranks_of_the_sign_test() {
        for (count, ranks) in [
            (5, None),
            (6, Some([1, 6])),
            (9, Some([2, 8])),
            (15, Some([4, 12])),
            (20, Some([6, 15])),
            (50, Some([18, 33])),
        ] {
            let each: Vec<f64> = (1..=count).rev().map(f64::from).collect();
            let expected = ranks.map(|ranks| ranks.map(f64::from));
            assert_eq!(Times::of(&each).interval, expected, "{count}");
        }
    }

    #[test]
    fn an_interval_holds_the_median_as_often_as_it_says() {
        // a skewed distribution whose median is ln 2
        let mut state = 1u64;
        let mut exponential = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            -(((state >> 11) as f64 + 0.5) / (1u64 << 53) as f64).ln()
        };
        for count in [6, 9, 20] {
            let held = (0..4000)
                .filter(|_| {
                    let each: Vec<f64> = (0..count).map(|_| exponential()).collect();
                    let [lo, hi] = Times::of(&each).interval.unwrap();
                    (lo..=hi).contains(&std::f64::consts::LN_2)
                })
                .count();
            // five deviations of 4,000 trials at 95 %: 0.0172
            assert!(held as f64 / 4000.0 > 0.95 - 0.0172, "{count}: {held}");
        }
    }

    #[test]
    fn medians_and_ratios() {
        assert_eq!(Times::of(&[3.0, 1.0, 2.0]).median, 2.0);
        assert_eq!(Times::of(&[4.0, 1.0, 2.0, 3.0]).median, 2.5);
        assert!(Times::of(&[]).median.is_nan());
        let ratio = Ratio::of(&[Some(2.0), None, Some(9.0), Some(4.0)], &[Some(1.0), Some(5.0), Some(3.0), None]);
        assert_eq!(ratio.map(|r| r.median), Some(2.5));
        assert_eq!(Ratio::of(&[None], &[Some(1.0)]), None);
    }

    #[test]
    fn settled_is_within_five_percent_on_both_sides() {
        let times = |lo: f64, hi: f64| Times::of(&[lo, 1.0, 1.0, 1.0, 1.0, hi]);
        assert!(times(0.96, 1.04).is_settled() && !times(0.96, 1.06).is_settled() && times(0.94, 1.0).is_wide());
        assert!(!Times::of(&[1.0; 5]).is_settled() && !Times::of(&[1.0; 5]).is_wide());
    }
}
