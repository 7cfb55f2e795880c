//! Where a frame's time goes, in scenes that ask for different kernels.

use crate::tools::bench::case::{Case, arms};

const EXAMPLES: [&str; 8] = [
    "city-cross-slit",
    "cow-panorama",
    "city-cylinder",
    "surround",
    "tracked",
    "terrain-top-down",
    "twist-curved",
    "glass-ball",
];

pub fn cases() -> Vec<Case> {
    EXAMPLES.map(|name| Case::of(name, name, arms(&[])).counted()).into()
}

pub fn quick() -> Vec<Case> {
    EXAMPLES[..4].iter().map(|name| Case::of(*name, name, arms(&[])).counted()).collect()
}
