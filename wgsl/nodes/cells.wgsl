// From a pixel to its cell.

#import nodes/slabs.wgsl
#import nodes/tables.wgsl
#import shared/params.wgsl

// The cell of a pixel of the band in a layer's first slab; NONE: no piece owns it.
fn pixel_cell(layer: u32, x: u32, y: u32) -> u32 {
    var row = y / TILE;
    if SLABBED {
        row += layer * params.spans * params.slab_rows;
    }
    let tile = row * params.tiles_x + x / TILE;
    let bit = (y % TILE) * TILE + x % TILE;
    for (var k = tile_start[tile]; k < tile_start[tile + 1u]; k++) {
        let mask = select(cells[k].mask_lo, cells[k].mask_hi, bit >= 32u);
        if (mask & (1u << (bit & 31u))) != 0u {
            return k;
        }
    }
    return NONE;
}
