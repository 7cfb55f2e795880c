// Slabs: copies of the band's tiles stacked below each other, one for each layer of a chain, or for each span of t of a
// layer of curves.

#import shared/params.wgsl

override SLABBED: bool = false;

// The band pixel in the upper left of a tile.
fn tile_corner(tile: u32) -> vec2<u32> {
    var row = tile / params.tiles_x;
    if SLABBED {
        row %= params.slab_rows;
    }
    return vec2<u32>(tile % params.tiles_x, row) * TILE;
}

fn tile_slab(tile: u32) -> u32 {
    return select(0u, tile / params.tiles_x / params.slab_rows, SLABBED);
}

// The layer that a tile's slab belongs to.
fn tile_layer(tile: u32) -> u32 {
    return tile_slab(tile) / params.spans;
}
