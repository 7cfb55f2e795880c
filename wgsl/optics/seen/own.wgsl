// What a pixel of a camera without optics shows: the hit of its own ray.

#import shade.wgsl
#import shared/params.wgsl

// Whether the pixel has a ray at this bounce.
fn has_path(x: u32, y: u32) -> bool {
    return true;
}

// Whether the ray bounces on this surface and continues at the next bounce.
fn goes_on(id: u32) -> bool {
    return false;
}

// Whether the ray ends on a smooth surface.
fn ends_on_smooth(id: u32) -> bool {
    return false;
}

fn colour_of(id: u32, lit: vec3<f32>) -> vec3<f32> {
    return lit;
}

fn light_left(pixel: u32) -> vec3<f32> {
    return vec3<f32>(1.0);
}

fn light_before(plane: u32, at: Place) -> f32 {
    return 0.0;
}

// Whether this bounce writes the planes that are not colours.
fn says_what_is_seen(pixel: u32) -> bool {
    return true;
}

fn path_length(pixel: u32) -> f32 {
    return 0.0;
}

// The surface of the optics that was hit first.
fn first_surface(pixel: u32) -> u32 {
    return NONE;
}

fn first_piece(pixel: u32) -> u32 {
    return 0u;
}
