// What four pixels of a tile see, of triangles whose t is found in recheck arithmetic at once.

#import arithmetic
#import depth/column
#import depth/edges.wgsl
#import depth/exact/test.wgsl
#import depth/test
#import keys/merge
#import lanes/together.wgsl
#import nodes/slabs.wgsl
#import raster_by_tile.wgsl
#import shared/params.wgsl
#import vertices/still/vertex.wgsl

// The largest sum of absolute components of the lines' cross products.
alias Reach = f32;

fn tile_reach(column: Column, upper: Lines, lower: Lines, lane: u32) -> Reach {
    return lanes_max(max(reach_of(upper), reach_of(lower)), lane);
}

// What the lanes will share of a triangle, the first words of whose corners are hi.
fn triangle_shared(slot: u32, triangle: vec4<u32>, hi: array<vec3<f32>, 3>, node: Node, reach_q: Reach) -> Shared {
    let v0 = real3(hi[0]) + real3(vertex_lo(triangle.x));
    let v1 = real3(hi[1]) + real3(vertex_lo(triangle.y));
    let v2 = real3(hi[2]) + real3(vertex_lo(triangle.z));
    let reach = max(size(hi[0]), max(size(hi[1]), size(hi[2]))) + size(node.p);
    return shared_of(triangle, v0, v1, v2, real3(node.p), reach, reach_q);
}

// 2^-24 of a key's t, and rounding it to f32 and once more.
const KEY_TOLERANCE: f32 = 1.0 / 4194304.0;

// No t of four pixels' nearest is larger: of none without a ray. A key is off by the bits that the id takes, 2^-24 of t at most.
fn farthest(nearest: Nearest, s: Strip, exists: vec4<bool>) -> f32 {
    let t = select(vec4<f32>(-INFINITE), vec4<f32>(min(nearest.keys, real4(real(INFINITE)))), exists);
    let most = max(max(t.x, t.y), max(t.z, t.w));
    return most + KEY_TOLERANCE * abs(most);
}

// Merges the nearest of a column of a tile. How many of them recheck will count: none.
fn keep_nearest(tile: u32, lane: u32, pixels: vec4<u32>, upper: Nearest, lower: Nearest) -> u32 {
    let layer = tile_layer(tile);
    for (var k = 0u; k < 4u; k++) {
        merge_some(pixels[k], complemented_key(layer, upper.keys[k]));
        merge_some(pixels[k] + 4u * params.width, complemented_key(layer, lower.keys[k]));
    }
    return 0u;
}

fn merge_some(pixel: u32, key: vec2<u32>) {
    if any(key != vec2<u32>(0u)) {
        merge(pixel, key);
    }
}
