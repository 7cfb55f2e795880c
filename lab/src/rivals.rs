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

/// All rivals.
pub const TECHNIQUES: &[Technique] = &[
    Technique { name: "raytrace", parameter: None, culls: false, draws: false, samples: 1, make: raytrace::rebuilt },
    Technique {
        name: "raytrace-refit",
        parameter: None,
        culls: false,
        draws: false,
        samples: 1,
        make: raytrace::refitted,
    },
    Technique {
        name: "raytrace-brute",
        parameter: None,
        culls: false,
        draws: false,
        samples: 1,
        make: raytrace::brute,
    },
    Technique {
        name: "raymarch-segments",
        parameter: Some(Parameter { name: "segments", default: 8, least: 1, most: 256 }),
        culls: false,
        draws: false,
        samples: 1,
        make: raytrace::segments,
    },
    Technique {
        name: "raster-warp",
        parameter: Some(Parameter { name: "levels of subdivision", default: 0, least: 0, most: 4 }),
        culls: true,
        draws: true,
        samples: 1,
        make: through_pieces::warp,
    },
    Technique {
        name: "raster-bound",
        parameter: None,
        culls: true,
        draws: true,
        samples: 1,
        make: through_pieces::bound,
    },
    Technique {
        name: "raster-bound-passes",
        parameter: None,
        culls: true,
        draws: true,
        samples: 1,
        make: through_pieces::bound_passes,
    },
    Technique {
        name: "raster-splat",
        parameter: Some(SAMPLES),
        culls: true,
        draws: true,
        samples: 1,
        make: splat::batched,
    },
    Technique {
        name: "raster-splat-passes",
        parameter: Some(SAMPLES),
        culls: true,
        draws: true,
        samples: 1,
        make: splat::each,
    },
    Technique {
        name: "raster-pieces",
        parameter: None,
        culls: true,
        draws: true,
        samples: MULTISAMPLES,
        make: replicated::replicated,
    },
    Technique {
        name: "raster-cubemap",
        parameter: Some(Parameter { name: "texels a side", default: 2048, least: 16, most: 8192 }),
        culls: false,
        draws: true,
        samples: 1,
        make: cubemap::cubemap,
    },
    Technique {
        name: "raster-image",
        parameter: Some(Parameter { name: "texels a side", default: 2048, least: 16, most: 8192 }),
        culls: false,
        draws: true,
        samples: 1,
        make: cubemap::image,
    },
];

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
