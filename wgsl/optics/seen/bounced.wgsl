// What a pixel of a camera with a mirror or lens shows: the hit of its last ray.

#import optics/layout.wgsl
#import shade.wgsl
#import shading/surface.wgsl
#import shared/params.wgsl
#import shared/planes.wgsl

fn has_path(x: u32, y: u32) -> bool {
    return select(paths[y * params.width + x].last, 0u, optic.bounces == 0u) != NONE;
}

fn goes_on(id: u32) -> bool {
    return id >= optic.first_id && optic.ends == 0u;
}

fn ends_on_smooth(id: u32) -> bool {
    return SMOOTH && id >= optic.first_id;
}

fn colour_of(id: u32, lit: vec3<f32>) -> vec3<f32> {
    return select(lit, optic.base, id >= optic.first_id);
}

fn light_left(pixel: u32) -> vec3<f32> {
    return paths[pixel].light;
}

// Bounces that share a pixel's light add up; the planes start at 0.
fn light_before(plane: u32, at: Place) -> f32 {
    return bitcast<f32>(planes[plane * at.count + at.pixel]);
}

fn says_what_is_seen(pixel: u32) -> bool {
    return by_thread(optic.colour_only, pixel) == 0u;
}

fn path_length(pixel: u32) -> f32 {
    return paths[pixel].length;
}

fn first_surface(pixel: u32) -> u32 {
    return paths[pixel].first;
}

// The piece that the first surface belongs to.
fn first_piece(pixel: u32) -> u32 {
    return optic.piece_first + paths[pixel].piece;
}

override SMOOTH: bool = false;
