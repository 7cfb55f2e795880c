// Rays of the samples of a camera made of pieces.

#import arithmetic
#import rays/affine_bundle.wgsl
#import rays/pieces/bundle.wgsl
#import samples/offsets.wgsl
#import shared/params.wgsl

// The bundle of a sample of a cell whose bundle is `whole`; (x, y) of its pixel in the tile.
fn sample_bundle(whole: Bundle, cell: Cell, x: u32, y: u32, sample: u32) -> Bundle {
    let place = sample_offset(sample);
    return bundle_at(whole, real(f32(x) - TILE_REACH) + real(place.x), real(f32(y) - TILE_REACH) + real(place.y));
}
