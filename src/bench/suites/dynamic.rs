//! Every vertex is new in each frame: it is uploaded, and what a technique builds over the triangles is built again, in the time.

use crate::bench::case::{Arm, Case, arms};

fn city(count: u32) -> Case {
    let more = |arm: Arm| arm.knob("moving triangles", f64::from(count));
    let all = arms(&["raytrace", "raytrace-refit", "raster-warp:0", "raster-bound"]);
    Case {
        moving: true,
        ..Case::of(format!("moving {count:>7}"), "city-cross-slit", all.into_iter().map(more).collect())
    }
    .set(&[&format!("mesh.0.triangles={count}"), "image.width=800", "image.height=600"])
}

pub fn cases() -> Vec<Case> {
    [1000, 10_000, 100_000, 1_000_000].map(city).into()
}

pub fn quick() -> Vec<Case> {
    [1000, 10_000].map(city).into()
}
