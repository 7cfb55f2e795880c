// Sets of 64 items, low word first.

// The set of the n-th item.
fn long_bit(n: u32) -> vec2<u32> {
    return select(vec2<u32>(0u, 1u << (n & 31u)), vec2<u32>(1u << (n & 31u), 0u), n < 32u);
}

// The first of a set that is not empty.
fn first_of(bits: vec2<u32>) -> u32 {
    return select(32u + firstTrailingBit(bits.y), firstTrailingBit(bits.x), bits.x != 0u);
}

fn without_first(bits: vec2<u32>) -> vec2<u32> {
    return vec2<u32>(bits.x & (bits.x - 1u), select(bits.y, bits.y & (bits.y - 1u), bits.x == 0u));
}
