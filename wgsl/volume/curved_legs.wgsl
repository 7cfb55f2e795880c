// A curve as straight legs where it may be in the grid, so many that none lies farther from it than it may.
// Provides: Leg, leg_at, legs_of
// Needs: Curve, DEGREE, curve_point, curve_tangent, grid_direction, grid_place, pixel_curve, real, real3
// Binds: medium, params

// A straight part of a pixel's path: p + t d for t in [first, last].
struct Leg {
    p: real3,
    d: real3,
    first: f32,
    last: f32,
    speed: f32,             // length of the curve over a step of 1 in t, world units
}

// So many legs of equal t from `start` to `end`.
struct Legs {
    curve: Curve,
    start: f32,
    end: f32,
    count: u32,
}

// Least legs of a curve that bends: lengths of legs then are right to within 1e-5, by a rule of degree 5.
const LEGS_MIN: f32 = 8.0;
// Most legs.
const LEGS_MAX: f32 = 16384.0;
// Parts of a curve of which each is looked at for whether it may be in the grid.
const PARTS: u32 = 64u;

// A leg lies within an eighth of |X''| dt^2 of its curve. The first and the last part that the grid may hold are found alike.
fn legs_of(layer: u32, x: u32, y: u32, t_end: f32) -> Legs {
    let c = pixel_curve(layer, x, y);
    let a = c.c0 - c.c1 + (c.c2 - c.c1);
    let b = c.c1 - c.c2 + (c.c3 - c.c2);
    var bend = 6.0 * max(length(vec3<f32>(a)), length(vec3<f32>(b)));
    var bend_in_grid = 6.0 * max(abs(vec3<f32>(grid_direction(a))), abs(vec3<f32>(grid_direction(b))));
    if DEGREE == 2u {
        bend = 2.0 * length(vec3<f32>(a));
        bend_in_grid = 2.0 * abs(vec3<f32>(grid_direction(a)));
    }
    let t_first = params.t_min.x;
    if DEGREE == 1u || bend == 0.0 {
        return Legs(c, t_first, t_end, 1u);
    }
    let width = (t_end - t_first) / f32(PARTS);
    // and a rounding of places
    let margin = 0.125 * width * width * bend_in_grid + 0.001;
    var first = PARTS;
    var last = 0u;
    var before = vec3<f32>(grid_place(curve_point(c, real(t_first))));
    for (var k = 0u; k < PARTS; k++) {
        let next = vec3<f32>(grid_place(curve_point(c, real(t_first + width * f32(k + 1u)))));
        let is_near = all(max(before, next) >= -margin) && all(min(before, next) <= medium.last + margin);
        first = min(first, select(PARTS, k, is_near));
        last = max(last, select(0u, k + 1u, is_near));
        before = next;
    }
    let start = t_first + width * f32(first);
    let end = select(t_first + width * f32(last), t_end, last == PARTS);
    let count = (end - start) * sqrt(0.125 * bend / medium.place_error);
    return Legs(c, start, end, select(0u, u32(clamp(ceil(count), LEGS_MIN, LEGS_MAX)), first < last));
}

// Where the k-th leg begins.
fn leg_start(legs: Legs, k: u32) -> f32 {
    return mix(legs.start, legs.end, f32(k) / f32(legs.count));
}

fn leg_at(legs: Legs, k: u32) -> Leg {
    let c = legs.curve;
    let t0 = leg_start(legs, k);
    let t1 = leg_start(legs, k + 1u);
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
