// Raster by tile: raster culls by the tile's own bounds. Pairs are sorted by tile first.

#import shared/params.wgsl

var<storage, read_write> ends: array<atomic<u32>>;
var<storage, read_write> ranks: array<u32>;
var<storage, read_write> unsorted: array<vec2<u32>>;

fn tile_pixels(tile: u32, above: Node, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>, pixels: vec4<u32>) -> vec4<u32> {
    return pixels;
}

// Stores a pair, and its rank among those of its tile.
fn store(at: u32, tile: u32, pair: vec2<u32>) {
    unsorted[at] = pair;
    ranks[at] = atomicAdd(&ends[tile], 1u);
}
