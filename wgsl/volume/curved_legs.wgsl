// A curve as straight legs, so many that none lies farther from it than it may.
// Provides: Leg, leg_at, leg_count
// Needs: Curve, DEGREE, curve_point, curve_tangent, pixel_curve, real, real3
// Binds: medium, params

// A straight part of a pixel's path: p + t d for t in [first, last].
struct Leg {
    p: real3,
    d: real3,
    first: f32,
    last: f32,
    speed: f32,             // length of the curve over a step of 1 in t, world units
}

// Least legs of a curve that bends: lengths of legs then are right to within 1e-5, by a rule of degree 5.
const LEGS_MIN: f32 = 8.0;
// Most legs.
const LEGS_MAX: f32 = 16384.0;

// Where the k-th of `count` legs up to t_end begins.
fn leg_start(t_end: f32, k: u32, count: u32) -> f32 {
    return mix(params.t_min.x, t_end, f32(k) / f32(count));
}

// A leg lies within an eighth of |X''| dt^2 of its curve.
fn leg_count(layer: u32, x: u32, y: u32, t_end: f32) -> u32 {
    let c = pixel_curve(layer, x, y);
    let a = length(vec3<f32>(c.c0 - c.c1 + (c.c2 - c.c1)));
    let b = length(vec3<f32>(c.c1 - c.c2 + (c.c3 - c.c2)));
    var bend = 6.0 * max(a, b);
    if DEGREE == 2u {
        bend = 2.0 * a;
    }
    if DEGREE == 1u || bend == 0.0 {
        return 1u;
    }
    let count = (t_end - params.t_min.x) * sqrt(0.125 * bend / medium.place_error);
    return u32(clamp(ceil(count), LEGS_MIN, LEGS_MAX));
}

fn leg_at(layer: u32, x: u32, y: u32, t_end: f32, k: u32, count: u32) -> Leg {
    let c = pixel_curve(layer, x, y);
    let t0 = leg_start(t_end, k, count);
    let t1 = leg_start(t_end, k + 1u, count);
    let p = curve_point(c, real(t0));
    let d = curve_point(c, real(t1)) - p;
    // Gauss and Legendre's rule of three points
    let m = 0.5 * (t0 + t1);
    let h = 0.3872983346 * (t1 - t0);
    let sides = curve_speed(c, m - h) + curve_speed(c, m + h);
    return Leg(p, d, 0.0, 1.0, (t1 - t0) * (5.0 * sides + 8.0 * curve_speed(c, m)) / 18.0);
}

fn curve_speed(c: Curve, t: f32) -> f32 {
    return length(vec3<f32>(curve_tangent(c, real(t))));
}
