//! Keys by which rays are sorted, so that neighbours are near each other in space and direction.

use glam::DVec3;

/// Bits of a coordinate in a key: six fill a word.
pub const KEY_BITS: u32 = 10;

/// Interleaves the bits of six coordinates, each in [0, 2^[`KEY_BITS`]).
pub fn interleaved(points: [DVec3; 2]) -> u64 {
    let mut key = 0;
    for (k, x) in points.iter().flat_map(|p| p.to_array()).enumerate() {
        for bit in 0..KEY_BITS {
            key |= (x as u64 >> bit & 1) << (6 * bit as usize + k);
        }
    }
    key
}
