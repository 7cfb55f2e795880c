//! How the time grows with the number of GLCs at fixed pixels, of triangles, and of pixels.

use crate::tools::bench::case::{Arm, Case};

const SIZE: [&str; 2] = ["image.width=1024", "image.height=1024"];

/// A fisheye split into so many bilinear pieces. What draws every triangle in every piece is left out where
/// these are too many, see [`crate::tools::bench::race::Rules`].
fn pieces(count: u32) -> Case {
    let with_pieces = |arm: Arm| arm.set(&[&format!("camera.pieces={count}")]).parameter("pieces", f64::from(count));
    // one piece of 170 degrees: bounds are as large as the image
    let bound = (count > 1).then_some("raster-bound");
    let rivals = ["raytrace", "raster-warp:0", "raster-splat-passes:10", "raster-splat:10"].into_iter().chain(bound);
    let arms = [Arm::ours()].into_iter().chain(rivals.map(Arm::rival)).map(with_pieces).collect();
    Case::new(format!("pieces {count:>7}"), super::scene!("fisheye"), arms)
        .truth(&[&format!("camera.pieces={count}")])
        .set(&SIZE)
}

/// A city of so many triangles through one GLC.
fn triangles(count: u32) -> Case {
    let few = |name: &'static str, most: u32| (count <= most).then_some(name);
    let rivals = ["raytrace", "raster-warp:0", "raster-splat:10"].into_iter();
    let some = [few("raster-bound", 1000), few("raytrace-brute", 1000)];
    let rivals = rivals.chain(some.into_iter().flatten()).map(Arm::rival);
    let arms =
        [Arm::ours()].into_iter().chain(rivals).map(|arm| arm.parameter("triangles", f64::from(count))).collect();
    Case::of(format!("triangles {count:>7}"), "city-cross-slit", arms).set(&super::city_of(count)).set(&SIZE)
}

/// A city through one GLC, so many pixels per side.
fn pixels(side: u32) -> Case {
    let more = |arm: Arm| arm.parameter("pixels a side", f64::from(side));
    let arms = ["raytrace", "raster-warp:0", "raster-splat:10"].map(Arm::rival);
    let arms = [Arm::ours()].into_iter().chain(arms).map(more).collect();
    let size = [format!("image.width={side}"), format!("image.height={side}")];
    Case::of(format!("pixels a side {side:>4}"), "city-cross-slit", arms).set(&[&size[0], &size[1]])
}

pub fn cases() -> Vec<Case> {
    let p = [1, 10, 100, 1000, 10_000, 100_000, 1_000_000].map(pieces);
    let t = [100, 1000, 15_000, 100_000, 1_000_000, 4_000_000].map(triangles);
    let s = [128, 256, 512, 1024, 2048, 4096].map(pixels);
    p.into_iter().chain(t).chain(s).collect()
}

pub fn quick() -> Vec<Case> {
    [1, 10, 100].map(pieces).into_iter().chain([100, 1000, 10_000].map(triangles)).collect()
}
