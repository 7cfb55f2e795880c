//! The rivals: other visibility algorithms, each faithful to its paper, to be measured against.
//!
//! A rival takes the place of the stages from cull to recheck. It reads the same triangles, the same rays and the same parameters on
//! the device as these do and fills the same visibility buffer, so that scene, camera, pixels and channels are the same in, and
//! shading and reading back the same out: what differs is how what is seen is found, and how well.

mod cubemap;
mod draw;
pub mod kernels;
pub mod layout;
mod outline;
mod raytrace;
mod replicated;
mod splat;
mod through_pieces;

use anamorph::internals::engine::rival::{self, Choice, MULTISAMPLES, Parameter, Technique};
use anamorph::internals::engine::stage::Scopes;
use anamorph::internals::gpu::buffers::Buffers;

/// A rival, and how plots show it.
pub struct Entry {
    pub technique: Technique,
    /// Says its colour.
    pub family: Family,
    pub mark: Mark,
    /// In a legend.
    pub what: &'static str,
}

/// Rivals that find what is seen alike, in the order of legends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Family {
    Trace,
    Warp,
    Splat,
    Bound,
    Pieces,
    Cube,
}

/// The shape of a point in a plot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    Circle,
    Square,
    Diamond,
    Up,
    Down,
}

const RAYS: Technique =
    Technique { name: "", parameter: None, culls: false, draws: false, samples: 1, make: raytrace::rebuilt };
const RASTER: Technique = Technique { culls: true, draws: true, ..RAYS };

/// All rivals.
pub const ENTRIES: [Entry; 12] = [
    Entry {
        family: Family::Trace,
        mark: Mark::Square,
        what: "rays through a hierarchy",
        technique: Technique { name: "raytrace", make: raytrace::rebuilt, ..RAYS },
    },
    Entry {
        family: Family::Trace,
        mark: Mark::Diamond,
        what: "its hierarchy refitted",
        technique: Technique { name: "raytrace-refit", make: raytrace::refitted, ..RAYS },
    },
    Entry {
        family: Family::Trace,
        mark: Mark::Up,
        what: "every triangle",
        technique: Technique { name: "raytrace-brute", make: raytrace::brute, ..RAYS },
    },
    Entry {
        family: Family::Trace,
        mark: Mark::Down,
        what: "curves as segments",
        technique: Technique {
            name: "raymarch-segments",
            parameter: Some(Parameter { name: "segments", default: 8, least: 1, most: 256 }),
            make: raytrace::segments,
            ..RAYS
        },
    },
    Entry {
        family: Family::Warp,
        mark: Mark::Up,
        what: "vertices moved, edges straight",
        technique: Technique {
            name: "raster-warp",
            parameter: Some(Parameter { name: "levels of subdivision", default: 0, least: 0, most: 4 }),
            make: through_pieces::warp,
            ..RASTER
        },
    },
    Entry {
        family: Family::Bound,
        mark: Mark::Diamond,
        what: "bounding triangles (Hou et al.)",
        technique: Technique { name: "raster-bound", make: through_pieces::bound, ..RASTER },
    },
    Entry {
        family: Family::Bound,
        mark: Mark::Down,
        what: "the same, a camera a pass",
        technique: Technique { name: "raster-bound-passes", make: through_pieces::bound_passes, ..RASTER },
    },
    Entry {
        family: Family::Splat,
        mark: Mark::Square,
        what: "texels moved (Yu et al.)",
        technique: Technique { name: "raster-splat", parameter: Some(SAMPLES), make: splat::batched, ..RASTER },
    },
    Entry {
        family: Family::Splat,
        mark: Mark::Down,
        what: "the same, a GLC a pass",
        technique: Technique { name: "raster-splat-passes", parameter: Some(SAMPLES), make: splat::each, ..RASTER },
    },
    Entry {
        family: Family::Pieces,
        mark: Mark::Square,
        what: "replicas (Lorenz and Doellner)",
        technique: Technique { name: "raster-pieces", samples: MULTISAMPLES, make: replicated::replicated, ..RASTER },
    },
    Entry {
        family: Family::Cube,
        mark: Mark::Square,
        what: "looked up in a cube map",
        technique: Technique {
            name: "raster-cubemap",
            parameter: Some(FACE),
            culls: false,
            make: cubemap::cubemap,
            ..RASTER
        },
    },
    Entry {
        family: Family::Cube,
        mark: Mark::Down,
        what: "looked up in one picture",
        technique: Technique {
            name: "raster-image",
            parameter: Some(FACE),
            culls: false,
            make: cubemap::image,
            ..RASTER
        },
    },
];

/// All rivals, without their looks.
pub const TECHNIQUES: &[Technique] = &{
    let mut all = [ENTRIES[0].technique; ENTRIES.len()];
    let mut k = 1;
    while k < all.len() {
        all[k] = ENTRIES[k].technique;
        k += 1;
    }
    all
};

/// Texels that a picture has a side.
const FACE: Parameter = Parameter { name: "texels a side", default: 2048, least: 16, most: 8192 };

/// Texels that a triangle has a side.
const SAMPLES: Parameter = Parameter { name: "texels a side", default: 10, least: 2, most: 256 };

/// Reads `NAME` or `NAME:N`.
///
/// # Errors
/// One line that lists the techniques if the name is unknown, or the numbers if the number is out of range.
pub fn parse(text: &str) -> std::result::Result<Choice, String> {
    rival::parse(text, TECHNIQUES)
}

/// The buffers that a kernel of a rival binds: a chunk's, and its own.
fn with<'a>(scopes: Scopes<'a>, own: &[&'a Buffers]) -> Vec<&'a Buffers> {
    [own, scopes].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_read_as_they_are_written() {
        for text in ["raytrace", "raytrace-brute", "raymarch-segments:8"] {
            assert_eq!(parse(text).unwrap().label(), text);
        }
        assert_eq!(parse("raymarch-segments").unwrap().parameter, 8);
        let refusal = |text: &str| parse(text).unwrap_err();
        assert!(refusal("raytrace:3").contains("takes no number"));
        assert!(refusal("raymarch-segments:0").contains("1 to 256 segments"));
        assert!(refusal("rastr").contains("raytrace-brute"));
    }
}
