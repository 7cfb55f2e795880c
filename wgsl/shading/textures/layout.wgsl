// Surfaces with images on them: the second and third vec4 of a slot hold the texture coordinates of its corners in file order.
// An image hangs downwards from its first texel, so v runs downwards here.

#import arithmetic
#import shading/colors
#import shading/materials/rows.wgsl
#import vertices/triangle.wgsl
#import vertices/vertex

fn triangle_surface(slot: u32) -> vec4<u32> {
    return surface_row(SURFACE_VEC4S * own_slot(slot));
}

fn has_uv(slot: u32) -> bool {
    return surface_row(SURFACE_VEC4S * own_slot(slot) + 2u).z != 0u;
}

// Of the stored corners.
fn corner_uv(slot: u32, triangle: vec4<u32>) -> array<vec2<f32>, 3> {
    let ab = bitcast<vec4<f32>>(surface_row(SURFACE_VEC4S * own_slot(slot) + 1u));
    let c = bitcast<vec4<f32>>(surface_row(SURFACE_VEC4S * own_slot(slot) + 2u));
    let order = corner_order(triangle_order(triangle));
    var uv: array<vec2<f32>, 3>;
    uv[order.x] = ab.xy;
    uv[order.y] = ab.zw;
    uv[order.z] = c.xy;
    return uv;
}

// Weights from the values of the opposite edges: of a hit, whatever was rounded.
fn on_triangle(e: real3) -> real3 {
    return min(max(e / (e.x + e.y + e.z), real3(0.0)), real3(1.0));
}

// Where weights of stored corners lie, near the image.
fn image_place(uv: array<vec2<f32>, 3>, w: real3, wraps: u32) -> vec2<f32> {
    return vec2<f32>(
        near_zero(w.x * real(uv[0].x) + w.y * real(uv[1].x) + w.z * real(uv[2].x), wrap_u(wraps)),
        near_zero(w.x * real(uv[0].y) + w.y * real(uv[1].y) + w.z * real(uv[2].y), wrap_v(wraps)),
    );
}

const WRAP_REPEAT: u32 = 0u;
const WRAP_CLAMP: u32 = 1u;
const WRAP_MIRROR: u32 = 2u;

fn wrap_u(wraps: u32) -> u32 {
    return wraps & 3u;
}

fn wrap_v(wraps: u32) -> u32 {
    return (wraps >> 2u) & 3u;
}

// The same place of the image in [0, 2), where it comes again.
fn near_zero(u: real, wrap: u32) -> f32 {
    let periods = select(2.0 * floor(0.5 * f32(u)), 0.0, wrap == WRAP_CLAMP);
    return f32(u - real(periods));
}
