// The matrix whose kernel is a ray through a point, over one chart of t, with bounds of its rounding.

#import project/answer.wgsl

// Magnitudes below which products are flushed to 0: 2^-126 times two columns of at most 2^21, eighteen times, and as much again.
const UNDERFLOW: f32 = 1e-24;

// m_k = a_k + s b_k for |s| <= CHART_END; m_0 + u m_1 + v m_2 = 0 is a ray through the point.
struct Chart {
    a0: vec3<f32>,
    a1: vec3<f32>,
    a2: vec3<f32>,
    b0: vec3<f32>,
    b1: vec3<f32>,
    b2: vec3<f32>,
    // bounds of the error of a_k, of b_k and of m_k, and of the magnitude of m_k and the terms that it is a sum of; by components
    error: vec3<f32>,
    size: vec3<f32>,
    // det m = c_0 + c_1 s + ..., and a bound of the error of all four together
    c: vec4<f32>,
    zero: f32,
}

fn volume(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> f32 {
    return dot(a, cross(b, c));
}

// `error` without what evaluating m_k rounds: three times the size.
fn chart_of(a: mat3x3<f32>, b: mat3x3<f32>, error: vec3<f32>, size: vec3<f32>) -> Chart {
    var k: Chart;
    k.a0 = a[0];
    k.a1 = a[1];
    k.a2 = a[2];
    k.b0 = b[0];
    k.b1 = b[1];
    k.b2 = b[2];
    k.error = error + 4.0 * UNIT_ROUNDING * size;
    k.size = size;
    k.c = vec4<f32>(
        volume(a[0], a[1], a[2]),
        volume(b[0], a[1], a[2]) + volume(a[0], b[1], a[2]) + volume(a[0], a[1], b[2]),
        volume(a[0], b[1], b[2]) + volume(b[0], a[1], b[2]) + volume(b[0], b[1], a[2]),
        volume(b[0], b[1], b[2]),
    );
    // six products of three numbers each: what the columns' errors change, and twelve roundings of each
    let e = k.error;
    let changed = e.x * size.y * size.z + size.x * e.y * size.z + size.x * size.y * e.z;
    k.zero = 6.5 * changed + 96.0 * UNIT_ROUNDING * size.x * size.y * size.z + UNDERFLOW;
    return k;
}

// A column sum at a place and s.
fn matrix_value(k: Chart, place: vec2<f32>, s: f32) -> vec3<f32> {
    return (k.a0 + s * k.b0) + place.x * (k.a1 + s * k.b1) + place.y * (k.a2 + s * k.b2);
}

// The determinant's Bernstein coefficients over [s0, s1]: its blossom (Ramshaw 1989). Their error is within 2 `zero`.
fn bernstein(k: Chart, s0: f32, s1: f32) -> vec4<f32> {
    let c = k.c;
    let at = vec4<f32>(3.0 * s0, 2.0 * s0 + s1, s0 + 2.0 * s1, 3.0 * s1) / 3.0;
    let pair = vec4<f32>(3.0 * s0 * s0, s0 * (s0 + 2.0 * s1), s1 * (s1 + 2.0 * s0), 3.0 * s1 * s1) / 3.0;
    let triple = vec4<f32>(s0 * s0 * s0, s0 * s0 * s1, s0 * s1 * s1, s1 * s1 * s1);
    return vec4<f32>(c.x) + c.y * at + c.z * pair + c.w * triple;
}

// Steps towards the point of a hull that is nearest to 0.
const GILBERT_STEPS: u32 = 10u;

// A plane through 0 has the values of all places within the corners, at all s in [s0, s1], strictly on one side: no ray of these meets the
// point. Values are affine in the place and in s, so they lie in the hull of those at the ends (Gilbert 1966 finds the plane).
fn separated(k: Chart, corners: array<vec2<f32>, 4>, reach: f32, s0: f32, s1: f32) -> bool {
    var all: array<vec3<f32>, 8>;
    var p = vec3<f32>(0.0);
    for (var i = 0u; i < 8u; i++) {
        let place = corners[i & 3u];
        all[i] = matrix_value(k, place, select(s0, s1, i >= 4u));
        p += 0.125 * all[i];
    }
    // adding three columns, and a product with p, round each ten times at most
    let size = k.size.x + reach * (k.size.y + k.size.z);
    let error = 1.01 * (k.error.x + reach * (k.error.y + k.error.z)) + 10.0 * UNIT_ROUNDING * size;
    for (var step = 0u; step < GILBERT_STEPS; step++) {
        var least = dot(p, all[0]);
        var nearest = all[0];
        for (var i = 1u; i < 8u; i++) {
            let along = dot(p, all[i]);
            if along < least {
                least = along;
                nearest = all[i];
            }
        }
        if least > error * (abs(p.x) + abs(p.y) + abs(p.z)) + UNDERFLOW {
            return true;
        }
        let to = nearest - p;
        let share = -dot(p, to) / dot(to, to);
        if !(share > 0.0) {
            return false;
        }
        p += min(share, 1.0) * to;
    }
    return false;
}
