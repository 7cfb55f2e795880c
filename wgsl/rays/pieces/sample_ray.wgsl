// The rays of samples of a camera made of pieces.

#import nodes/slabs.wgsl
#import nodes/tables.wgsl
#import rays/pieces/bundle.wgsl
#import rays/pieces/pixel.wgsl
#import rays/ray.wgsl
#import samples/cells.wgsl
#import samples/offsets.wgsl
#import shared/bits.wgsl
#import shared/params.wgsl

fn sample_ray(layer: u32, x: u32, y: u32, sample: u32) -> Ray {
    return cell_ray_at(cells[sample_cell(layer, x, y, sample)], place_in_tile(x, y, sample));
}

fn sample_differential(layer: u32, x: u32, y: u32, sample: u32, t: f32) -> RayDifferential {
    return cell_differential(cells[sample_cell(layer, x, y, sample)], place_in_tile(x, y, sample), t);
}

fn place_in_tile(x: u32, y: u32, sample: u32) -> vec2<f32> {
    return vec2<f32>(f32(x % TILE), f32(y % TILE)) - TILE_REACH + sample_offset(sample);
}

// The cell of a sample's piece.
fn sample_cell(layer: u32, x: u32, y: u32, sample: u32) -> u32 {
    var row = y / TILE;
    if SLABBED {
        row += layer * params.spans * params.slab_rows;
    }
    let tile = row * params.tiles_x + x / TILE;
    let own = bit_mask((y % TILE) * TILE + x % TILE);
    var k = tile_start[tile];
    for (; k + 1u < tile_start[tile + 1u]; k++) {
        if any((pixels_of_sample(k, sample) & own) != vec2<u32>(0u)) {
            break;
        }
    }
    return k;
}
