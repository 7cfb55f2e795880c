// A curve as straight legs where it may be in the grid, so many that none lies farther from it than it may.

#import arithmetic
#import rays/curve
#import rays/curves/curve.wgsl
#import rays/curves/pixel.wgsl
#import shared/params.wgsl
#import volume.wgsl
#import volume/layout.wgsl

// A straight part of a pixel's path: start + t along for t in [first, last], grid coordinates.
struct Leg {
    start: real3,
    along: real3,
    first: f32,
    last: f32,
    speed: f32,             // length of the curve over a step of 1 in t, world units
    direction: vec3<f32>,   // unit vector, in the world
}

// So many legs of equal t from `start` to `end`.
struct Legs {
    curve: Curve,           // in grid coordinates
    step0: vec3<f32>,       // from each control point to the next, in the world
    step1: vec3<f32>,
    step2: vec3<f32>,
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

// The point of a curve at t, one coordinate after the other: f64 in 32-bit words takes vectors in loops, a few hundred rounds a leg if it
// were done so, and lavapipe ends all loops of a thread after 65535 together.
fn grid_point(c: Curve, t: real) -> real3 {
    let w = bernstein(DEGREE, t);
    return real3(
        w.x * c.c0.x + w.y * c.c1.x + w.z * c.c2.x + w.w * c.c3.x,
        w.x * c.c0.y + w.y * c.c1.y + w.z * c.c2.y + w.w * c.c3.y,
        w.x * c.c0.z + w.y * c.c1.z + w.z * c.c2.z + w.w * c.c3.z,
    );
}

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
    let in_grid = Curve(grid_place(c.c0), grid_place(c.c1), grid_place(c.c2), grid_place(c.c3));
    var legs = Legs(in_grid, vec3<f32>(c.c1 - c.c0), vec3<f32>(c.c2 - c.c1), vec3<f32>(c.c3 - c.c2), t_first, t_end, 1u);
    if DEGREE == 1u || bend == 0.0 {
        return legs;
    }
    let width = (t_end - t_first) / f32(PARTS);
    // and a rounding of places
    let margin = 0.125 * width * width * bend_in_grid + 0.001;
    var first = PARTS;
    var last = 0u;
    var before = vec3<f32>(grid_point(in_grid, real(t_first)));
    for (var k = 0u; k < PARTS; k++) {
        let next = vec3<f32>(grid_point(in_grid, real(t_first + width * f32(k + 1u))));
        let is_near = all(max(before, next) >= -margin) && all(min(before, next) <= medium.last + margin);
        first = min(first, select(PARTS, k, is_near));
        last = max(last, select(0u, k + 1u, is_near));
        before = next;
    }
    legs.start = t_first + width * f32(first);
    legs.end = select(t_first + width * f32(last), t_end, last == PARTS);
    let count = (legs.end - legs.start) * sqrt(0.125 * bend / medium.place_error);
    legs.count = select(0u, u32(clamp(ceil(count), LEGS_MIN, LEGS_MAX)), first < last);
    return legs;
}

// Where the k-th leg begins.
fn leg_start(legs: Legs, k: u32) -> f32 {
    return mix(legs.start, legs.end, f32(k) / f32(legs.count));
}

fn leg_at(legs: Legs, k: u32) -> Leg {
    let t0 = leg_start(legs, k);
    let t1 = leg_start(legs, k + 1u);
    let start = grid_point(legs.curve, real(t0));
    let end = grid_point(legs.curve, real(t1));
    // Gauss and Legendre's rule of three points, exact for the way from end to end
    let m = 0.5 * (t0 + t1);
    let h = 0.3872983346 * (t1 - t0);
    let before = tangent(legs, m - h);
    let middle = tangent(legs, m);
    let after = tangent(legs, m + h);
    let speed = (t1 - t0) * (5.0 * (length(before) + length(after)) + 8.0 * length(middle)) / 18.0;
    let direction = normalize(5.0 * (before + after) + 8.0 * middle);
    return Leg(start, real3(end.x - start.x, end.y - start.y, end.z - start.z), 0.0, 1.0, speed, direction);
}

// The curve's derivative, world units.
fn tangent(legs: Legs, t: f32) -> vec3<f32> {
    if DEGREE == 1u {
        return legs.step0;
    }
    let first = mix(legs.step0, legs.step1, t);
    if DEGREE == 2u {
        return 2.0 * first;
    }
    return 3.0 * mix(first, mix(legs.step1, legs.step2, t), t);
}
