// What gradients are computed from: rays, corners of triangles, and how both change along a direction.

#import arithmetic
#import gradients/layout.wgsl

var<storage, read> corners: array<vec2<u32>>;
var<storage, read> ray_rates: array<vec2<u32>>;
var<storage, read> rays: array<vec2<u32>>;

// The coordinates of a triangle's corners.
const CORNER_DIRECTIONS: u32 = 9u;

// Numbers of a ray: P, D, and how both change over the pixel to the right, and downwards.
const RAY_NUMBERS: u32 = 18u;

// Vector k of a pixel's ray.
fn ray_vector(pixel: u32, k: u32) -> real3 {
    let at = RAY_NUMBERS * pixel + 3u * k;
    return real3(real_from_bits(rays[at]), real_from_bits(rays[at + 1u]), real_from_bits(rays[at + 2u]));
}

// How it changes along the direction of `ray_rates`; a corner's leave it as it is.
fn ray_rate(pixel: u32, k: u32) -> real3 {
    if gradient_params.directions == CORNER_DIRECTIONS {
        return real3(vec3<f32>(0.0));
    }
    let at = RAY_NUMBERS * pixel + 3u * k;
    return real3(real_from_bits(ray_rates[at]), real_from_bits(ray_rates[at + 1u]), real_from_bits(ray_rates[at + 2u]));
}

// A corner of a triangle.
fn corner(slot: u32, k: u32) -> real3 {
    let at = 9u * slot + 3u * k;
    return real3(real_from_bits(corners[at]), real_from_bits(corners[at + 1u]), real_from_bits(corners[at + 2u]));
}

// How it changes along a direction.
fn corner_rate(direction: u32, k: u32) -> real3 {
    let is_own = gradient_params.directions == CORNER_DIRECTIONS && direction / 3u == k;
    let axis = vec3<u32>(select(3u, direction % 3u, is_own));
    return real3(select(vec3<f32>(0.0), vec3<f32>(1.0), axis == vec3<u32>(0u, 1u, 2u)));
}

// E of the edge between two corners.
fn side(p: real3, d: real3, a: real3, b: real3) -> real {
    return dot(cross(a - p, b - a), d);
}
