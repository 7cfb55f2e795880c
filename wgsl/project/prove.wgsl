// From a guess to a proven root of m_0 + u m_1 + v m_2 = 0.

#import project/answer.wgsl
#import project/chart.wgsl

// The only root (u, v, s) within `radius` of `at`, if it is one.
struct Proof {
    is_proven: bool,
    at: vec3<f32>,
    radius: vec3<f32>,
}

// Steps that bring the place and s to where rounding ends them; each doubles the digits.
const PROVE_STEPS: u32 = 2u;

// Farthest |s| of a chart: columns are bounded up to there.
const CHART_END: f32 = 1.0001;

fn sum_abs(v: vec3<f32>) -> f32 {
    return abs(v.x) + abs(v.y) + abs(v.z);
}

// Newton's method, then Krawczyk's test (1969): with r an approximate inverse of the slopes, the map z - r f(z) takes a box into its own
// inside, so the box has one root and no other.
fn prove(k: Chart, guess: f32) -> Proof {
    var s = guess;
    let m1 = k.a1 + s * k.b1;
    let m2 = k.a2 + s * k.b2;
    let m0 = k.a0 + s * k.b0;
    let n = cross(m1, m2);
    var place = vec2<f32>(dot(cross(m2, m0), n), dot(cross(m0, m1), n)) / dot(n, n);
    var r: mat3x3<f32>;
    var j: mat3x3<f32>;
    for (var step = 0u; step <= PROVE_STEPS; step++) {
        j = mat3x3<f32>(k.a1 + s * k.b1, k.a2 + s * k.b2, k.b0 + place.x * k.b1 + place.y * k.b2);
        let minor = mat3x3<f32>(cross(j[1], j[2]), cross(j[2], j[0]), cross(j[0], j[1]));
        let whole = dot(j[0], minor[0]);
        r = mat3x3<f32>(minor[0] / whole, minor[1] / whole, minor[2] / whole);
        if step < PROVE_STEPS {
            let f = matrix_value(k, place, s);
            place -= vec2<f32>(dot(r[0], f), dot(r[1], f));
            s -= dot(r[2], f);
        }
    }

    // the value there, and a box twice as wide as it asks for
    let weights = vec3<f32>(1.0, abs(place));
    let error = dot(weights, k.error) * 1.01 + 10.0 * UNIT_ROUNDING * dot(weights, k.size) + UNDERFLOW;
    let f = max_abs(matrix_value(k, place, s)) + error;
    let rows = vec3<f32>(sum_abs(r[0]), sum_abs(r[1]), sum_abs(r[2]));
    let need = 1.01 * f * rows;
    let radius = 2.0 * need;

    // how far r j is from 1 within the box
    let errors = vec3<f32>(k.error.y, k.error.z, error) + 8.0 * UNIT_ROUNDING * vec3<f32>(k.size.yz, dot(weights, k.size));
    var off = vec3<f32>(0.0);
    for (var i = 0u; i < 3u; i++) {
        var unit = vec3<f32>(0.0);
        unit[i] = 1.0;
        let product = vec3<f32>(dot(r[i], j[0]), dot(r[i], j[1]), dot(r[i], j[2]));
        off[i] = dot(abs(unit - product) + rows[i] * errors, radius);
    }
    let bent = 2.0 * radius.z * (max_abs(k.b1) * radius.x + max_abs(k.b2) * radius.y);
    let taken = need + 1.01 * off + 1.02 * rows * bent;
    let at = vec3<f32>(place, s);
    return Proof(all(taken < 0.99 * radius) && abs(s) + radius.z < CHART_END, at, radius);
}
