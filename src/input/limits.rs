//! Limits on the work that a scene or a list of jobs may ask for.
//!
//! A file of a few lines can ask for days of work. Work over a limit is refused in one line, before it begins. A
//! [`Limits`] says which limits hold; it is passed to whatever reads or computes. Limits of formats and kernels always hold: a
//! triangle id has 28 bits, an image 65,536 pixels per side.

pub(super) mod memory;

use crate::input::{Error, Result};
#[cfg(feature = "cli")]
pub(crate) use memory::address_space;
pub(crate) use memory::free_addresses;
use std::fmt::Display;

/// The limits on the work that a scene or a list of jobs may ask for: on pieces, cells, corners, bounces, frames and memory. By default they are
/// those of `docs/reference/limits.md`, and memory is limited to what is free.
///
/// ```
/// use anamorph::{Limits, Scene};
///
/// let text = "image = { width = 8, height = 6 }\n\
///     camera = { kind = \"fisheye\", eye = [0, 0, 4], target = [0, 0, 0], fov = 180, pieces = 2000000 }";
/// assert!(Scene::parse(text, ".").is_err());
/// assert!(Scene::parse_within(text, ".", Limits::none()).is_ok());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Limits {
    are_lifted: bool,
    /// The most bytes that the process may use in all. With `None` it may use what is free besides what it has.
    memory: Option<u64>,
}

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

/// Cameras of a `surround`: one for each triangle of a mesh.
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

impl Limits {
    /// No limits: nothing is refused for its size, as with `--no-limits`.
    pub fn none() -> Limits {
        Limits { are_lifted: true, memory: None }
    }

    /// Sets a budget of memory, as `--memory` does: the process may use this many bytes in all, however many are free. Without
    /// limits it only decides how many frames of a batch are in memory at once.
    #[must_use]
    pub fn memory(self, bytes: u64) -> Limits {
        Limits { memory: Some(bytes), ..self }
    }

    /// # Errors
    /// [`Error::Input`] if `count` is over the limit. The caller adds the place.
    pub(crate) fn check(self, cap: Cap, count: u64) -> Result<()> {
        self.check_as(cap, count, count)
    }

    /// As [`Limits::check`]; the error shows the count as `shown`, as in `40 x 30`.
    pub(crate) fn check_as(self, cap: Cap, count: u64, shown: impl Display) -> Result<()> {
        let Cap { what, most, advice } = cap;
        if count <= most || self.are_lifted {
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
        let limits = Limits::default();
        assert!(limits.check(PIECES, PIECES.most).is_ok());
        let error = limits.check(PIECES, PIECES.most + 1).unwrap_err();
        assert_eq!(error.to_string(), "1000001 pieces are over the limit of 1000000; give fewer, or use --no-limits");
        assert_eq!(error.exit_code(), 2);
        let error = limits.check_as(CELLS, 1 << 21, "2048 x 1024").unwrap_err();
        assert!(error.to_string().starts_with("2048 x 1024 cells are over"), "{error}");
        assert!(Limits::none().check(PIECES, u64::MAX).is_ok());
    }
}
