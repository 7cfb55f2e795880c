// The arithmetic of rechecks, depths and shading: f64.
alias real = f64;
alias real3 = vec3<f64>;
alias real4 = vec4<f64>;

// Rounding of a stored pair hi + lo of f32, relative: 2^-48.
const REAL_UNIT: real = 3.5527136788005009e-15;

// Its square root: how far a double root is off, 2^-24.
const REAL_UNIT_ROOT: real = 5.9604644775390625e-8;

// Rounding of one operation, relative: 2^-53.
const REAL_ROUNDING: real = 1.1102230246251565e-16;

// Within this many times the bound on its distance from the ray a vertex counts as on it: of two edges at it that are
// further from parallel than some six times the inverse, at most one is unproven beyond.
const AT_RAY: real = 1024.0;

// The bits of a number, low word first.
fn words_of(t: real) -> vec2<u32> {
    let bits = bitcast<u64>(t);
    return vec2<u32>(u32(bits & 0xfffffffflu), u32(bits >> 32u));
}

fn of_words(w: vec2<u32>) -> real {
    return bitcast<f64>((u64(w.y) << 32u) | u64(w.x));
}

// The bits of a number such that larger numbers have larger bits, high word second; +0 and -0 alike.
fn ordered_bits(t: real) -> vec2<u32> {
    var w = words_of(t);
    if w.y == 0x80000000u && w.x == 0u {
        w.y = 0u;
    }
    if (w.y & 0x80000000u) != 0u {
        return ~w;
    }
    return vec2<u32>(w.x, w.y | 0x80000000u);
}

// The number of which these are the ordered bits, as f32.
fn from_ordered_bits(bits: vec2<u32>) -> f32 {
    return f32(of_words(select(~bits, vec2<u32>(bits.x, bits.y & 0x7fffffffu), (bits.y & 0x80000000u) != 0u)));
}
