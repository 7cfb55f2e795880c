// Sets of 128 items, low word first.
// Provides: first_of, long_bit, without_first

// The set of the n-th item.
fn long_bit(n: u32) -> vec4<u32> {
    return select(vec4<u32>(0u), vec4<u32>(1u << (n & 31u)), vec4<u32>(0u, 1u, 2u, 3u) == vec4<u32>(n >> 5u));
}

// The first of a set that is not empty.
fn first_of(bits: vec4<u32>) -> u32 {
    let low = select(32u + firstTrailingBit(bits.y), firstTrailingBit(bits.x), bits.x != 0u);
    let high = select(96u + firstTrailingBit(bits.w), 64u + firstTrailingBit(bits.z), bits.z != 0u);
    return select(high, low, (bits.x | bits.y) != 0u);
}

fn without_first(bits: vec4<u32>) -> vec4<u32> {
    let x = bits.x & (bits.x - 1u);
    let y = select(bits.y, bits.y & (bits.y - 1u), bits.x == 0u);
    let z = select(bits.z, bits.z & (bits.z - 1u), (bits.x | bits.y) == 0u);
    let w = select(bits.w, bits.w & (bits.w - 1u), (bits.x | bits.y | bits.z) == 0u);
    return vec4<u32>(x, y, z, w);
}
