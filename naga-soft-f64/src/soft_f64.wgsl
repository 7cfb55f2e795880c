// f64 without f64: IEEE 754's binary64 in two u32, low word first, rounded to nearest, ties to even. Two things are left out: numbers
// below 2^-1022 count as 0, and one NaN stands for all.
//
// Between operations a number is sign, exponent and 64 bits of which the first is 1: 53 stay, 10 are for the rounding, and the
// last stands for everything below it.
//
// No branches: these functions stand in a kernel hundreds of times, and `&&` and `||` are branches.
//
// Only loops of two to four rounds, whose number is a constant: drivers unroll such. All others of an invocation lavapipe ends
// after 65,535 rounds together, without a word.

const SIGN: u32 = 0x80000000u;
const INFINITE: u32 = 0x7ff00000u;
const NAN: vec2<u32> = vec2<u32>(0u, 0x7ff80000u);
const NOUGHT: vec2<u32> = vec2<u32>(0u, 0u);

fn exponent_of(a: vec2<u32>) -> i32 {
    return i32((a.y >> 20u) & 0x7ffu);
}

// The 53 bits of a number, its first at bit 52; of what counts as 0 none.
fn mantissa_of(a: vec2<u32>) -> vec2<u32> {
    return select(vec2<u32>(a.x, (a.y & 0xfffffu) | 0x100000u), NOUGHT, (a.y & INFINITE) == 0u);
}

fn is_nan(a: vec2<u32>) -> bool {
    let high = a.y & ~SIGN;
    return (high > INFINITE) | ((high == INFINITE) & (a.x != 0u));
}

// n in 0 .. 31.
fn shifted_left(m: vec2<u32>, n: u32) -> vec2<u32> {
    return vec2<u32>(m.x << n, (m.y << n) | ((m.x >> 1u) >> (31u - n)));
}

// Any n; what falls off stands in the last bit.
fn shifted_right(m: vec2<u32>, n: u32) -> vec2<u32> {
    let whole = n >= 32u;
    let words = select(m, vec2<u32>(m.y, 0u), whole);
    let rest = select(0u, m.x, whole);
    let part = min(n - select(0u, 32u, whole), 31u);
    let lost = rest | (words.x & ((1u << part) - 1u));
    return vec2<u32>((words.x >> part) | ((words.y << 1u) << (31u - part)) | select(0u, 1u, lost != 0u), words.y >> part);
}

// Up to the first 1, of 64 bits that are not all 0.
fn leading_zeros(m: vec2<u32>) -> u32 {
    return select(countLeadingZeros(m.y), 32u + countLeadingZeros(m.x), m.y == 0u);
}

fn sum(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let low = a.x + b.x;
    return vec2<u32>(low, a.y + b.y + select(0u, 1u, low < a.x));
}

fn difference(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    return vec2<u32>(a.x - b.x, a.y - b.y - select(0u, 1u, a.x < b.x));
}

fn is_below(a: vec2<u32>, b: vec2<u32>) -> bool {
    return (a.y < b.y) | ((a.y == b.y) & (a.x < b.x));
}

// The number of that sign and biased exponent whose 64 bits are m, the first of them 1.
fn rounded(sign: u32, exponent: i32, m: vec2<u32>) -> vec2<u32> {
    let low = (m.x >> 11u) | (m.y << 21u);
    let rest = m.x & 0x7ffu;
    let up = select(0u, 1u, (rest > 0x400u) | ((rest == 0x400u) & ((low & 1u) != 0u)));
    let kept = sum(vec2<u32>(low, m.y >> 11u), vec2<u32>(up, 0u));
    // the leading 1, and what is carried beyond it, count in the exponent
    let high = kept.y + (u32(exponent - 1) << 20u);
    let large = (exponent >= 0x7ff) | (high >= INFINITE);
    let size = select(vec2<u32>(kept.x, high), vec2<u32>(0u, INFINITE), large);
    return select(size, NOUGHT, exponent <= 0) | vec2<u32>(0u, sign);
}

fn f64_neg(a: vec2<u32>) -> vec2<u32> {
    return vec2<u32>(a.x, a.y ^ SIGN);
}

fn f64_abs(a: vec2<u32>) -> vec2<u32> {
    return vec2<u32>(a.x, a.y & ~SIGN);
}

fn f64_add(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let swapped = is_below(f64_abs(a), f64_abs(b));
    let large = select(a, b, swapped);
    let small = select(b, a, swapped);
    let exponent = exponent_of(large);
    let below = exponent_of(small);
    let sign = large.y & SIGN;
    let opposed = ((large.y ^ small.y) & SIGN) != 0u;
    // first bits at 62: space for a carry
    let m = shifted_left(mantissa_of(large), 10u);
    let n = shifted_right(shifted_left(mantissa_of(small), 10u), u32(exponent - below));
    let total = select(sum(m, n), difference(m, n), opposed);
    let zeros = leading_zeros(total);
    let whole = select(total, vec2<u32>(0u, total.x), zeros >= 32u);
    var result = rounded(sign, exponent + 1 - i32(zeros), shifted_left(whole, zeros & 31u));
    result = select(result, vec2<u32>(0u, large.y & small.y & SIGN), (total.x | total.y) == 0u);
    let endless = select(large, NAN, is_nan(large) | ((below == 0x7ff) & opposed));
    return select(result, endless, exponent == 0x7ff);
}

fn f64_sub(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    return f64_add(a, f64_neg(b));
}

// 53 bits and three more in four limbs of 14, lowest first.
fn limbs(m: vec2<u32>) -> vec4<u32> {
    let w = shifted_left(m, 3u);
    return vec4<u32>(w.x, w.x >> 14u, (w.x >> 28u) | (w.y << 4u), w.y >> 10u) & vec4<u32>(0x3fffu);
}

fn f64_mul(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let sign = (a.y ^ b.y) & SIGN;
    let ea = exponent_of(a);
    let eb = exponent_of(b);
    // 112 bits: sums of four products at most and a carry stay below 2^32
    let x = limbs(mantissa_of(a));
    let y = limbs(mantissa_of(b));
    let c0 = x.x * y.x;
    let c1 = x.x * y.y + x.y * y.x + (c0 >> 14u);
    let c2 = x.x * y.z + x.y * y.y + x.z * y.x + (c1 >> 14u);
    let c3 = x.x * y.w + x.y * y.z + x.z * y.y + x.w * y.x + (c2 >> 14u);
    let c4 = x.y * y.w + x.z * y.z + x.w * y.y + (c3 >> 14u);
    let c5 = x.z * y.w + x.w * y.z + (c4 >> 14u);
    let c6 = x.w * y.w + (c5 >> 14u);
    let l4 = c4 & 0x3fffu;
    let l5 = c5 & 0x3fffu;
    let rest = select(0u, 1u, ((c0 | c1 | c2 | c3) & 0x3fffu) != 0u);
    let m = vec2<u32>((l5 << 22u) | (l4 << 8u) | rest, (c6 << 4u) | (l5 >> 10u));
    let short = select(1u, 0u, (m.y & SIGN) != 0u);
    let result = rounded(sign, ea + eb - 1022 - i32(short), shifted_left(m, short));
    let is_zero = (ea == 0) | (eb == 0);
    let endless = select(vec2<u32>(0u, sign | INFINITE), NAN, is_nan(a) | is_nan(b) | is_zero);
    return select(select(result, vec2<u32>(0u, sign), is_zero), endless, (ea == 0x7ff) | (eb == 0x7ff));
}

// The next 14 bits of a quotient, and what is left: r 2^14 = digit n + left, r < n, four limbs of 14 bits each, the first
// of n at least 2^13 (Knuth, The Art of Computer Programming 2, 4.3.1, algorithm D).
struct Division {
    digit: u32,
    left: vec4<i32>,
}

fn divided(r: vec4<i32>, n: vec4<i32>) -> Division {
    // too large by 2 at most
    var digit = min((r.w * 16384 + r.z) / n.w, 16383);
    let c0 = -digit * n.x;
    let c1 = r.x - digit * n.y + (c0 >> 14u);
    let c2 = r.y - digit * n.z + (c1 >> 14u);
    let c3 = r.z - digit * n.w + (c2 >> 14u);
    var left = vec4<i32>(c0, c1, c2, c3) & vec4<i32>(0x3fff);
    var top = r.w + (c3 >> 14u);
    for (var k = 0u; k < 2u; k++) {
        let back = select(0, 1, top < 0);
        let d0 = left.x + back * n.x;
        let d1 = left.y + back * n.y + (d0 >> 14u);
        let d2 = left.z + back * n.z + (d1 >> 14u);
        let d3 = left.w + back * n.w + (d2 >> 14u);
        left = vec4<i32>(d0, d1, d2, d3) & vec4<i32>(0x3fff);
        top += d3 >> 14u;
        digit -= back;
    }
    return Division(u32(digit), left);
}

fn f64_div(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let sign = (a.y ^ b.y) & SIGN;
    let ea = exponent_of(a);
    let eb = exponent_of(b);
    // the quotient is below 2: its whole part first, as half of the smaller one's
    let below = is_below(mantissa_of(a), mantissa_of(b));
    // never 0, as this is what is divided by
    let n = vec4<i32>(limbs(select(mantissa_of(b), vec2<u32>(0u, 0x100000u), eb == 0)));
    let r = mantissa_of(a);
    var left = vec4<i32>(limbs(select(difference(r, mantissa_of(b)), r, below)));
    var digits = NOUGHT;
    for (var k = 0u; k < 4u; k++) {
        let next = divided(left, n);
        left = next.left;
        digits = shifted_left(digits, 14u) | vec2<u32>(next.digit, 0u);
    }
    let rest = select(0u, 1u, any(left != vec4<i32>(0)));
    // 56 bits behind the whole part, which has bit 63, or where there is none the first of them
    let m = shifted_left(digits, 8u) | vec2<u32>(rest, 0u);
    let whole = vec2<u32>((m.x >> 1u) | (m.y << 31u) | (m.x & 1u), SIGN | (m.y >> 1u));
    var result = rounded(sign, ea - eb + select(1023, 1022, below), select(whole, m, below));
    result = select(result, vec2<u32>(0u, sign | INFINITE), (eb == 0) | (ea == 0x7ff));
    result = select(result, vec2<u32>(0u, sign), (ea == 0) | (eb == 0x7ff));
    return select(result, NAN, is_nan(a) | is_nan(b) | ((ea == 0) & (eb == 0)) | ((ea == 0x7ff) & (eb == 0x7ff)));
}

fn f64_sqrt(a: vec2<u32>) -> vec2<u32> {
    let e = exponent_of(a);
    // of a number in [1, 4), by Heron's steps from f32's
    let odd = u32(e + 1) & 1u;
    let number = vec2<u32>(a.x, (a.y & 0xfffffu) | ((1023u + odd) << 20u));
    var root = f64_from_f32(sqrt(f32_from_f64(number)));
    for (var k = 0u; k < 2u; k++) {
        root = f64_mul(vec2<u32>(0u, 0x3fe00000u), f64_add(root, f64_div(number, root)));
    }
    // the last bit: number 2^106 less the square of the mantissa's double, which is small, must lie within that double's reach
    let m = mantissa_of(root);
    let x = limbs(m);
    let c0 = x.x * x.x;
    let c1 = 2u * x.x * x.y + (c0 >> 14u);
    let c2 = 2u * x.x * x.z + x.y * x.y + (c1 >> 14u);
    let c3 = 2u * (x.x * x.w + x.y * x.z) + (c2 >> 14u);
    let c4 = 2u * x.y * x.w + x.z * x.z + (c3 >> 14u);
    let l = vec4<u32>(c0, c1, c2, c3) & vec4<u32>(0x3fffu);
    let square = vec2<u32>((l.x >> 4u) | (l.y << 10u) | (l.z << 24u), (l.z >> 8u) | (l.w << 6u) | (c4 << 20u));
    let off = difference(vec2<u32>(0u, a.x << (22u + odd)), square);
    let reach = shifted_left(m, 2u);
    let down = (off.y & SIGN) != 0u;
    let far = select(is_below(reach, off), !is_below(difference(NOUGHT, off), reach), down);
    let step = select(vec2<u32>(0u), select(vec2<u32>(1u, 0u), vec2<u32>(0xffffffffu), down), far);
    let kept = sum(m, step);
    var result = vec2<u32>(kept.x, (kept.y & 0xfffffu) | (u32((e - 1023 - i32(odd)) / 2 + 1023) << 20u));
    result = select(result, a, e == 0x7ff);
    result = select(result, NAN, is_nan(a) | ((a.y & SIGN) != 0u));
    return select(result, vec2<u32>(0u, a.y & SIGN), e == 0);
}

fn f64_lt(a: vec2<u32>, b: vec2<u32>) -> bool {
    let x = f64_value_bits(a);
    let y = f64_value_bits(b);
    let less = select(is_below(x, y), is_below(y, x), (x.y & y.y & SIGN) != 0u);
    return !(is_nan(a) | is_nan(b)) & select(less, (x.y & SIGN) != 0u, ((x.y ^ y.y) & SIGN) != 0u);
}

fn f64_eq(a: vec2<u32>, b: vec2<u32>) -> bool {
    return !(is_nan(a) | is_nan(b)) & all(f64_value_bits(a) == f64_value_bits(b));
}

// Of all that count as 0 the same.
fn f64_value_bits(a: vec2<u32>) -> vec2<u32> {
    return select(a, NOUGHT, exponent_of(a) == 0);
}

fn f64_le(a: vec2<u32>, b: vec2<u32>) -> bool {
    return f64_lt(a, b) | f64_eq(a, b);
}

fn f64_min(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    return select(a, b, f64_lt(b, a));
}

fn f64_max(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    return select(a, b, f64_lt(a, b));
}

fn f64_from_u32(value: u32) -> vec2<u32> {
    let zeros = countLeadingZeros(value);
    let m = value << (zeros & 31u);
    return select(vec2<u32>(m << 21u, (u32(1023 + 30 - i32(zeros)) << 20u) + (m >> 11u)), NOUGHT, value == 0u);
}

fn f64_from_i32(value: i32) -> vec2<u32> {
    let size = f64_from_u32(u32(abs(value)));
    return vec2<u32>(size.x, size.y | select(0u, SIGN, value < 0));
}

fn f64_from_f32(value: f32) -> vec2<u32> {
    let bits = bitcast<u32>(value);
    let sign = bits & SIGN;
    let exponent = (bits >> 23u) & 0xffu;
    let part = bits & 0x7fffffu;
    let normal = vec2<u32>(part << 29u, ((exponent + 896u) << 20u) | (part >> 3u));
    // part 2^-149
    let size = f64_from_u32(part);
    let small = vec2<u32>(size.x, select(size.y - (149u << 20u), 0u, part == 0u));
    let endless = select(vec2<u32>(0u, INFINITE), NAN, part != 0u);
    let found = select(select(normal, small, exponent == 0u), endless, exponent == 0xffu);
    return found | vec2<u32>(0u, select(sign, 0u, (exponent == 0xffu) & (part != 0u)));
}

fn f32_from_f64(a: vec2<u32>) -> f32 {
    let sign = a.y & SIGN;
    let exponent = exponent_of(a) - 896;
    // 24 bits stay, 7 are for the rounding, the last stands for the rest; of numbers below 2^-126 fewer stay
    let m = SIGN | ((a.y & 0xfffffu) << 11u) | (a.x >> 21u) | select(0u, 1u, (a.x & 0x1fffffu) != 0u);
    let fewer = u32(clamp(1 - exponent, 0, 31));
    let w = (m >> fewer) | select(0u, 1u, (m & ((1u << fewer) - 1u)) != 0u);
    let rest = w & 0xffu;
    let kept = w >> 8u;
    let up = select(0u, 1u, (rest > 0x80u) | ((rest == 0x80u) & ((kept & 1u) != 0u)));
    // the leading 1, and what is carried beyond it, count in the exponent
    let size = min((u32(clamp(exponent, 1, 0xff) - 1) << 23u) + kept + up, 0x7f800000u);
    return bitcast<f32>(sign | select(select(size, 0x7f800000u, exponent >= 0xff), 0x7fc00000u, is_nan(a)));
}

// Towards 0; beyond the ends of the range, at the end.
fn u32_from_f64(a: vec2<u32>) -> u32 {
    let exponent = exponent_of(a) - 1023;
    let whole = shifted_left(mantissa_of(a), 11u).y >> u32(31 - clamp(exponent, 0, 31));
    return select(select(whole, 0xffffffffu, exponent > 31), 0u, (exponent < 0) | ((a.y & SIGN) != 0u));
}

// Vectors, in loops: a kernel is to be small, and drivers put what a function does wherever it is called. In each round all
// components move up by one, so that no index varies: arrays with such indices lie in memory, and compilers take long over them.

alias Triple = array<vec2<u32>, 3>;

fn f64_add3(a: Triple, b: Triple) -> Triple {
    var p = a;
    var q = b;
    for (var k = 0u; k < 3u; k++) {
        p = Triple(p[1], p[2], f64_add(p[0], q[0]));
        q = Triple(q[1], q[2], q[0]);
    }
    return p;
}

fn f64_sub3(a: Triple, b: Triple) -> Triple {
    var p = a;
    var q = b;
    for (var k = 0u; k < 3u; k++) {
        p = Triple(p[1], p[2], f64_sub(p[0], q[0]));
        q = Triple(q[1], q[2], q[0]);
    }
    return p;
}

fn f64_mul3(a: Triple, b: Triple) -> Triple {
    var p = a;
    var q = b;
    for (var k = 0u; k < 3u; k++) {
        p = Triple(p[1], p[2], f64_mul(p[0], q[0]));
        q = Triple(q[1], q[2], q[0]);
    }
    return p;
}

fn f64_div3(a: Triple, b: Triple) -> Triple {
    var p = a;
    var q = b;
    for (var k = 0u; k < 3u; k++) {
        p = Triple(p[1], p[2], f64_div(p[0], q[0]));
        q = Triple(q[1], q[2], q[0]);
    }
    return p;
}

// Products are added first to last.
fn f64_dot(a: Triple, b: Triple) -> vec2<u32> {
    var p = a;
    var q = b;
    var total = f64_mul(p[0], q[0]);
    for (var k = 0u; k < 2u; k++) {
        p = Triple(p[1], p[2], p[0]);
        q = Triple(q[1], q[2], q[0]);
        total = f64_add(total, f64_mul(p[0], q[0]));
    }
    return total;
}

fn f64_cross(a: Triple, b: Triple) -> Triple {
    var p = a;
    var q = b;
    var r = a;
    for (var k = 0u; k < 3u; k++) {
        r = Triple(r[1], r[2], f64_sub(f64_mul(p[1], q[2]), f64_mul(p[2], q[1])));
        p = Triple(p[1], p[2], p[0]);
        q = Triple(q[1], q[2], q[0]);
    }
    return r;
}

fn f64_from_f32_3(value: vec3<f32>) -> Triple {
    return Triple(f64_from_f32(value.x), f64_from_f32(value.y), f64_from_f32(value.z));
}
