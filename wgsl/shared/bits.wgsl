// Sets of the 64 pixels of a tile: bit 8 y + x, low word first.

#import shared/params.wgsl

// The pixels of a box within a tile.
fn box_mask(from_px: vec2<u32>, to_px: vec2<u32>) -> vec2<u32> {
    let row = ((2u << to_px.x) - 1u) & ~((1u << from_px.x) - 1u);
    let rows = ((2u << to_px.y) - 1u) & ~((1u << from_px.y) - 1u);
    return vec2<u32>(rows_mask(row, rows & 15u), rows_mask(row, rows >> 4u));
}

// Four rows of eight pixels: `row` in each that `rows` names.
fn rows_mask(row: u32, rows: u32) -> u32 {
    // bit k of rows to bit 8 k, then the row's bits over each
    return (((rows & 1u) | ((rows & 2u) << 7u) | ((rows & 4u) << 14u) | ((rows & 8u) << 21u))) * row;
}

fn first_bit(mask: vec2<u32>) -> u32 {
    if mask.x != 0u {
        return firstTrailingBit(mask.x);
    }
    return select(32u + firstTrailingBit(mask.y), NONE, mask.y == 0u);
}

fn bit_mask(bit: u32) -> vec2<u32> {
    let one = 1u << (bit & 31u);
    return select(vec2<u32>(one, 0u), vec2<u32>(0u, one), bit >= 32u);
}

fn with_bit(mask: vec2<u32>, bit: u32) -> vec2<u32> {
    return mask | bit_mask(bit);
}

fn without_bit(mask: vec2<u32>, bit: u32) -> vec2<u32> {
    return mask & ~bit_mask(bit);
}
