// Whether any ray of a node may meet a box. Conservative: never false when one does.

#import shared/params.wgsl

// Relative tolerance on t for the rounding of two additions and a division, 2^-24 each.
const T_TOLERANCE: f32 = 1e-6;

// The part of [range.x, range.y] (t >= 0) where a t with q + t d within +-(r0 + t r1) in every component may lie;
// empty when .x > .y.
fn slab(q: vec3<f32>, d: vec3<f32>, r0: vec3<f32>, r1: vec3<f32>, range: vec2<f32>) -> vec2<f32> {
    // t a <= b, on either side of each component
    return side_of_slab(d - r1, r0 - q, side_of_slab(-d - r1, r0 + q, range));
}

fn side_of_slab(a: vec3<f32>, b: vec3<f32>, range: vec2<f32>) -> vec2<f32> {
    let t = b / a;
    let more = t * (1.0 + T_TOLERANCE);
    let less = t * (1.0 - T_TOLERANCE);
    let zero = vec3<f32>(0.0);
    let most = select(vec3<f32>(range.y), select(less, more, b > zero), a > zero);
    let least = select(vec3<f32>(range.x), select(more, less, b < zero), a < zero);
    let none = any((a == zero) & (b < zero));
    let hi = min(range.y, min(most.x, min(most.y, most.z)));
    let lo = max(range.x, max(least.x, max(least.y, least.z)));
    return vec2<f32>(lo, select(hi, -1.0, none));
}

// Half-size of the bundle about its central ray at t, component by component; convex in t.
fn bundle_half_size(node: Node, s: f32, t: f32) -> vec3<f32> {
    return abs(node.px + s * t * node.dx) + abs(node.py + s * t * node.dy) + vec3<f32>(node.r_p + t * node.r_d);
}

// Beyond this t the product of two scene-sized numbers may overflow f32: no refinement there.
const T_REFINE: f32 = 1e15;

// Each narrows the range of t; after two hardly anything more is culled.
const REFINEMENTS: u32 = 2u;

// The half of the rays with t of the sign s; range is that of s t.
fn half_meets(node: Node, s: f32, range: vec2<f32>, centre: vec3<f32>, half: vec3<f32>) -> bool {
    let q = node.p - centre;
    let d = s * node.d;
    // origins and directions bounded separately
    let r0 = half + abs(node.px) + abs(node.py) + vec3<f32>(node.r_p);
    let r1 = abs(node.dx) + abs(node.dy) + vec3<f32>(node.r_d);
    let coarse = slab(q, d, r0, r1, range);
    if coarse.x > coarse.y {
        return false;
    }
    if coarse.y > T_REFINE {
        return true;
    }
    // together: where the spread is largest in that range; once more in the range that this leaves
    var range_left = coarse;
    for (var k = 0u; k < REFINEMENTS && range_left.x <= range_left.y; k++) {
        let r = half + max(bundle_half_size(node, s, range_left.x), bundle_half_size(node, s, range_left.y));
        range_left = slab(q, d, r, vec3<f32>(0.0), range_left);
    }
    return range_left.x <= range_left.y;
}

fn node_meets(node: Node, centre: vec3<f32>, half: vec3<f32>) -> bool {
    if node.rays == RAYS_NONE {
        return false;
    }
    let lo = params.t_min.x;
    let hi = params.t_max.x;
    // what is moved to an end of t_range lies so near to it
    let reach = half + END_BOUND * params.scene_size;
    if hi >= 0.0 && half_meets(node, 1.0, vec2<f32>(max(lo, 0.0), hi), centre, reach) {
        return true;
    }
    return lo < 0.0 && half_meets(node, -1.0, vec2<f32>(max(-hi, 0.0), -lo), centre, reach);
}
