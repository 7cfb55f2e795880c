// Raster takes tiles one by one, and leaves out what their own bounds do.
//
// Lists of pairs by tile: `heads` has each tile's first pair and `links` each pair's next one, both with 1 added and 0 behind the last;
// `busy` has the tiles with any.

fn tile_pixels(tile: u32, above: Node, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>, pixels: vec4<u32>) -> vec4<u32> {
    return pixels;
}

fn link(pair: u32, tile: u32) {
    let before = atomicExchange(&heads[tile], pair + 1u);
    links[pair] = before;
    if before == 0u {
        busy[atomicAdd(&counters[COUNT_BUSY], 1u)] = tile;
    }
}
