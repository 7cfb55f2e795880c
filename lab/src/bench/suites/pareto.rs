//! Each technique over the number that trades its error for its time.

use crate::bench::case::{Arm, Case};

/// One cross-slit GLC over a city.
fn city(samples: &[u32], levels: &[u32]) -> Case {
    Case::of("one GLC: a city of 15,000 triangles through two slits", "city-cross-slit", one_glc(samples, levels))
        .set(&["image.width=800", "image.height=600"])
}

/// The same over few triangles.
fn primitives(samples: &[u32], levels: &[u32]) -> Case {
    let arms = one_glc(samples, levels).into_iter().chain([Arm::rival("raster-bound")]).collect();
    Case::new("one GLC: a ball, a cylinder and a box", super::scene!("primitives"), arms)
}

fn one_glc(samples: &[u32], levels: &[u32]) -> Vec<Arm> {
    let splat = samples.iter().map(|k| Arm::rival(&format!("raster-splat:{k}")));
    let warp = levels.iter().map(|k| Arm::rival(&format!("raster-warp:{k}")));
    [Arm::ours()].into_iter().chain(splat).chain(warp).chain([Arm::rival("raytrace")]).collect()
}

/// A cylinder all around, exact or in perspective strips.
fn cylinder(strips: &[u32], sides: &[u32]) -> Case {
    let with_strips = |arm: Arm, n: u32| arm.set(&[&format!("camera.strips={n}")]).parameter("strips", f64::from(n));
    let ours = strips.iter().map(|n| with_strips(Arm::ours(), *n));
    let pieces = strips.iter().map(|n| with_strips(Arm::rival("raster-pieces"), *n));
    let cubes = sides.iter().map(|n| Arm::rival(&format!("raster-cubemap:{n}")));
    let exact = [Arm::ours(), Arm::rival("raytrace")];
    let arms = exact.into_iter().chain(ours).chain(pieces).chain(cubes).collect();
    Case::new("a cylinder of 360 degrees: a city of 35,000 triangles", super::cylinder_scene(), arms)
}

/// A mirror ball by facets, with and without an atlas, and by an environment map.
fn mirror(counts: &[u32], texels: &[u32]) -> Case {
    let facets = |law: &str, n: u32| {
        let set = [format!("camera.facets=\"{law}\""), format!("camera.mirror.count={n}")];
        Arm::ours().set(&[&set[0], &set[1]])
    };
    let exact = Arm::ours().set(&["camera.facets=\"exact\""]);
    let environment = exact.clone().set(&["camera.environment=[0, 0, 0]"]).label("environment map");
    let normals =
        counts.iter().map(|n| facets("normals", *n).label("facets with normals").parameter("facets", f64::from(*n)));
    let flat = counts.iter().map(|n| facets("flat", *n).label("flat facets").parameter("facets", f64::from(*n)));
    let atlas = |r: &u32| {
        let painted = facets("flat", 126).set(&[&format!("camera.atlas={r}")]);
        painted.label("126 flat facets from an atlas").parameter("texels", f64::from(*r))
    };
    let splat = |r: &u32| Arm { rival: Arm::rival("raster-splat:6").rival, ..atlas(r) };
    let bound = |r: &u32| Arm { rival: Arm::rival("raster-bound").rival, ..atlas(r) };
    let atlases = texels.iter().flat_map(|r| [atlas(r), splat(r), bound(r)]);
    let arms = [exact, environment].into_iter().chain(normals).chain(flat).chain(atlases).collect();
    Case::of("a mirror ball in a scene of 1,100 triangles", "mirror-ball", arms).truth(&["camera.facets=\"exact\""])
}

/// Cubic projectors.
fn curves(segments: &[u32]) -> Case {
    let segmented = segments.iter().map(|n| Arm::rival(&format!("raymarch-segments:{n}")));
    Case::of("curved projectors", "twist-curved", [Arm::ours()].into_iter().chain(segmented).collect())
}

pub fn cases() -> Vec<Case> {
    vec![
        city(&[3, 5, 10, 20], &[0, 1, 2, 3, 4]),
        primitives(&[3, 5, 10, 20, 40], &[0, 1, 2, 3, 4]),
        cylinder(&[10, 20, 40, 80, 160, 320], &[256, 512, 1024, 2048, 4096]),
        mirror(&[126, 480, 960, 3840, 15_360, 61_440], &[16, 32, 64]),
        curves(&[1, 2, 4, 8, 16, 32, 64]),
    ]
}

pub fn quick() -> Vec<Case> {
    vec![city(&[5], &[0, 1]), primitives(&[5], &[0, 2]), cylinder(&[20], &[128]), mirror(&[126], &[8]), curves(&[2, 8])]
}
