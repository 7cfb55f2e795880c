// What solve finds of a point in one leaf, and the point about the leaf's anchor.

#import project/layout.wgsl
#import shared/params.wgsl

// Rounding of one operation, relative: 2^-24.
const UNIT_ROUNDING: f32 = 5.9604645e-8;

// How far t may be beyond an end of its range and count, relative to its size or 1: more than the host allows (1e-12).
const END_TOLERANCE: f32 = 2e-6;

// Points are within 2^20 of a leaf's anchor, in units of the camera.
const FARTHEST: f32 = 1048576.0;

fn max_abs(v: vec3<f32>) -> f32 {
    return max(abs(v.x), max(abs(v.y), abs(v.z)));
}

// What was found in a leaf so far.
struct Answer {
    is_proven: bool,
    count: u32,
    images: array<SolveImage, 3>,
}

// A point about an anchor, and a bound of the error of each component.
struct About {
    x: vec3<f32>,
    error: f32,
}

fn about(at: SolvePoint, anchor_hi: vec3<f32>, anchor_lo: vec3<f32>) -> About {
    let far = at.hi - anchor_hi;
    let x = far + (at.lo - anchor_lo);
    // the lower parts are within 2^-24 of the higher, and they and their difference are rounded to f32
    let error = 3.0 * UNIT_ROUNDING * max(max_abs(far), max_abs(x))
        + 8.0 * UNIT_ROUNDING * UNIT_ROUNDING * (max_abs(at.hi) + max_abs(anchor_hi));
    return About(x, error);
}

// The number of the pixel that a place within an error lies in, px about `base`; NONE: a border of a pixel is within the error.
fn pixel_of(px: vec2<f32>, error_px: f32, base: vec2<i32>) -> u32 {
    let first = floor(px - error_px);
    let is_one = all(first == floor(px + error_px));
    let column = u32(i32(first.x) + base.x);
    let row = u32(i32(first.y) + base.y);
    return select(NONE, row * solving.width + column, is_one);
}
