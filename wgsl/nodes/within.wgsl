// The pixels that a triangle may cover in a node's square.

#import nodes/extent.wgsl
#import shared/params.wgsl

// Rounding of a place in node units on its way to pixels: 4 roundings of values up to 2.
const CENTRE_TOLERANCE: f32 = 1.0 / 2097152.0;

// The first columns and rows, and the ends, of the pixels in a square of `side` pixels that an extent holds: pixel k has
// its centre at k + 1/2, and its samples up to `reach` px from there. None where it ends before the range of t or begins behind.
fn pixels_within(seen: Extent, side: u32, reach: f32) -> vec4<u32> {
    if seen.tight && (seen.t_hi < params.t_min.x || seen.t_lo > params.t_max.x) {
        return vec4<u32>(0u);
    }
    let margin = reach + CENTRE_TOLERANCE * f32(side);
    let first = ceil((seen.lo + 1.0) * 0.5 * f32(side) - 0.5 - margin);
    let last = floor((seen.hi + 1.0) * 0.5 * f32(side) - 0.5 + margin);
    let most = vec4<f32>(f32(side));
    return vec4<u32>(clamp(vec4<f32>(first, last + 1.0), vec4<f32>(0.0), most));
}

fn is_empty(pixels: vec4<u32>) -> bool {
    return any(pixels.xy >= pixels.zw);
}
