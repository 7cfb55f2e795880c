// Bits that ascend with a number.

fn rising_bits(t: f32) -> u32 {
    let w = bitcast<u32>(t);
    return select(w | 0x80000000u, ~w, (w & 0x80000000u) != 0u);
}
