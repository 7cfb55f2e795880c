//! Caps on the work that a scene or a list of jobs may ask for.
//!
//! A file of a few lines can ask for days of work. What goes beyond a cap is refused in one line, before the work
//! begins. Caps hold for the process: the program lifts them for `--no-limits`, a library's user by [`lift`], before
//! anything is read. What a format or a kernel cannot hold (a triangle id has 28 bits, an image 65,536 pixels a side)
//! is no cap and is always refused.

pub mod memory;

use crate::error::{Error, Result};
use std::fmt::Display;
use std::sync::atomic::{AtomicBool, Ordering};

/// Some countable work, and how much of it is done unasked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cap {
    /// In the plural.
    pub what: &'static str,
    pub most: u64,
    /// What to do about it.
    pub advice: &'static str,
}

/// Pieces that a key asks for (`pieces = N`), and that `"auto"` cuts at most: some 250 bytes each.
pub const PIECES: Cap = Cap { what: "pieces", most: 1_000_000, advice: "give fewer" };

/// Pieces that a file or a list holds one by one.
pub const LISTED_PIECES: Cap = Cap { what: "listed pieces", most: 1 << 22, advice: "use a coarser mesh" };

/// Cells of a grid of pieces, with two pieces each: perspective strips, offsets of a camera texture.
pub const CELLS: Cap = Cap { what: "cells", most: 1 << 20, advice: "give fewer" };

/// Cameras that a mesh places, one a triangle.
pub const CAMERAS: Cap = Cap { what: "cameras", most: 1_000_000, advice: "use a coarser mesh" };

/// Corners of a polygon in the image: its triangles take time by their square.
pub const CORNERS: Cap = Cap { what: "corners", most: 10_000, advice: "use a simpler outline" };

/// Turns of rays on rough surfaces in an image: width x height x `rays` x `depth`. Up to a microsecond each on a CPU.
pub const ROUGH_TURNS: Cap =
    Cap { what: "turns of rays", most: 1 << 30, advice: "use fewer rays, less depth or a smaller image" };

/// Frames of a list of jobs: each takes some microseconds before anything is rendered.
pub const FRAMES: Cap = Cap { what: "frames", most: 4_000_000, advice: "split the list or sweep less" };

/// All caps, in the order of the help text.
pub const ALL: [Cap; 7] = [PIECES, LISTED_PIECES, CELLS, CAMERAS, CORNERS, ROUGH_TURNS, FRAMES];

/// The caps, for a command's help.
pub fn help() -> String {
    let each: Vec<String> = ALL.iter().map(|cap| format!("{} {}", cap.most, cap.what)).collect();
    format!("Caps, which --no-limits lifts: {}; and the free memory, or --memory.", each.join(", "))
}

static LIFTED: AtomicBool = AtomicBool::new(false);

/// Lifts all caps, and the check against memory, for the rest of the process.
pub fn lift() {
    LIFTED.store(true, Ordering::Relaxed);
}

pub fn are_lifted() -> bool {
    LIFTED.load(Ordering::Relaxed)
}

impl Cap {
    /// # Errors
    /// [`Error::Input`], to which the caller adds the place, where `count` is over the cap and caps are not lifted.
    pub fn check(&self, count: u64) -> Result<()> {
        self.check_as(count, count)
    }

    /// The same; `shown` is what the error calls the count, as in `40 x 30`.
    pub fn check_as(&self, count: u64, shown: impl Display) -> Result<()> {
        let Cap { what, most, advice } = self;
        if count <= *most || are_lifted() {
            return Ok(());
        }
        Err(Error::input(format!("{shown} {what} are over the limit of {most}; {advice}; --no-limits lifts this")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_count_over_a_cap_is_refused_with_the_cap_and_the_way_out() {
        assert!(PIECES.check(PIECES.most).is_ok());
        let error = PIECES.check(PIECES.most + 1).unwrap_err();
        assert_eq!(
            error.to_string(),
            "1000001 pieces are over the limit of 1000000; give fewer; --no-limits lifts this"
        );
        assert_eq!(error.exit_code(), 2);
        let error = CELLS.check_as(1 << 21, "2048 x 1024").unwrap_err();
        assert!(error.to_string().starts_with("2048 x 1024 cells are over"), "{error}");
    }
}
