// The order of hits in f32; its rounding is at most one step. Never 0.

#import nodes/slabs.wgsl

fn nearness(layer: u32, t: f32) -> u32 {
    let bits = bitcast<u32>(t);
    let ordered = select(bits | 0x80000000u, ~bits, (bits & 0x80000000u) != 0u);
    // of t in [0, 1] the first two bits are always 10
    return select(ordered, (layer << 28u) | max((ordered & 0x3fffffffu) >> 2u, 1u), SLABBED);
}
