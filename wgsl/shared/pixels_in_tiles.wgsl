// Items are the pixels of the tiles, tile by tile, row by row in each: some lie outside the band.

fn place_of(item: u32) -> vec2<u32> {
    let tile = item / (TILE * TILE);
    let corner = vec2<u32>(tile % params.tiles_x, tile / params.tiles_x) * TILE;
    return corner + vec2<u32>(item % TILE, item / TILE % TILE);
}
