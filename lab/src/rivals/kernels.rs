//! The rivals' kernels and draws.

use crate::files::{Chosen, kernel};
use anamorph::internals::gpu::kernels::{Kernel, Variant};
use glam::DVec3;

const ONE: &[&str] = &["one"];
const SAMPLES: &[&str] = &["samples"];
const CUBE: &[&str] = &["cube"];

/// A ray a pixel and segment, `brute` against every triangle.
pub fn trace(variant: Variant, layers: u32, segments: u32, brute: bool) -> Kernel {
    // all triangles stand still and are opaque
    let chosen: Chosen = &[
        ("rivals/path", if variant.rays.kind.is_curved() { &["curves"] } else { &["straight"] }),
        ("rivals/search", if brute { &["brute"] } else { &["hierarchy"] }),
        ("shading/casters", &["rivals/search/hierarchy.wgsl"]),
        ("masks", &["opaque"]),
        ("primitives", &["triangles"]),
        ("vertices", &["still"]),
    ];
    let constants = [("LAYERS", f64::from(layers)), ("SEGMENTS", f64::from(segments))];
    kernel("rivals/raytrace.wgsl", variant, chosen, &constants)
}

/// A picture that the rasterizer made, into the visibility buffer.
pub fn take(variant: Variant) -> Kernel {
    kernel("rivals/take.wgsl", variant, &[], &[])
}

/// The same of a picture of several samples a pixel; the pixels whose samples see several triangles are listed too.
pub fn take_samples(variant: Variant) -> Kernel {
    kernel("rivals/take_samples.wgsl", variant, &[], &[])
}

/// A draw of triangles onto so many layers, clipped at the pieces' edges where `culling`.
fn draw(entry: &'static str, (layers, culling): (u32, bool), chosen: Chosen, more: &[(&str, f64)]) -> Kernel {
    let constants = [("LAYERS", f64::from(layers)), ("CULLING", f64::from(u8::from(culling)))];
    kernel(entry, Variant::plain(false, false), chosen, &[&constants[..], more].concat())
}

/// Vertices projected; each triangle split in four so often, and `fan` triangles drawn of each part: 1, or 3 where it is cut off where t ends.
pub fn warp(layers: u32, culling: bool, levels: u32, fan: u32) -> Kernel {
    let more = [("LEVELS", f64::from(levels)), ("FAN", f64::from(fan))];
    draw("rivals/warp.wgsl", (layers, culling), &[("rivals/drawn", ONE)], &more)
}

/// Triangles around images, in the planes through the scene's centre.
pub fn bound(layers: u32, culling: bool, centre: DVec3) -> Kernel {
    let more = [("CENTRE_X", centre.x), ("CENTRE_Y", centre.y), ("CENTRE_Z", centre.z)];
    draw("rivals/bound.wgsl", (layers, culling), &[("rivals/drawn", ONE)], &more)
}

/// Perspective pieces. Where a pixel has several samples, pieces are always clipped: nothing else keeps them apart.
pub fn perspective(layers: u32, culling: bool, samples: u32) -> Kernel {
    let multisampled = samples > 1;
    let drawn = if multisampled { SAMPLES } else { ONE };
    let more = [("MULTISAMPLED", f64::from(u8::from(multisampled)))];
    draw("rivals/perspective.wgsl", (layers, culling || multisampled), &[("rivals/drawn", drawn)], &more)
}

/// What perspective pieces each triangle is drawn in.
pub fn replicate(culling: bool) -> Kernel {
    draw("rivals/replicate.wgsl", (1, culling), &[], &[])
}

/// The faces of a cube map, or the one of an ordinary picture.
fn face(is_cube: bool) -> (&'static str, &'static [&'static str]) {
    ("rivals/face", if is_cube { CUBE } else { ONE })
}

/// Triangles onto a cube around the eye, or onto one picture.
pub fn cube(is_cube: bool) -> Kernel {
    draw("rivals/cube.wgsl", (1, true), &[("rivals/drawn", ONE), face(is_cube)], &[])
}

/// The cube map, or the one picture, to the camera's picture.
pub fn unfold(variant: Variant, is_cube: bool) -> Kernel {
    kernel("rivals/unfold.wgsl", variant, &[face(is_cube)], &[])
}

/// Triangles into the texture S, `samples` texels a side each.
pub fn splat_project(samples: u32) -> Kernel {
    let more = [("SAMPLES", f64::from(samples))];
    draw("rivals/splat_project.wgsl", (1, true), &[("rivals/drawn", ONE)], &more)
}

/// S to where the camera shows it.
pub fn splat_move(layers: u32, culling: bool, samples: u32) -> Kernel {
    let more = [("SAMPLES", f64::from(samples))];
    draw("rivals/splat_move.wgsl", (layers, culling), &[("rivals/drawn", ONE)], &more)
}

/// The compute kernels for cameras of a variant.
pub fn all(variant: Variant) -> Vec<Kernel> {
    let layers = if variant.rays.slabbed { 2 } else { 1 };
    let mut all = vec![trace(variant, layers, 4, false), trace(variant, layers, 1, true), take(variant)];
    all.extend([take_samples(variant), unfold(variant, true), unfold(variant, false), replicate(true)]);
    all
}

/// The draws, onto `layers` layers.
pub fn draws(layers: u32) -> Vec<Kernel> {
    let centre = DVec3::ZERO;
    let onto_s = splat_project(10);
    vec![
        warp(layers, true, 2, 3),
        bound(layers, true, centre),
        perspective(layers, true, 1),
        perspective(layers, true, 4),
        cube(true),
        cube(false),
        onto_s,
        splat_move(layers, true, 10),
    ]
}
