//! Blended surfaces: each sample of a pixel sees a surface or looks through it, and the mean of the samples is the blended color.
//!
//! Stochastic transparency (Enderton et al. 2010): a sample sees a surface of opacity at least its threshold. The thresholds of a triangle in a
//! pixel are the middles of equal parts of [0, 1], one for each sample, in an order that differs from triangle to triangle: a surface shows
//! in round(opacity x samples) samples, and surfaces in front of one another show independently. Kernels have the same thresholds, in
//! `wgsl/masks/masked/opacity.wgsl`.

/// The least opacity that a sample sees: the middle of one of `count` equal parts of [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Threshold {
    /// The part's number, from 0.
    pub part: u32,
    pub count: u32,
}

impl Threshold {
    /// One half, the threshold of rays through pixel centers: ids and depths show surfaces that are at least half opaque.
    pub const HALF: Threshold = Threshold { part: 0, count: 1 };

    /// The threshold of a triangle in sample `number` of `count` of pixel `(i, j)` of the camera's image.
    pub fn of_sample((i, j): (u32, u32), triangle: u32, (number, count): (u32, u32)) -> Threshold {
        let seed = mixed(mixed(mixed(i).wrapping_add(j)).wrapping_add(triangle));
        Threshold { part: permuted(number, count, seed), count }
    }

    /// Whether a surface of an opacity in [0, 1] is seen. Kernels compute in f32, so both sides of a tie are the same there.
    pub fn is_reached_by(self, opacity: f32) -> bool {
        opacity * self.count as f32 >= self.part as f32 + 0.5
    }
}

/// A number without a pattern (the 32-bit finalizer of MurmurHash3).
fn mixed(number: u32) -> u32 {
    let mut h = number.wrapping_add(0x9e37_79b9);
    for factor in [0x85eb_ca6b, 0xc2b2_ae35] {
        h = (h ^ h >> 16).wrapping_mul(factor);
    }
    h ^ h >> 16
}

/// The place of `index` in a permutation of `0..count`; each seed has another one (Kensler 2013).
fn permuted(index: u32, count: u32, seed: u32) -> u32 {
    let mask = u32::MAX >> ((count - 1) | 1).leading_zeros();
    let mut k = index;
    loop {
        k = (k ^ seed).wrapping_mul(0xe170_893d);
        k ^= seed >> 16;
        k ^= (k & mask) >> 4;
        k ^= seed >> 8;
        k = k.wrapping_mul(0x0929_eb3f);
        k ^= seed >> 23;
        k ^= (k & mask) >> 1;
        k = k.wrapping_mul(1 | seed >> 27);
        k = k.wrapping_mul(0x6935_fa69);
        k ^= (k & mask) >> 11;
        k = k.wrapping_mul(0x74dc_b303);
        k ^= (k & mask) >> 2;
        k = k.wrapping_mul(0x9e50_1cc3);
        k ^= (k & mask) >> 2;
        k = k.wrapping_mul(0xc860_a3df);
        k &= mask;
        k ^= k >> 5;
        if k < count {
            return (k + seed % count) % count;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_sample_has_a_threshold_of_its_own() {
        for count in [1, 2, 3, 16, 17, 64, 255] {
            for triangle in 0..50 {
                let part = |number| Threshold::of_sample((7, 1000), triangle, (number, count)).part;
                let mut parts: Vec<u32> = (0..count).map(part).collect();
                parts.sort_unstable();
                assert!(parts.into_iter().eq(0..count));
            }
        }
    }

    /// A surface shows in as many samples as its opacity says, and two surfaces show together as often as independent ones.
    #[test]
    fn surfaces_show_by_their_opacity_and_independently() {
        let count = 16;
        let shows = |pixel: (u32, u32), triangle: u32, number: u32, opacity: f32| {
            Threshold::of_sample(pixel, triangle, (number, count)).is_reached_by(opacity)
        };
        let (mut both, mut pixels) = (0.0, 0.0);
        for (i, j) in (0..64).flat_map(|j| (0..64).map(move |i| (i, j))) {
            assert_eq!((0..count).filter(|n| shows((i, j), 5, *n, 0.25)).count(), 4);
            both += (0..count).filter(|n| shows((i, j), 5, *n, 0.5) && shows((i, j), 6, *n, 0.5)).count() as f64 / 16.0;
            pixels += 1.0;
        }
        // of a pixel, the standard deviation is that of a hypergeometric number over 16: 0.065; of the mean of 4,096 pixels 0.001
        assert!((both / pixels - 0.25_f64).abs() < 0.006, "{}", both / pixels);
    }
}
