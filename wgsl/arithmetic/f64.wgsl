// The arithmetic of rechecks, depths and shading: f64.

alias real = f64;
alias real3 = vec3<f64>;
alias real4 = vec4<f64>;

// Rounding of a stored pair hi + lo of f32, relative: 2^-48.
const REAL_UNIT: real = 3.5527136788005009e-15;

// Its square root: how far a double root is off, 2^-24.
const REAL_UNIT_ROOT: real = 5.9604644775390625e-8;

// Size of a perturbation, relative to the scene's: 2^-42.
const PERTURB: real = 2.2737367544323206e-13;

// Rounding of one operation, relative: 2^-53.
const REAL_ROUNDING: real = 1.1102230246251565e-16;

// The bits of a number, low word first.
fn real_to_bits(t: real) -> vec2<u32> {
    let bits = bitcast<u64>(t);
    return vec2<u32>(u32(bits & 0xfffffffflu), u32(bits >> 32u));
}

fn real_from_bits(w: vec2<u32>) -> real {
    return bitcast<f64>((u64(w.y) << 32u) | u64(w.x));
}

// Rounded to the 24 bits of f32, ties away from 0.
fn round_to_f32(t: real) -> real {
    let w = real_to_bits(t);
    let low = w.x + 0x10000000u;
    return real_from_bits(vec2<u32>(low & 0xe0000000u, w.y + select(0u, 1u, low < w.x)));
}

// The bits of a number such that larger numbers have larger bits, high word second; +0 and -0 alike.
fn ordered_bits(t: real) -> vec2<u32> {
    var w = real_to_bits(t);
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
    return f32(real_from_bits(select(~bits, vec2<u32>(bits.x, bits.y & 0x7fffffffu), (bits.y & 0x80000000u) != 0u)));
}

// A product, exactly: its sign, 106 bits of which the first is 1 in four digits of 28, lowest first, and their exponent.
struct Product {
    sign: i32,
    exponent: i32,
    digits: vec4<u32>,
}

fn product_of(a: real, b: real) -> Product {
    let x = real_to_bits(a);
    let y = real_to_bits(b);
    let ex = (x.y >> 20u) & 0x7ffu;
    let ey = (y.y >> 20u) & 0x7ffu;
    if ex == 0u || ey == 0u {
        return Product(0, 0, vec4<u32>(0u));
    }
    // four limbs of 14 bits each; sums of four products at most and a carry stay below 2^32
    let hx = (x.y & 0xfffffu) | 0x100000u;
    let hy = (y.y & 0xfffffu) | 0x100000u;
    let u = vec4<u32>(x.x, x.x >> 14u, (x.x >> 28u) | (hx << 4u), hx >> 10u) & vec4<u32>(0x3fffu);
    let v = vec4<u32>(y.x, y.x >> 14u, (y.x >> 28u) | (hy << 4u), hy >> 10u) & vec4<u32>(0x3fffu);
    let c0 = u.x * v.x;
    let c1 = u.x * v.y + u.y * v.x + (c0 >> 14u);
    let c2 = u.x * v.z + u.y * v.y + u.z * v.x + (c1 >> 14u);
    let c3 = u.x * v.w + u.y * v.z + u.z * v.y + u.w * v.x + (c2 >> 14u);
    let c4 = u.y * v.w + u.z * v.z + u.w * v.y + (c3 >> 14u);
    let c5 = u.z * v.w + u.w * v.z + (c4 >> 14u);
    let c6 = u.w * v.w + (c5 >> 14u);
    let even = vec4<u32>(c0, c2, c4, c6) & vec4<u32>(0x3fffu);
    var digits = even | (vec4<u32>(c1 & 0x3fffu, c3 & 0x3fffu, c5 & 0x3fffu, c6 >> 14u) << vec4<u32>(14u));
    // bit 105 is the last one's bit 21
    let short = select(1u, 0u, (digits.w & 0x200000u) != 0u);
    let carry = vec4<u32>(0u, digits.xyz >> vec3<u32>(27u)) * short;
    digits = ((digits << vec4<u32>(short)) & vec4<u32>(0xfffffffu)) | carry;
    let sign = select(1, -1, ((x.y ^ y.y) & 0x80000000u) != 0u);
    return Product(sign, i32(ex + ey) - i32(short), digits);
}

// The sign of a b - c d, exactly.
fn order_of_products(a: real, b: real, c: real, d: real) -> i32 {
    let p = product_of(a, b);
    let q = product_of(c, d);
    if p.sign != q.sign || p.sign == 0 {
        return sign(p.sign - q.sign);
    }
    var order = sign(p.exponent - q.exponent);
    for (var k = 0u; k < 4u; k++) {
        if order == 0 {
            order = sign(i32(p.digits[3u - k]) - i32(q.digits[3u - k]));
        }
    }
    return p.sign * order;
}
