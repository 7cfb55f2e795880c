// A pair: the triangle's slot (28 bits), the tile (24 bits), and the first and last column and row there that the triangle
// may cover (3 bits each).

fn pair_pack(slot: u32, tile: u32, from_px: vec2<u32>, to_px: vec2<u32>) -> vec2<u32> {
    return vec2<u32>(
        slot | ((from_px.x | ((to_px.x & 1u) << 3u)) << 28u),
        tile | (((to_px.x >> 1u) | (from_px.y << 2u) | (to_px.y << 5u)) << 24u),
    );
}

fn pair_slot(pair: vec2<u32>) -> u32 {
    return pair.x & 0x0fffffffu;
}

fn pair_tile(pair: vec2<u32>) -> u32 {
    return pair.y & 0x00ffffffu;
}

fn pair_from(pair: vec2<u32>) -> vec2<u32> {
    return vec2<u32>((pair.x >> 28u) & 7u, (pair.y >> 26u) & 7u);
}

fn pair_to(pair: vec2<u32>) -> vec2<u32> {
    return vec2<u32>((pair.x >> 31u) | (((pair.y >> 24u) & 3u) << 1u), pair.y >> 29u);
}
