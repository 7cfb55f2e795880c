// What f32 does not prove, left to recheck.

#import shared/params.wgsl
#import shared/places.wgsl

var<storage, read_write> recheck_items: array<vec2<u32>>;

// An item for each of some pixels of a tile, bit 8 y + x, 32 from `first` on: the triangle's slot; the tile, and in the low 6 bits the pixel.
fn leave_to_recheck(slot: u32, tile: u32, first: u32, uncertain: u32) {
    var left = uncertain;
    loop {
        if left == 0u {
            break;
        }
        let at = take_places(COUNT_RECHECK_ITEMS, 1u);
        if at < params.recheck_capacity {
            recheck_items[at] = vec2<u32>(slot, (tile << 6u) | (first + firstTrailingBit(left)));
        }
        left &= left - 1u;
    }
}
