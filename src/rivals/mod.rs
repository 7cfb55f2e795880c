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

use crate::engine::rival::{Choice, MULTISAMPLES, Parameter, Technique};
use crate::engine::stage::Scopes;
use crate::gpu::buffers::Buffers;

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

/// `NAME` or `NAME:N`.
///
/// # Errors
/// One line that names what is there, where the name or the number is not.
pub fn parse(text: &str) -> std::result::Result<Choice, String> {
    let (name, number) = text.split_once(':').map_or((text, None), |(n, k)| (n, Some(k)));
    let technique = TECHNIQUES.iter().find(|t| t.name == name).ok_or_else(|| {
        let names: Vec<&str> = TECHNIQUES.iter().map(|t| t.name).collect();
        format!("no such engine; use compute, reference, {}", names.join(", "))
    })?;
    let parameter = match (&technique.parameter, number) {
        (Some(parameter), Some(text)) => {
            let Parameter { name: what, least, most, .. } = parameter;
            text.parse()
                .ok()
                .filter(|n| (*least..=*most).contains(n))
                .ok_or_else(|| format!("write {name}:N with {least} to {most} {what}"))?
        }
        (Some(parameter), None) => parameter.default,
        (None, Some(_)) => return Err(format!("{name} takes no number; leave it out")),
        (None, None) => 0,
    };
    Ok(Choice { technique, parameter })
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
