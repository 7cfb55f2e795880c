//! Where the samples of a pixel lie.

use glam::DVec2;

/// Offsets of `count` samples from the pixel's centre, px, right and down, each in (-1/2, 1/2).
///
/// A rank-1 lattice without its origin: the k-th of N samples lies in column k and row (k + 1) g mod (N + 1) - 1 of
/// an N x N grid, in the middle of its cell, g being the number nearest to (N + 1) / golden ratio that is coprime to
/// N + 1. Each column and each row is taken once, so the mean of the offsets is the centre; 4 is the rotated grid.
pub fn sample_offsets(count: u32) -> Vec<DVec2> {
    const GOLDEN: f64 = 1.618_033_988_749_895;
    let (n, modulus) = (f64::from(count), count + 1);
    let ideal = f64::from(modulus) / GOLDEN;
    let distance = |g: &u32| (f64::from(*g) - ideal).abs();
    let coprime = (1..modulus).filter(|&g| greatest_common_divisor(g, modulus) == 1);
    let generator = coprime.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(1);
    let place = |k: u32| {
        let row = (k + 1) * generator % modulus - 1;
        (DVec2::new(f64::from(k), f64::from(row)) + 0.5) / n - 0.5
    };
    (0..count).map(place).collect()
}

fn greatest_common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_centred_and_take_each_row_once() {
        assert_eq!(sample_offsets(1), [DVec2::ZERO]);
        for count in 1..=64 {
            let n = f64::from(count);
            let all = sample_offsets(count);
            let mut rows: Vec<u32> = all.iter().map(|o| ((o.y + 0.5) * n).floor() as u32).collect();
            rows.sort_unstable();
            assert_eq!(rows, (0..count).collect::<Vec<_>>());
            assert!(all.iter().sum::<DVec2>().abs().max_element() < 1e-12);
        }
    }

    #[test]
    fn four_samples_are_the_rotated_grid() {
        let eighths: Vec<DVec2> = sample_offsets(4).iter().map(|o| *o * 8.0).collect();
        assert_eq!(eighths, [(-3.0, 1.0), (-1.0, -3.0), (1.0, 3.0), (3.0, -1.0)].map(DVec2::from));
    }
}
