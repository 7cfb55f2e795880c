// Intersection of rays with quadrics.

#import arithmetic
#import optics/layout.wgsl
#import optics/smooth/bounce.wgsl
#import rays/affine_bundle.wgsl

var<storage, read> quadrics: array<Quadric>;

fn quadric_times(q: Quadric, v: real3) -> real3 {
    let a = real3(q.diagonal_hi) + real3(q.diagonal_lo);
    let b = real3(q.beside_hi) + real3(q.beside_lo);
    return real3(
        a.x * v.x + b.z * v.y + b.y * v.z,
        b.z * v.x + a.y * v.y + b.x * v.z,
        b.y * v.x + b.x * v.y + a.z * v.z,
    );
}

// Half of the gradient, v from the centre.
fn quadric_normal(q: Quadric, v: real3) -> real3 {
    return quadric_times(q, v) + real3(q.b_hi) + real3(q.b_lo);
}

// Rounding of a place's height along the axis, in units of what is summed up to get the place: some 20 of its root t,
// as many of the place and the height. A flat cap is all of one height and would have holes without.
const HEIGHT_UNITS: real = 128.0;

// The place, from the centre, is on the part of the surface that is there, its height known up to `error`.
fn quadric_contains(q: Quadric, v: real3, error: real) -> bool {
    let axis = real3(q.axis_hi) + real3(q.axis_lo);
    let z = dot(v, axis);
    let away = v - z * axis;
    return z >= real(q.low_hi) + real(q.low_lo) - error && z <= real(q.high_hi) + real(q.high_lo) + error
        && dot(away, away) <= real(q.rim2_hi) + real(q.rim2_lo);
}

// Where the ray p + t d first meets the quadric, t in [t_min, t_max]; of a ray that starts on it, the other place.
fn first_root(surface: u32, p: real3, d: real3, starts: bool, t_min: real, t_max: real) -> Root {
    let q = quadrics[surface];
    let v = p - real3(q.centre_hi) - real3(q.centre_lo);
    let ad = quadric_times(q, d);
    let n = quadric_normal(q, v);
    let a = dot(d, ad);
    let b = dot(d, n);
    let c = dot(v, n) + dot(v, real3(q.b_hi) + real3(q.b_lo)) + real(q.c_hi) + real(q.c_lo);
    let square = b * b - a * c;
    let root = sqrt(max(square, real(0.0)));
    let far = select(-root - b, root - b, b < real(0.0));
    // divisions by zero give no number in the range
    var t = vec2<real>(far / a, c / far);
    if starts {
        t = vec2<real>(-(b + b) / a);
    }
    var found = Root(real(0.0), false);
    for (var k = 0u; k < 2u; k++) {
        let s = t[k];
        let better = !found.found || s < found.t;
        let error = HEIGHT_UNITS * REAL_UNIT * (size3(v) + abs(s) * size3(d));
        if (starts || square >= real(0.0)) && s >= t_min && s <= t_max && better && quadric_contains(q, v + s * d, error) {
            found = Root(s, true);
        }
    }
    return found;
}

fn smooth_normal(surface: u32, place: real3) -> real3 {
    let q = quadrics[surface];
    return quadric_normal(q, place - real3(q.centre_hi) - real3(q.centre_lo));
}
