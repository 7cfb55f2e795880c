// Straight rays: the pixels whose three signs f32 does not prove.

// The pixels that are covered: those proven, and of those in doubt, the third and fourth words, the ones that are after all.
fn settled(cell: Cell, whole: Bundle, found: vec4<u32>, v0: real3, v1: real3, v2: real3) -> vec2<u32> {
    var covered = found.xy;
    var doubtful = found.zw;
    var rechecked = 0u;
    loop {
        let bit = first_bit(doubtful);
        if bit == NONE {
            break;
        }
        doubtful = without_bit(doubtful, bit);
        rechecked++;
        let b = pixel_bundle(whole, cell, bit % TILE, bit / TILE);
        let s01 = edge_side(b, v0, v1);
        if s01 == -edge_side(b, v0, v2) && s01 == edge_side(b, v1, v2) {
            covered = with_bit(covered, bit);
        }
    }
    if rechecked > 0u && step.value == 0u {
        atomicAdd(&counters[COUNT_RECHECKED], rechecked);
    }
    return covered;
}
