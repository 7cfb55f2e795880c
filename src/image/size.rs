//! The size of an image.

use crate::input::{Error, Result};

/// Largest width or height of an image, pixels.
pub const MAX_SIDE: u64 = 65_536;
/// Most pixels of an image.
pub const MAX_PIXELS: u64 = 1 << 30;

/// Refuses an image without pixels or beyond the format's limits, naming the limit.
///
/// # Errors
/// [`Error::Input`]; the caller adds where the size came from.
pub fn check_size(width: u64, height: u64) -> Result<()> {
    let size = format!("the image size {width} x {height}");
    if width == 0 || height == 0 {
        return Err(Error::input(format!("{size} has no pixels; both sides must be at least 1")));
    }
    if width > MAX_SIDE || height > MAX_SIDE {
        return Err(Error::input(format!("{size} is over the limit of {MAX_SIDE} pixels a side; make it smaller")));
    }
    if width * height > MAX_PIXELS {
        return Err(Error::input(format!("{size} is over the limit of {MAX_PIXELS} pixels in all; make it smaller")));
    }
    Ok(())
}
