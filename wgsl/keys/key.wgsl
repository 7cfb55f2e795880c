// A visibility key, low word first: the ordered bits of t, cut off where the triangle id begins. The smaller key is
// the nearer hit, and of equal ones the smaller id. With slabs the layer comes before t, in the top 4 bits.

#import arithmetic
#import nodes/slabs.wgsl
#import shared/params.wgsl

fn visibility_key(layer: u32, t: real, id: u32) -> vec2<u32> {
    return key_above(layer, t, id, (1u << params.id_bits) - 1u);
}

// The same, with the bits that the id takes: a loop that calls it loads them once.
fn key_above(layer: u32, t: real, id: u32, id_mask: u32) -> vec2<u32> {
    var bits = ordered_bits(t);
    if SLABBED {
        // t in [0, 1] has ordered bits that begin with 10: these two go, the layer's four come
        bits = vec2<u32>((bits.x >> 2u) | (bits.y << 30u), ((bits.y & 0x3fffffffu) >> 2u) | (layer << 28u));
    }
    return vec2<u32>((bits.x & ~id_mask) | id, bits.y);
}

fn key_id(key: vec2<u32>) -> u32 {
    return key.x & ((1u << params.id_bits) - 1u);
}

fn key_layer(key: vec2<u32>) -> u32 {
    return select(0u, key.y >> 28u, SLABBED);
}

// t to within 2^-24: an id of 28 bits leaves that many of an f64's mantissa, two fewer with slabs. The middle of what
// the id cut off.
fn key_t(key: vec2<u32>) -> f32 {
    let id_mask = (1u << params.id_bits) - 1u;
    var bits = vec2<u32>((key.x & ~id_mask) | (id_mask ^ (id_mask >> 1u)), key.y);
    if SLABBED {
        bits = vec2<u32>(bits.x << 2u, ((bits.y & 0x0fffffffu) << 2u) | (bits.x >> 30u) | 0x80000000u);
    }
    return from_ordered_bits(bits);
}
