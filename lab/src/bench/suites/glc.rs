//! How the time grows with the number of GLCs at fixed pixels, of triangles, of pixels, and of spheres.

use crate::bench::case::{Arm, Case, Source};
use std::fmt::Write;

const SIZE: [&str; 2] = ["image.width=1024", "image.height=1024"];

/// A fisheye split into so many bilinear pieces. What draws every triangle in every piece is left out where
/// these are too many, see [`crate::bench::race::Rules`].
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

/// So many spheres through one GLC: exact ones, and each as a mesh of 20 x 4^level triangles. Ids differ then by themselves; what is wrong is
/// told by hits and misses, and by Z.
fn spheres(count: u32) -> Case {
    const RADIUS: f64 = 0.03;
    /// Golden ratios in three dimensions: places that are spread evenly however many there are.
    const SPREAD: [f64; 3] = [0.819_172_513_396_164, 0.671_043_606_703_789, 0.549_700_477_901_970];
    const LEVELS: [(u32, &str); 3] = [(1, "meshes of level 1"), (2, "meshes of level 2"), (3, "meshes of level 3")];
    let (mut centers, mut places) = (String::new(), String::new());
    for k in 1..=count {
        let [x, y, z] = SPREAD.map(|s| 2.0 * (f64::from(k) * s).fract() - 1.0);
        // writing to a String cannot fail
        let _ = write!(centers, "[{x}, {y}, {z}], ");
        let _ = write!(places, "[[{RADIUS}, 0, 0, {x}], [0, {RADIUS}, 0, {y}], [0, 0, {RADIUS}, {z}]], ");
    }
    let scene = format!(
        "image = {{ width = 1024, height = 1024 }}\n[camera]\nkind = \"glc\"\nnear = [[-1, 1, 2], [1, 1, 2], [-1, -1, 2]]\n\
         far = [[-1.4, 2, -2], [1.4, 2, -2], [-1.4, -2, -2]]\n[[spheres]]\nradius = {RADIUS}\ncenters = [{centers}]\n\
         [[mesh]]\nbuiltin = \"icosphere\"\nplaces = [{places}]\n"
    );
    let exact = Arm::ours().set(&["mesh=[]"]);
    let as_meshes =
        LEVELS.map(|(level, label)| Arm::ours().set(&["spheres=[]", &format!("mesh.0.level={level}")]).label(label));
    let arms = [exact].into_iter().chain(as_meshes).map(|arm| arm.parameter("spheres", f64::from(count))).collect();
    Case::new(format!("spheres {count:>7}"), Source::Text(scene), arms).truth(&["mesh=[]"])
}

pub fn cases() -> Vec<Case> {
    let p = [1, 10, 100, 1000, 10_000, 100_000, 1_000_000].map(pieces);
    let t = [100, 1000, 15_000, 100_000, 1_000_000, 4_000_000].map(triangles);
    let s = [128, 256, 512, 1024, 2048, 4096].map(pixels);
    let balls = [100, 1000, 10_000].map(spheres);
    p.into_iter().chain(t).chain(s).chain(balls).collect()
}

pub fn quick() -> Vec<Case> {
    let balls = [spheres(100)];
    [1, 10, 100].map(pieces).into_iter().chain([100, 1000, 10_000].map(triangles)).chain(balls).collect()
}
