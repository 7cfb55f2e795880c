//! Where a frame's time goes, in scenes that ask for different kernels.

use crate::bench::case::{Arm, Case};
use anamorph::internals::engine::Method;

const EXAMPLES: [&str; 10] = [
    "city-cross-slit",
    "cow-panorama",
    "city-cylinder",
    "surround",
    "tracked",
    "terrain-top-down",
    "twist-curved",
    "glass-ball",
    "hidden-mirror",
    "smoke",
];

pub fn cases() -> Vec<Case> {
    EXAMPLES.map(case).into_iter().chain([composite(), pictures()]).collect()
}

pub fn quick() -> Vec<Case> {
    EXAMPLES[..4].iter().map(|name| case(name)).collect()
}

/// The same surfaces with pictures of three cameras thrown onto them, and without: what each costs, and what their shadow rays do.
fn pictures() -> Case {
    let through =
        ["projector_light.0.occlusion=false", "projector_light.1.occlusion=false", "projector_light.2.occlusion=false"];
    let open = Arm::ours().set(&through).label("nothing hides them");
    let bare = Arm::ours().set(&["projector_light=[]"]).label("without pictures");
    Case::of("pictures of three cameras on surfaces", "video-on-city", vec![Arm::ours(), open, bare])
}

/// Curves of three cameras. Small: in the fisheye's region a tile's bounds say little, and raster tests most triangles for all of its rays.
fn composite() -> Case {
    case("composite").set(&["image.width=80", "image.height=60"])
}

/// By raster, whose stages are counted; by tracing; and by the one of both that costs less.
fn case(name: &'static str) -> Case {
    Case::of(name, name, vec![Arm::ours(), Arm::ours().by(Method::Trace), Arm::ours().by(Method::Auto)]).counted()
}
