// The arithmetic of rechecks, depths and shading: f32, of frames in f32 alone.
alias real = f32;
alias real3 = vec3<f32>;
alias real4 = vec4<f32>;

// Its square root: how far a double root is off, 2^-12.
const REAL_UNIT_ROOT: real = 2.44140625e-4;

// Rounding of one operation, relative: 2^-24.
const REAL_UNIT: real = 5.9604645e-8;

// Rounding of one operation, relative: 2^-24.
const REAL_ROUNDING: real = 5.9604645e-8;

// The number nearest to an f64 within f32's range, by its bits, low word first.
fn of_words(w: vec2<u32>) -> real {
    let exponent = (w.y >> 20u) & 0x7ffu;
    let size = ((exponent - 896u) << 23u) + ((w.y & 0xfffffu) << 3u) + (w.x >> 29u) + ((w.x >> 28u) & 1u);
    return bitcast<f32>((w.y & 0x80000000u) | select(size, 0u, exponent <= 896u));
}

// The bits of a number such that larger numbers have larger bits, high word second; +0 and -0 alike.
fn ordered_bits(t: real) -> vec2<u32> {
    var w = bitcast<u32>(t);
    if w == 0x80000000u {
        w = 0u;
    }
    return vec2<u32>(0u, select(w | 0x80000000u, ~w, (w & 0x80000000u) != 0u));
}

// The number of which these are the ordered bits.
fn from_ordered_bits(bits: vec2<u32>) -> f32 {
    return bitcast<f32>(select(~bits.y, bits.y & 0x7fffffffu, (bits.y & 0x80000000u) != 0u));
}

// The sign of a b - c d: within its rounding, none.
fn order_of_products(a: real, b: real, c: real, d: real) -> i32 {
    return 0;
}
