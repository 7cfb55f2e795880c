// Raster by pair, in any order: bin culls by the tile's own bounds.

#import nodes/box_met.wgsl
#import nodes/conics.wgsl
#import nodes/extent.wgsl
#import nodes/slabs.wgsl
#import nodes/within.wgsl
#import shared/params.wgsl

var<storage, read> nodes: array<Node>;
var<storage, read_write> pairs: array<vec2<u32>>;

// The pixels of a tile that the triangle may cover, of those that the bounds of a node above it leave.
fn tile_pixels(tile: u32, above: Node, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>, pixels: vec4<u32>) -> vec4<u32> {
    if above.rays == RAYS_AFFINE {
        return pixels;
    }
    let leaf = nodes[tile];
    let seen = extent(leaf, v0, v1, v2);
    let within = pixels_within(seen, TILE, SAMPLE_REACH);
    let left = vec4<u32>(max(pixels.xy, within.xy), min(pixels.zw, within.zw));
    if leaf.rays == RAYS_NONE || is_empty(left) || !may_cover(conics(leaf, v0, v1, v2), 0.0, 0.0, CENTRES + SAMPLE_REACH * NODE_PX) {
        return vec4<u32>(0u);
    }
    // in a slab t ends soon: the triangle may lie before its start or beyond its end
    if SLABBED && !seen.tight && !box_met(leaf, v0, v1, v2) {
        return vec4<u32>(0u);
    }
    return left;
}

fn store(at: u32, tile: u32, pair: vec2<u32>) {
    pairs[at] = pair;
}
