//! How the time grows with the number of GLCs at fixed pixels, of triangles, and of pixels. Where a technique draws every triangle
//! in every piece, the sweep ends for it where a frame takes minutes.

use crate::bench::case::{Arm, Case};

/// (triangle, piece) pairs up to which techniques that draw all of them are run.
const PAIRS_MAX: f64 = 2e7;

/// A fisheye cut into so many bilinear pieces; the truth is the fisheye.
fn pieces(count: u32) -> Case {
    let n = f64::from(count);
    let cut = |arm: Arm| arm.set(&[&format!("camera.pieces={count}")]).knob("pieces", n);
    let all_pairs = TRIANGLES * n <= PAIRS_MAX;
    let drawn = ["raster-bound", "raster-warp:0", "raster-splat-passes:10"].map(Arm::rival);
    let arms = [Arm::ours(), Arm::rival("raytrace")].into_iter().chain(drawn.into_iter().filter(|_| all_pairs));
    Case::new(format!("pieces {count:>7}"), super::scene!("fisheye"), arms.map(cut).collect())
}

/// Triangles of the scene that is cut into pieces.
const TRIANGLES: f64 = 15_000.0;

/// A city of so many triangles through one GLC.
fn triangles(count: u32) -> Case {
    let more = |arm: Arm| arm.knob("triangles", f64::from(count));
    let few = |name: &str, most: u32| (count <= most).then(|| Arm::rival(name));
    let all = [Arm::ours(), Arm::rival("raytrace"), Arm::rival("raster-warp:0"), Arm::rival("raster-bound")];
    let some = [few("raster-splat:10", 100_000), few("raytrace-brute", 1000)];
    Case::of(
        format!("triangles {count:>7}"),
        "city-cross-slit",
        all.into_iter().chain(some.into_iter().flatten()).map(more).collect(),
    )
    .set(&[&format!("mesh.0.triangles={count}"), "image.width=800", "image.height=600"])
}

/// A city through one GLC, so many pixels a side.
fn pixels(side: u32) -> Case {
    let more = |arm: Arm| arm.knob("pixels a side", f64::from(side));
    let arms = ["raytrace", "raster-warp:0", "raster-bound", "raster-splat:10"].map(Arm::rival);
    let arms = [Arm::ours()].into_iter().chain(arms).map(more).collect();
    let size = [format!("image.width={side}"), format!("image.height={side}")];
    Case::of(format!("pixels a side {side:>4}"), "city-cross-slit", arms).set(&[&size[0], &size[1]])
}

pub fn cases() -> Vec<Case> {
    let p = [1, 10, 100, 1000, 10_000, 100_000, 1_000_000].map(pieces);
    let t = [100, 1000, 10_000, 100_000, 1_000_000, 4_000_000].map(triangles);
    let s = [128, 256, 512, 1024, 2048, 4096].map(pixels);
    p.into_iter().chain(t).chain(s).collect()
}

pub fn quick() -> Vec<Case> {
    [1, 10, 100].map(pieces).into_iter().chain([100, 1000, 10_000].map(triangles)).collect()
}
