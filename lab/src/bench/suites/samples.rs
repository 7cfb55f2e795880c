//! What less aliasing costs: samples per pixel, against a box filter.

use crate::bench::case::{Arm, Case, Samples, Source};

/// Samples of a pixel of the truth.
const TRUTH: u32 = 256;

/// Multisampling of edge pixels in one frame, by counts or areas, beside one frame per sample.
fn at_once(name: &str, source: Source, samples: &[u32], separate: &[u32]) -> Case {
    let ours = |samples: Samples| Arm::ours().samples(samples);
    let counted = samples.iter().map(|n| ours(Samples::AtOnce(*n)));
    let areas = samples.iter().filter(|n| **n > 1).map(|n| ours(Samples::Analytic(*n)));
    let frames = separate.iter().map(|n| ours(Samples::Separate(*n)));
    Case::new(name, source, counted.chain(areas).chain(frames).collect()).set(&SIZE).filtered(TRUTH)
}

/// A frame for each sample alone.
fn separate(name: &str, source: Source, samples: &[u32]) -> Case {
    at_once(name, source, &[1], samples)
}

/// The reference takes some seconds for each of its samples of more.
const SIZE: [&str; 2] = ["image.width=400", "image.height=300"];

fn all(samples: &[u32], frames: &[u32]) -> Vec<Case> {
    vec![
        at_once("a city of 15,000 triangles through two slits", Source::Example("city-cross-slit"), samples, frames),
        at_once("a city through a lens of 450 pieces", Source::Example("mesh"), samples, frames),
        at_once("a city all around in 160 strips", Source::Example("city-cylinder"), samples, frames),
        at_once("a fisheye: a ball, a cylinder and a box", super::scene!("fisheye"), samples, frames),
        separate("a colonnade along curved rays", Source::Example("twist-curved"), frames),
        separate("a mirror ball", Source::Example("mirror-ball"), frames),
    ]
}

pub fn cases() -> Vec<Case> {
    all(&[1, 4, 8, 16, 32], &[4, 16])
}

pub fn quick() -> Vec<Case> {
    all(&[1, 4], &[4]).into_iter().map(|case| case.filtered(16)).collect()
}
