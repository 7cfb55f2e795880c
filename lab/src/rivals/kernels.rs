//! The rivals' kernels and draws, in the manner of [`anamorph::internals::gpu::kernels`].

use anamorph::internals::gpu::kernels::parts::*;
use anamorph::internals::gpu::kernels::{RaysKind, Variant};
use glam::DVec3;

const LAYOUT: Parts = snippets!("rivals/layout.wgsl");
const SEEN_THROUGH: Parts = snippets!("rivals/seen_through.wgsl");
const RANGE: Parts = snippets!("rivals/range.wgsl");
const DRAWN: Parts = snippets!("rivals/drawn.wgsl");
const DRAWN_SAMPLES: Parts = snippets!("rivals/drawn_samples.wgsl");
const DRAWING: Parts = snippets!("rivals/drawing.wgsl");
const OUTLINE: Parts = snippets!("rivals/outline.wgsl");
const PROJECT: Parts = snippets!("rivals/project.wgsl");
const CUBE_FACE: Parts = snippets!("rivals/cube_face.wgsl");
const ONE_FACE: Parts = snippets!("rivals/one_face.wgsl");
const SPLAT_CELLS: Parts = snippets!("rivals/splat_cells.wgsl");
const PERSPECTIVE: Parts = snippets!("rivals/perspective_image.wgsl");

/// A ray a pixel and segment, `brute` against every triangle.
pub fn trace(variant: Variant, layers: u32, segments: u32, brute: bool) -> Kernel {
    let mut bindings = vec![params(), reads("leaves", "array<LeafTriangle>")];
    bindings.extend((!brute).then(|| reads("bvh", "array<BvhNode>")));
    bindings.push(writes("visibility", "array<vec2<u32>>"));
    bindings.extend(variant.pixel_rays());
    let path = match variant.rays {
        RaysKind::Curves { .. } => snippets!("rivals/curved_path.wgsl"),
        _ => snippets!("rivals/straight_path.wgsl"),
    };
    let search = if brute { snippets!("rivals/brute.wgsl") } else { snippets!("rivals/hierarchy.wgsl") };
    let shared: &[Parts] = if brute { &[SEGMENT] } else { &[SEGMENT, BVH, LEAF_TRIANGLE] };
    let own = [search, path, snippets!("rivals/raytrace.wgsl")];
    let snippets = [&[PARAMS, ITEMS, SLABS, KEY][..], &variant.pixel_snippets(), shared, &own].concat();
    let mut kernel = Kernel::new("raytrace", bindings, &snippets);
    kernel.constants = variant.constants();
    kernel.constants.extend([("LAYERS", f64::from(layers)), ("SEGMENTS", f64::from(segments))]);
    kernel
}

/// A picture that the rasterizer made, into the visibility buffer.
pub fn take(variant: Variant) -> Kernel {
    let bindings = vec![params(), texture("picture", "texture_2d<u32>"), writes("visibility", "array<vec2<u32>>")];
    let snippets = [PARAMS, ITEMS, SLABS, KEY, PACKED_TRIANGLE, variant.real(), snippets!("rivals/take.wgsl")];
    let mut kernel = Kernel::new("take", bindings, &snippets);
    kernel.constants = vec![("SLABBED", f64::from(u8::from(variant.slabbed)))];
    kernel
}

/// The same of a picture of several samples a pixel; the pixels whose samples see several triangles are listed too.
pub fn take_samples(variant: Variant) -> Kernel {
    let bindings = vec![
        params(),
        texture("picture", "texture_multisampled_2d<u32>"),
        writes("visibility", "array<vec2<u32>>"),
        writes("edge_of", "array<u32>"),
        writes("samples", "array<vec2<u32>>"),
        counters(),
    ];
    let snippets = [PARAMS, ITEMS, SLABS, KEY, PACKED_TRIANGLE, variant.real(), snippets!("rivals/take_samples.wgsl")];
    let mut kernel = Kernel::new("take_samples", bindings, &snippets);
    kernel.constants = vec![("SAMPLES", f64::from(variant.samples))];
    kernel
}

/// The triangles of a chunk.
fn mesh() -> [Binding; 2] {
    [triangles(), vertices()]
}

/// A draw of triangles through pieces; `own` says what fragments leave.
fn pieces_draw(name: &'static str, layers: u32, more: &[Binding], own: &[Parts]) -> Kernel {
    let rays = [pieces(), reads("outlines", "array<Outline>")];
    let bindings = [&[params()][..], &mesh(), &rays, more].concat();
    let mut kernel = Kernel::new(
        name,
        bindings,
        &[&[PARAMS, VERTEX, PACKED_TRIANGLE, PIECE_AT, RAY, LAYOUT, RANGE, DRAWING, OUTLINE][..], own].concat(),
    );
    kernel.constants = vec![("LAYERS", f64::from(layers))];
    kernel
}

/// The same, clipped at the pieces' edges where `culling`.
fn clipped_draw(name: &'static str, (layers, culling): (u32, bool), more: &[Binding], own: &[Parts]) -> Kernel {
    let mut kernel = pieces_draw(name, layers, more, own);
    kernel.constants.push(("CULLING", f64::from(u8::from(culling))));
    kernel.enables = "enable clip_distances;\n";
    kernel
}

/// Vertices projected; each triangle split in four so often, and `fan` triangles drawn of each part: 1, or 3 where it is cut off where t ends.
pub fn warp(layers: u32, culling: bool, levels: u32, fan: u32) -> Kernel {
    let mut kernel =
        clipped_draw("warp", (layers, culling), &[], &[DRAWN, PROJECT, SEEN_THROUGH, snippets!("rivals/warp.wgsl")]);
    kernel.constants.extend([("LEVELS", f64::from(levels)), ("FAN", f64::from(fan))]);
    kernel
}

/// Triangles around images, in the planes through the scene's centre.
pub fn bound(layers: u32, culling: bool, centre: DVec3) -> Kernel {
    let mut kernel = clipped_draw("bound", (layers, culling), &[], &[DRAWN, snippets!("rivals/bound.wgsl")]);
    kernel.constants.extend([("CENTRE_X", centre.x), ("CENTRE_Y", centre.y), ("CENTRE_Z", centre.z)]);
    kernel
}

/// Perspective pieces. Where a pixel has several samples, pieces are always clipped: nothing else keeps them apart.
pub fn perspective(layers: u32, culling: bool, samples: u32) -> Kernel {
    let multisampled = samples > 1;
    let drawn = if multisampled { DRAWN_SAMPLES } else { DRAWN };
    let replicas = [reads("replicas", "array<vec2<u32>>")];
    let own = [drawn, PERSPECTIVE, SEEN_THROUGH, snippets!("rivals/perspective.wgsl")];
    let mut kernel = clipped_draw("perspective", (layers, culling || multisampled), &replicas, &own);
    kernel.constants.push(("MULTISAMPLED", f64::from(u8::from(multisampled))));
    kernel
}

/// What perspective pieces each triangle is drawn in.
pub fn replicate(culling: bool) -> Kernel {
    let rays = [reads("cones", "array<Cone>"), pieces(), reads("outlines", "array<Outline>")];
    let own = [writes("replicas", "array<vec2<u32>>"), writes("draw_args", "array<atomic<u32>>")];
    let bindings = [&[params()][..], &mesh(), &rays, &own].concat();
    let own = [OUTLINE, PERSPECTIVE, snippets!("rivals/replicate.wgsl")];
    let mut kernel =
        Kernel::new("replicate", bindings, &[&[PARAMS, ITEMS, VERTEX, PIECE_AT, RAY, LAYOUT][..], &own].concat());
    kernel.constants = vec![("CULLING", f64::from(u8::from(culling)))];
    kernel
}

/// The faces of a cube map, or the one of an ordinary picture.
fn face(is_cube: bool) -> Parts {
    if is_cube { CUBE_FACE } else { ONE_FACE }
}

/// Triangles onto a cube around the eye, or onto one picture.
pub fn cube(is_cube: bool) -> Kernel {
    let bindings = [&[params(), uniform("cube", "Cube")][..], &mesh()].concat();
    Kernel::new(
        "cube",
        bindings,
        &[PARAMS, VERTEX, PACKED_TRIANGLE, LAYOUT, DRAWN, DRAWING, face(is_cube), snippets!("rivals/cube.wgsl")],
    )
}

/// The cube map, or the one picture, to the camera's picture.
pub fn unfold(variant: Variant, is_cube: bool) -> Kernel {
    let mut bindings = vec![params(), uniform("cube", "Cube"), texture("picture", "texture_2d<u32>")];
    bindings.push(writes("visibility", "array<vec2<u32>>"));
    bindings.extend(variant.pixel_rays());
    let own = [PACKED_TRIANGLE, LAYOUT, RANGE, face(is_cube), snippets!("rivals/unfold.wgsl")];
    let snippets = [&[PARAMS, ITEMS, SLABS, KEY][..], &variant.pixel_snippets(), &own].concat();
    let mut kernel = Kernel::new("unfold", bindings, &snippets);
    kernel.constants = variant.constants();
    kernel
}

/// Triangles into the texture S, `samples` texels a side each.
pub fn splat_project(samples: u32) -> Kernel {
    let more = [uniform("splat", "Splat")];
    let mut kernel =
        pieces_draw("splat_project", 1, &more, &[DRAWN, SPLAT_CELLS, PROJECT, snippets!("rivals/splat_project.wgsl")]);
    kernel.constants.push(("SAMPLES", f64::from(samples)));
    kernel
}

/// S to where the camera shows it.
pub fn splat_move(layers: u32, culling: bool, samples: u32) -> Kernel {
    let more = [uniform("splat", "Splat"), texture("s", "texture_2d<f32>")];
    let mut kernel = clipped_draw(
        "splat_move",
        (layers, culling),
        &more,
        &[DRAWN, SPLAT_CELLS, snippets!("rivals/splat_move.wgsl")],
    );
    kernel.constants.push(("SAMPLES", f64::from(samples)));
    kernel
}

/// The compute kernels for cameras of a variant.
pub fn all(variant: Variant) -> Vec<Kernel> {
    let layers = if variant.slabbed { 2 } else { 1 };
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
