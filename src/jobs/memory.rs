//! Checks before the work that an image fits the machine's memory.

use crate::input::{Limits, Result};

/// Bytes a pixel that do not depend on the channels: visibility, picture, tables of tiles and pieces.
const FIXED_BYTES: u64 = 32;
/// Copies of a channel's four bytes alive at once: on the device, in a read-back buffer, joined, and being encoded.
const COPIES: u64 = 4;

/// Refuses an image of `size` pixels with `channels` planes, and `more` bytes per pixel, that is larger than the free memory.
///
/// # Errors
/// [`Error::Work`](crate::input::Error::Work) that names the limit.
pub fn check(size: (u32, u32), channels: usize, more: u64, limits: Limits) -> Result<()> {
    let (width, height) = size;
    let (and, fewer) = if more > 0 { (" and its samples", " or --samples") } else { ("", "") };
    let what = format!("an image of {width} x {height} with {channels} channels{and}");
    let advice = format!("make it smaller or ask for fewer --channels{fewer}");
    limits.check_memory(need(size, channels, more), what, &advice)
}

/// Memory of such an image, bytes.
pub fn need((width, height): (u32, u32), channels: usize, more: u64) -> u64 {
    u64::from(width) * u64::from(height) * (FIXED_BYTES + 4 * COPIES * channels as u64 + more)
}
