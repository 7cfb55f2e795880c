//! Where a frame's time goes, in scenes that ask for different kernels.

use crate::engine::Method;
use crate::tools::bench::case::{Arm, Case};

const EXAMPLES: [&str; 9] = [
    "city-cross-slit",
    "cow-panorama",
    "city-cylinder",
    "surround",
    "tracked",
    "terrain-top-down",
    "twist-curved",
    "glass-ball",
    "smoke",
];

pub fn cases() -> Vec<Case> {
    EXAMPLES.map(case).into()
}

pub fn quick() -> Vec<Case> {
    EXAMPLES[..4].iter().map(|name| case(name)).collect()
}

/// By raster, whose stages are counted; by tracing; and by the one of both that costs less.
fn case(name: &'static str) -> Case {
    Case::of(name, name, vec![Arm::ours(), Arm::ours().by(Method::Trace), Arm::ours().by(Method::Auto)]).counted()
}
