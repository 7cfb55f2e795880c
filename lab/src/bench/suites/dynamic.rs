//! Every vertex is new in each frame, or the camera: what changes is made anew and uploaded, what a technique builds over it is built
//! again, and all of that is in the time.

use crate::bench::case::{Arm, Case, arms};
use crate::bench::row::Moving;
use anamorph::internals::engine::Method;

/// Triangles up to which every one is tried everywhere, and up to which their bounds, each as large as the image, are drawn.
const FEW: u32 = 1000;

const SIZE: [&str; 2] = ["image.width=800", "image.height=600"];

/// So many triangles through one GLC, all of them new in each frame.
fn triangles(count: u32) -> Case {
    let bound = (count <= FEW).then(|| Arm::rival("raster-bound"));
    let no_cull = (count <= FEW).then(|| [Arm::ours(), Arm::rival("raster-bound")].map(Arm::no_cull));
    let all = arms(&["raytrace", "raytrace-refit", "raster-warp:0"]);
    let all = all.into_iter().chain(bound).chain(no_cull.into_iter().flatten());
    let all = all.map(|arm| arm.parameter("moving triangles", f64::from(count))).collect();
    Case::of(format!("{count:>7} moving triangles"), "city-cross-slit", all)
        .moving(Moving::Triangles)
        .set(&super::city_of(count))
        .set(&SIZE)
}

/// So many triangles under one GLC that is new in each frame.
fn under_a_camera(count: u32) -> Case {
    let all = arms(&["raytrace", "raster-warp:0"]);
    let all = all.into_iter().map(|arm| arm.parameter("triangles under a moving camera", f64::from(count))).collect();
    let eye = "camera.eye=[{ frame = 0, value = [0, 26, 60] }, { frame = 100, value = [9, 30, 55] }]";
    Case::of(format!("{count:>7} triangles under a moving camera"), "city-cross-slit", all)
        .moving(Moving::Camera)
        .set(&super::city_of(count))
        .set(&[eye])
        .set(&SIZE)
}

/// A fisheye in so many pieces, all of them new in each frame.
fn pieces(count: u32) -> Case {
    let rivals: &[&str] = if count <= FEW { &["raytrace", "raster-warp:0"] } else { &["raytrace"] };
    let all =
        arms(rivals).into_iter().map(|arm| arm.parameter("pieces of a moving camera", f64::from(count))).collect();
    let eye = "camera.eye=[{ frame = 0, value = [34, 40, 62] }, { frame = 100, value = [40, 36, 58] }]";
    Case::new(format!("{count:>7} pieces of a moving camera"), super::scene!("fisheye"), all)
        .moving(Moving::Camera)
        .set(&[&format!("camera.pieces={count}"), &eye.to_owned()])
}

/// So many triangles that slide while their picture is read row by row; and the same at rest, which is wrong where they have moved.
fn while_read(count: u32) -> Case {
    let still = Arm::ours().by(Method::Trace).set(&["camera.line_time=0"]).label("at rest");
    let all = [Arm::ours().by(Method::Trace), still];
    let all = all.into_iter().map(|arm| arm.parameter("triangles that move while read", f64::from(count))).collect();
    let slide = "mesh.0.translate=[{ frame = 0, value = [0, 0, 0] }, { frame = 1, value = [3, 0, 0] }]";
    Case::of(format!("{count:>7} triangles that move while read"), "city-cross-slit", all)
        .set(&super::city_of(count))
        .set(&[slide, "camera.line_time=0.0016"])
        .set(&SIZE)
}

pub fn cases() -> Vec<Case> {
    let counts = [1000, 10_000, 100_000, 1_000_000, 4_000_000];
    let pieces = [10, 100, 1000, 10_000].map(pieces);
    counts
        .map(triangles)
        .into_iter()
        .chain(counts.map(under_a_camera))
        .chain(pieces)
        .chain(counts.map(while_read))
        .collect()
}

pub fn quick() -> Vec<Case> {
    let counts = [1000, 10_000];
    let read = [while_read(1000)];
    counts
        .map(triangles)
        .into_iter()
        .chain(counts.map(under_a_camera))
        .chain([10, 100].map(pieces))
        .chain(read)
        .collect()
}
