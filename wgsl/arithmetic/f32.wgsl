// The arithmetic of rechecks, depths and shading: f32, of frames in f32 alone.

alias real = f32;
alias real3 = vec3<f32>;
alias real4 = vec4<f32>;

// Rounding of a stored number, relative: 2^-24.
const REAL_UNIT: real = 5.9604645e-8;

// Its square root: how far a double root is off, 2^-12.
const REAL_UNIT_ROOT: real = 2.44140625e-4;

// Rays are not perturbed: a perturbation is far below the rounding of f32.
const PERTURB: real = 0.0;

// Rounding of one operation, relative: 2^-24.
const REAL_ROUNDING: real = 5.9604645e-8;

// The number nearest to an f64 within f32's range, by its bits, low word first.
fn real_from_bits(w: vec2<u32>) -> real {
    let exponent = (w.y >> 20u) & 0x7ffu;
    let size = ((exponent - 896u) << 23u) + ((w.y & 0xfffffu) << 3u) + (w.x >> 29u) + ((w.x >> 28u) & 1u);
    return bitcast<f32>((w.y & 0x80000000u) | select(size, 0u, exponent <= 896u));
}

// An f32 is its own rounding.
fn round_to_f32(t: real) -> real {
    return t;
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

// A product, exactly: its sign, 48 bits of which the first is 1 in two digits of 24, lowest first, and their exponent.
struct Product {
    sign: i32,
    exponent: i32,
    digits: vec2<u32>,
}

fn product_of(a: real, b: real) -> Product {
    let x = bitcast<u32>(a);
    let y = bitcast<u32>(b);
    let ex = (x >> 23u) & 0xffu;
    let ey = (y >> 23u) & 0xffu;
    if ex == 0u || ey == 0u {
        return Product(0, 0, vec2<u32>(0u));
    }
    // two limbs of 12 bits each
    let u = vec2<u32>(x, (x | 0x800000u) >> 12u) & vec2<u32>(0xfffu);
    let v = vec2<u32>(y, (y | 0x800000u) >> 12u) & vec2<u32>(0xfffu);
    let c1 = u.x * v.y + u.y * v.x + ((u.x * v.x) >> 12u);
    var digits = vec2<u32>(((c1 & 0xfffu) << 12u) | ((u.x * v.x) & 0xfffu), u.y * v.y + (c1 >> 12u));
    let short = select(1u, 0u, (digits.y & 0x800000u) != 0u);
    let carry = (digits.x >> 23u) * short;
    digits = (digits << vec2<u32>(short)) & vec2<u32>(0xffffffu);
    digits.y |= carry;
    return Product(select(1, -1, ((x ^ y) & 0x80000000u) != 0u), i32(ex + ey) - i32(short), digits);
}

// The sign of a b - c d, exactly.
fn order_of_products(a: real, b: real, c: real, d: real) -> i32 {
    let p = product_of(a, b);
    let q = product_of(c, d);
    if p.sign != q.sign || p.sign == 0 {
        return sign(p.sign - q.sign);
    }
    var order = sign(p.exponent - q.exponent);
    order = select(order, sign(i32(p.digits.y) - i32(q.digits.y)), order == 0);
    order = select(order, sign(i32(p.digits.x) - i32(q.digits.x)), order == 0);
    return p.sign * order;
}
