// A visibility key, low word first: the ordered bits of t, cut off where the triangle id begins. The smaller key is
// the nearer hit, and of equal ones the smaller id.

fn visibility_key(t: real, id: u32) -> vec2<u32> {
    let bits = ordered_bits(t);
    return vec2<u32>((bits.x & ~((1u << params.id_bits) - 1u)) | id, bits.y);
}

fn key_id(key: vec2<u32>) -> u32 {
    return key.x & ((1u << params.id_bits) - 1u);
}

// t to within 2^-24: an id of 28 bits leaves that many of an f64's mantissa. The middle of what the id cut off.
fn key_t(key: vec2<u32>) -> f32 {
    let id_mask = (1u << params.id_bits) - 1u;
    return from_ordered_bits(vec2<u32>((key.x & ~id_mask) | (id_mask ^ (id_mask >> 1u)), key.y));
}
