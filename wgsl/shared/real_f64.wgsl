// The arithmetic of rechecks, depths and shading: f64.
alias real = f64;
alias real3 = vec3<f64>;

// Rounding of a stored pair hi + lo of f32, relative: 2^-48.
const REAL_UNIT: real = 3.5527136788005009e-15;

// The bits of a number such that larger numbers have larger bits, high word second; +0 and -0 alike.
fn ordered_bits(t: real) -> vec2<u32> {
    let bits = bitcast<u64>(t);
    var w = vec2<u32>(u32(bits & 0xfffffffflu), u32(bits >> 32u));
    if w.y == 0x80000000u && w.x == 0u {
        w.y = 0u;
    }
    if (w.y & 0x80000000u) != 0u {
        return ~w;
    }
    return vec2<u32>(w.x, w.y | 0x80000000u);
}
