// Sheets: copies of the band's tiles stacked below each other, one for each layer of a chain, or for each span of t of a
// layer of curves.
// Provides: SHEETED, tile_corner, tile_layer, tile_sheet
// Needs: TILE
// Binds: params

override SHEETED: bool = false;

// The band pixel in the upper left of a tile.
fn tile_corner(tile: u32) -> vec2<u32> {
    var row = tile / params.tiles_x;
    if SHEETED {
        row %= params.sheet_rows;
    }
    return vec2<u32>(tile % params.tiles_x, row) * TILE;
}

fn tile_sheet(tile: u32) -> u32 {
    return select(0u, tile / params.tiles_x / params.sheet_rows, SHEETED);
}

// The layer that a tile's sheet belongs to.
fn tile_layer(tile: u32) -> u32 {
    return tile_sheet(tile) / params.spans;
}
