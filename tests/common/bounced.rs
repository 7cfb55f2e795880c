//! Cameras with a mirror or a lens: every surface and law, by eyes of pieces and of a field.

// every test binary uses a part of it
#![allow(dead_code)]

use super::common::file::load;
use super::stages::Case;
use anamorph::internals::gpu::kernels::Variant;
use anamorph_lab::twin::{KernelInputs, Real};

/// A floor, a ball and a box around the origin; the optics go into the middle.
const THINGS: &str = r#"
[[mesh]]
builtin = "plane"
size = 12
divisions = 5
translate = [0, -1.2, 0]
[[mesh]]
builtin = "icosphere"
level = 2
scale = 0.5
translate = [-1.6, -0.3, 1.4]
[[mesh]]
builtin = "box"
scale = 0.5
translate = [0.3, -0.9, 1.9]
[[light]]
direction = [-1, -2, -1.2]
"#;

const PINHOLE: &str = r#"{ kind = "pinhole", eye = [0.3, 1.1, 6], target = [0, -0.1, 0], vfov = 42 }"#;
const FISHEYE: &str = r#"{ kind = "fisheye", eye = [0, 1, 4], target = [0, 0, 0], fov = 120 }"#;
const INSIDE: &str = r#"{ kind = "fisheye", eye = [0.2, 0.1, 0.3], target = [0, 0, 5], fov = 200 }"#;
/// Under water, looking up.
const UNDER: &str = r#"{ kind = "fisheye", eye = [0.13, -1, 0.07], target = [0.1, 0, 0], up = [0, 0, -1], fov = 150 }"#;
const FAR: &str = r#"{ kind = "pinhole", eye = [10000, 0.5, 4], target = [10000, 0, 0], vfov = 40 }"#;

const SPHERE: &str = r#"shape = "sphere", radius = 1.05, count = 300"#;
const TORUS: &str = r#"shape = "torus", axis = [0.3, 1, 0.5], radius = 0.9, tube = 0.35, count = 400"#;
/// Facets that reflect rays as those of a coarser copy.
const SHOT: &str = r#"shape = "sphere", radius = 1.05, count = 300, cameras = 60"#;
const BOWL: &str = r#"shape = "quadric", vertex = [0, -0.4, -0.5], axis = [0, 0.2, 1], curvature = 1.6, conic = -0.9, radius = 1.1, count = 300"#;
const LENS: &str = r#"shape = "lens", center = [0, 0, 2.5], axis = [0, 0, -1], radius = 0.9, thickness = 0.6, curvatures = [0.5, -0.6], count = 300"#;
const WAVE: &str =
    r#"shape = "wave", center = [0, -0.9, 1], size = 5, amplitude = 0.06, wavelength = 1.7, count = 400"#;
const WATER: &str = r#"shape = "quadric", axis = [0, -1, 0], curvature = 0, radius = 60"#;
const FAR_BALL: &str = r#"shape = "sphere", center = [10000, 0, 0], radius = 1"#;

const WIRE: &str = r#"shape = "torus", axis = [0.3, 1, 0.5], radius = 1.1, tube = 0.02"#;
const HORN: &str = r#"shape = "torus", axis = [0.3, 1, 0.5], radius = 0.6, tube = 0.599"#;
const SPINDLE: &str = r#"shape = "torus", axis = [0.3, 1, 0.5], radius = 0.5, tube = 0.8"#;
const FAR_RING: &str = r#"shape = "torus", center = [10000, 0, 0], axis = [0, 1, 0.5], radius = 0.9, tube = 0.4"#;
const CHOP: &str = r#"shape = "wave", center = [0, -0.9, 1], size = 5, amplitude = 0.3, wavelength = 0.9"#;
const WAVELET: &str = r#"shape = "wave", center = [10000, -0.5, 0], size = 3, amplitude = 0.1, wavelength = 0.7"#;
/// An eye in the middle of a ring, and one just over the water.
const WITHIN: &str = r#"{ kind = "fisheye", eye = [0.02, 0.1, 0.05], target = [0, 0.3, 5], fov = 170 }"#;
const LOW: &str = r#"{ kind = "pinhole", eye = [0.1, -0.5, 3.4], target = [0, -0.62, 0], vfov = 30 }"#;
/// By the wire.
const BY: &str = r#"{ kind = "pinhole", eye = [1.3, -0.2, 0.4], target = [1.054, -0.316, 0], vfov = 42 }"#;
/// The same ring from so far away that f32 resolves a thousandth of it.
const DISTANT: &str = r#"{ kind = "pinhole", eye = [3000, 5500, 7000], target = [0, 0, 0], vfov = 0.02 }"#;

/// The scene and the camera of these keys.
pub fn case(name: &str, size: (u32, u32), camera: &str) -> Case {
    let (w, h) = size;
    let image = format!("image = {{ width = {w}, height = {h}, background = [0.2, 0.3, 0.4] }}");
    let scene = load(&format!("{image}\n{THINGS}\n[camera]\n{camera}\n")).unwrap();
    let camera = scene.camera().unwrap();
    let mut case = Case::new(name, (**scene.mesh).clone(), camera);
    case.scene = scene;
    case
}

/// Every law, kind of surface and eye; rays that meet the optics again; total reflection, a lens's wall, optics far from
/// the scene; and one case in bands and chunks.
pub fn cases() -> Vec<Case> {
    let size = (61, 43);
    let mirror = |eye: &str, shape: &str, facets: &str, depth: u32| {
        let keys = format!("mirror = {{ {shape} }}\nfacets = \"{facets}\"\ndepth = {depth}\ncolor = [0.9, 0.8, 0.7]");
        let name = format!("reflection, {facets}, {depth}, {shape}");
        case(&name, size, &format!("kind = \"reflection\"\neye = {eye}\n{keys}"))
    };
    let lens = |eye: &str, shape: &str, facets: &str, depth: u32| {
        let keys = format!("ior = 1.45\nlens = {{ {shape} }}\nfacets = \"{facets}\"\ndepth = {depth}");
        let name = format!("refraction, {facets}, {depth}, {shape}");
        case(&name, size, &format!("kind = \"refraction\"\neye = {eye}\n{keys}"))
    };
    let mut split = mirror(PINHOLE, SPHERE, "normals", 2);
    split.name = "bands and chunks".into();
    // some 16 rows of eleven channels a band, some 100 triangles a chunk
    (split.band_limit, split.chunk_limit) = (62 * 44 * 20, 36 * 100);
    vec![
        mirror(PINHOLE, SPHERE, "normals", 2),
        mirror(PINHOLE, TORUS, "flat", 1),
        mirror(PINHOLE, SHOT, "normals", 2),
        mirror(FISHEYE, TORUS, "normals", 3),
        mirror(PINHOLE, SPHERE, "exact", 2),
        mirror(PINHOLE, BOWL, "exact", 3),
        mirror(FISHEYE, SPHERE, "exact", 1),
        mirror(FAR, FAR_BALL, "exact", 1),
        lens(PINHOLE, SPHERE, "flat", 1),
        lens(PINHOLE, LENS, "normals", 4),
        lens(PINHOLE, WAVE, "normals", 1),
        lens(INSIDE, SPHERE, "normals", 2),
        lens(PINHOLE, LENS, "exact", 3),
        lens(PINHOLE, SPHERE, "exact", 2),
        lens(INSIDE, SPHERE, "exact", 2),
        lens(UNDER, WATER, "exact", 1),
        mirror(PINHOLE, TORUS, "exact", 3),
        mirror(WITHIN, TORUS, "exact", 2),
        lens(PINHOLE, TORUS, "exact", 3),
        mirror(PINHOLE, WAVE, "exact", 2),
        mirror(LOW, CHOP, "exact", 3),
        lens(FISHEYE, WAVE, "exact", 1),
        split,
    ]
}

/// Cases that need f64: rays close to thin or self-touching surfaces, and optics far from the scene or from the rays' origins.
pub fn delicate() -> Vec<Case> {
    let optical = |eye: &str, what: &str| {
        case(&format!("{what}, from {eye}"), (61, 43), &format!("eye = {eye}\ndepth = 3\n{what}"))
    };
    let mirror = |eye: &str, shape: &str| optical(eye, &format!("kind = \"reflection\"\nmirror = {{ {shape} }}"));
    let lens =
        |eye: &str, shape: &str| optical(eye, &format!("kind = \"refraction\"\nior = 1.45\nlens = {{ {shape} }}"));
    vec![
        mirror(BY, WIRE),
        mirror(PINHOLE, HORN),
        lens(PINHOLE, SPINDLE),
        mirror(DISTANT, TORUS),
        mirror(FAR, FAR_RING),
        mirror(FAR, WAVELET),
    ]
}

/// The kernels for the rays of an input.
pub fn variant(case: &Case, input: &KernelInputs, real: Real, atomics64: bool) -> Variant {
    let first = case.variant(real, atomics64);
    if bounces(input) > 0 { first.after_bounce() } else { first }
}

/// The number of bounces before the rays of an input.
pub fn bounces(input: &KernelInputs) -> u32 {
    input.optics.map_or(0, |o| o.optic.bounces)
}
