//! Limits on the work that a scene or a list of jobs may ask for.
//!
//! A file of a few lines can ask for days of work. Work over a limit is refused in one line, before it begins. The
//! limits apply to the whole process. The program removes them for `--no-limits`; a user of the library calls [`lift`]
//! before anything is read. Limits of formats and kernels remain: a triangle id has 28 bits, an
//! image 65,536 pixels per side.

pub mod memory;

use crate::input::{Error, Result};
use std::fmt::Display;
use std::sync::atomic::{AtomicBool, Ordering};

/// A limit on a number of things.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cap {
    /// The things, in the plural.
    pub what: &'static str,
    pub most: u64,
    /// How to stay below it.
    pub advice: &'static str,
}

/// Pieces of a camera: the most that a key may ask for (`pieces = N`) and that `"auto"` makes. Some 250 bytes each.
pub const PIECES: Cap = Cap { what: "pieces", most: 1_000_000, advice: "give fewer" };

/// Pieces that a file or a list holds one by one.
pub const LISTED_PIECES: Cap = Cap { what: "listed pieces", most: 1 << 22, advice: "use a coarser mesh" };

/// Cells of a grid of pieces, with two pieces each: perspective strips, offsets of a camera texture.
pub const CELLS: Cap = Cap { what: "cells", most: 1 << 20, advice: "give fewer" };

/// Cameras on the triangles of a mesh, one each.
pub const CAMERAS: Cap = Cap { what: "cameras", most: 1_000_000, advice: "use a coarser mesh" };

/// Corners of a polygon in the image, which is triangulated in quadratic time.
pub const CORNERS: Cap = Cap { what: "corners", most: 10_000, advice: "use a simpler outline" };

/// Bounces of rays at rough surfaces in an image: width x height x `rays` x `depth`. Each takes up to a microsecond on a CPU.
pub const ROUGH_BOUNCES: Cap =
    Cap { what: "ray bounces", most: 1 << 30, advice: "use fewer rays, less depth or a smaller image" };

/// Frames of a list of jobs. Each takes some microseconds before anything is rendered.
pub const FRAMES: Cap = Cap { what: "frames", most: 4_000_000, advice: "split the list or use fewer swept values" };

/// All limits, in the order of the help text.
#[cfg(feature = "cli")]
pub const ALL: [Cap; 7] = [PIECES, LISTED_PIECES, CELLS, CAMERAS, CORNERS, ROUGH_BOUNCES, FRAMES];

/// The limits, for the help of a command.
#[cfg(feature = "cli")]
pub fn help() -> String {
    let each: Vec<String> = ALL.iter().map(|cap| format!("{} {}", cap.most, cap.what)).collect();
    format!("--no-limits removes these limits: {}, and the free memory, which --memory replaces.", each.join(", "))
}

static LIFTED: AtomicBool = AtomicBool::new(false);

/// Removes all limits, also that on memory, for the rest of the process.
pub fn lift() {
    LIFTED.store(true, Ordering::Relaxed);
}

pub fn are_lifted() -> bool {
    LIFTED.load(Ordering::Relaxed)
}

impl Cap {
    /// # Errors
    /// [`Error::Input`] if `count` is over the limit and limits are not lifted. The caller adds the place.
    pub fn check(&self, count: u64) -> Result<()> {
        self.check_as(count, count)
    }

    /// As [`Cap::check`]; the error shows the count as `shown`, as in `40 x 30`.
    pub fn check_as(&self, count: u64, shown: impl Display) -> Result<()> {
        let Cap { what, most, advice } = self;
        if count <= *most || are_lifted() {
            return Ok(());
        }
        Err(Error::input(format!("{shown} {what} are over the limit of {most}; {advice}, or use --no-limits")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_count_over_a_limit_is_refused_with_the_limit_and_advice() {
        assert!(PIECES.check(PIECES.most).is_ok());
        let error = PIECES.check(PIECES.most + 1).unwrap_err();
        assert_eq!(error.to_string(), "1000001 pieces are over the limit of 1000000; give fewer, or use --no-limits");
        assert_eq!(error.exit_code(), 2);
        let error = CELLS.check_as(1 << 21, "2048 x 1024").unwrap_err();
        assert!(error.to_string().starts_with("2048 x 1024 cells are over"), "{error}");
    }
}
