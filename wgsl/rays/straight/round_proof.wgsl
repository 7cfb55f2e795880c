// Proofs in recheck arithmetic about where a straight ray meets a sphere or capsule. Sizes and bounds have the form of triangle_proof.wgsl.

#import arithmetic
#import nodes/slabs.wgsl
#import primitives/round/capsule.wgsl
#import primitives/round/end.wgsl
#import primitives/round/kinds.wgsl
#import rays/affine_bundle.wgsl
#import rays/proof
#import rays/proof.wgsl
#import rays/straight/triangle_proof.wgsl
#import shared/params.wgsl

// Bounds are sums and products of rounded numbers, each by some units: all of them together by less than this share.
const BOUND_ROUNDING: real = 1.0001;

// Units of a root and of a quotient.
const ROOT_UNITS: real = 8.0;

// A vector, its size and its error bound.
struct Measured {
    v: real3,
    size: real,
    error: real,
}

fn product_units(a: Measured, b: Measured) -> real {
    return a.size * b.error + a.error * b.size + PRODUCT_UNITS * REAL_UNIT * a.size * b.size;
}

fn measured_cross(a: Measured, b: Measured) -> Measured {
    let v = cross(a.v, b.v);
    return Measured(v, size3(v), product_units(a, b));
}

fn measured_dot(a: Measured, b: Measured) -> Bounded {
    return Bounded(dot(a.v, b.v), BOUND_ROUNDING * product_units(a, b));
}

// A square root that lies between two numbers, and its square's bounds.
struct Half {
    below: Bounded,
    low: real,
    high: real,
}

fn half_of(below: Bounded) -> Half {
    let low = sqrt(max(below.value - below.bound, 0.0)) * (1.0 - ROOT_UNITS * REAL_UNIT);
    let high = sqrt(max(below.value + below.bound, 0.0)) * (1.0 + ROOT_UNITS * REAL_UNIT);
    return Half(below, low, high);
}

// Bounds on the t where a ray enters and leaves a round surface.
struct ProvenEnds {
    enters_first: real,
    enters_last: real,
    leaves_first: real,
    leaves_last: real,
    below: real,            // no more than the square of half the way between them, times |d|^4
    is_met: bool,           // surely
    is_passed: bool,        // surely
}

const ANYWHERE: ProvenEnds = ProvenEnds(-FARTHEST, FARTHEST, -FARTHEST, FARTHEST, 0.0, false, false);

// t = (along -+ root of `below`) / a.
fn proven_ends(a: Bounded, along: Bounded, below: Bounded) -> ProvenEnds {
    if a.value <= 2.0 * a.bound {
        return ANYWHERE;
    }
    let half = half_of(below);
    let most = a.value + a.bound;
    let least = a.value - a.bound;
    return ProvenEnds(
        no_more(along.value - along.bound - half.high, most, least),
        -no_more(half.low - along.value - along.bound, most, least),
        no_more(along.value - along.bound + half.low, most, least),
        -no_more(-(along.value + along.bound + half.high), most, least),
        below.value - below.bound,
        below.value > below.bound,
        below.value < -below.bound,
    );
}

// No more than a number over one from `least` to `most`, both above 0.
fn no_more(number: real, most: real, least: real) -> real {
    let t = number / select(least, most, number > 0.0);
    return t - ROOT_UNITS * REAL_UNIT * abs(t);
}

// R^2.
fn square_of(q: Weighed, s: Capsule) -> Bounded {
    // the radius as stored, and a product
    let large = s.radius * abs(q.b.h);
    let error = 2.0 * REAL_UNIT * large + s.radius * q.error_h;
    return Bounded(large * large, error * (2.0 * large + error) + PRODUCT_UNITS * REAL_UNIT * large * large);
}

// a R^2 - w^2.
fn below_of(a: Bounded, square: Bounded, w_squared: real, size_w: real, error_w: real) -> Bounded {
    let value = a.value * square.value - w_squared;
    let units = PRODUCT_UNITS * REAL_UNIT * (a.value * square.value + size_w * size_w);
    let bound = (a.value + a.bound) * square.bound + square.value * a.bound + error_w * (2.0 * size_w + error_w) + units;
    return Bounded(value, BOUND_ROUNDING * bound);
}

// The ball about a point: m = c h - p, and w = d x m.
fn ball_ends(d: Measured, m: Measured, square: Bounded) -> ProvenEnds {
    let a = measured_dot(d, d);
    let w = measured_cross(d, m);
    return proven_ends(a, measured_dot(d, m), below_of(a, square, dot(w.v, w.v), w.size, w.error));
}

// The tube about the line through a point along an axis: the ball of d x u and m x u; the square of u . (d x m) stands for that of the product
// of the two.
fn tube_ends(d: Measured, m: Measured, axis: Measured, square: Bounded) -> ProvenEnds {
    let across = measured_cross(d, axis);
    let a = measured_dot(across, across);
    let w = measured_dot(axis, measured_cross(d, m));
    let below = below_of(a, square, w.value * w.value, abs(w.value), w.bound);
    return proven_ends(a, measured_dot(across, measured_cross(m, axis)), below);
}

// The axis as stored is off by a unit of each of its ends and of their difference; over its length, by no more than twice that over its length.
fn segment_axis(s: Capsule) -> Measured {
    let error = REAL_UNIT * (2.0 * size3(s.end) + 4.0 * s.length);
    return Measured(s.axis, size3(s.axis), 4.0 * error / s.length + PRODUCT_UNITS * REAL_UNIT);
}

// The same after so much of the ray.
fn ends_after(ends: ProvenEnds, start: real) -> ProvenEnds {
    let units = 2.0 * REAL_UNIT;
    let sizes = abs(start) + abs(vec4<real>(ends.enters_first, ends.enters_last, ends.leaves_first, ends.leaves_last));
    return ProvenEnds(
        ends.enters_first + start - units * sizes.x, ends.enters_last + start + units * sizes.y,
        ends.leaves_first + start - units * sizes.z, ends.leaves_last + start + units * sizes.w,
        ends.below, ends.is_met, ends.is_passed,
    );
}

// How capsules and tubes are entered: wgsl/primitives/round/chord.wgsl.
fn capsule_proof(q: Weighed, d: Measured, m: Measured, s: Capsule, square: Bounded, near: ProvenEnds) -> ProvenEnds {
    let start = dot(d.v, m.v) / dot(d.v, d.v);
    let place = m.v - start * d.v;
    let error = m.error + abs(start) * (d.error + 2.0 * REAL_UNIT * d.size) + 2.0 * REAL_UNIT * size3(place);
    let own = Measured(place, size3(place) + error, error);
    let axis = segment_axis(s);
    let length = s.length * abs(q.b.h);
    let error_length = 8.0 * REAL_UNIT * (length + size3(s.end) * abs(q.b.h)) + s.length * q.error_h;
    let reach = place + s.length * q.b.h * s.axis;
    let error_reach = error + 2.0 * error_length + length * axis.error + 4.0 * REAL_UNIT * (length + own.size);
    let far = ends_after(ball_ends(d, Measured(reach, size3(reach) + error_reach, error_reach), square), start);
    let tube = tube_ends(d, own, axis, square);
    let whole = ends_after(tube, start);
    let sense = select(real(-1.0), real(1.0), q.b.h > 0.0);
    let slope = measured_dot(axis, d);
    let offset = measured_dot(axis, own);
    let first = place_between(sense, slope, offset, tube.enters_first, tube.enters_last);
    let last = place_between(sense, slope, offset, tube.leaves_first, tube.leaves_last);
    let entered = ends_at(near, whole, far, first, length, error_length);
    let left = ends_at(near, whole, far, last, length, error_length);
    return ProvenEnds(
        entered.enters_first, entered.enters_last, left.leaves_first, left.leaves_last,
        min(entered.below, left.below), entered.is_met, tube.is_passed || entered.is_passed,
    );
}

// Two bounds on u . (t d - m), in the direction from the end to the other end.
fn place_between(sense: real, slope: Bounded, offset: Bounded, t_first: real, t_last: real) -> vec2<real> {
    let size = max(abs(t_first), abs(t_last));
    let one = sense * (t_first * slope.value - offset.value);
    let other = sense * (t_last * slope.value - offset.value);
    let units = 4.0 * REAL_UNIT;
    let bound = BOUND_ROUNDING * (size * (slope.bound + units * abs(slope.value)) + offset.bound + units * abs(offset.value));
    return vec2<real>(min(one, other) - bound, max(one, other) + bound);
}

// The ends of those parts of the surface where a place may be.
fn ends_at(near: ProvenEnds, tube: ProvenEnds, far: ProvenEnds, place: vec2<real>, length: real, error: real) -> ProvenEnds {
    var ends = ProvenEnds(FARTHEST, -FARTHEST, FARTHEST, -FARTHEST, FARTHEST, true, true);
    ends = either_of(ends, near, !(place.x > 0.0));
    ends = either_of(ends, far, !(place.y < length - error));
    return either_of(ends, tube, !(place.y < 0.0) && !(place.x > length + error));
}

fn either_of(a: ProvenEnds, b: ProvenEnds, may: bool) -> ProvenEnds {
    if !may {
        return a;
    }
    return ProvenEnds(
        min(a.enters_first, b.enters_first), max(a.enters_last, b.enters_last),
        min(a.leaves_first, b.leaves_first), max(a.leaves_last, b.leaves_last),
        min(a.below, b.below), a.is_met && b.is_met, a.is_passed && b.is_passed,
    );
}

fn round_proof(cell: Cell, whole: Bundle, x: u32, y: u32, s: Capsule, two_sided: bool) -> Proof {
    let q = weighed(cell, whole, x, y);
    let to_end = offset_of(q, s.end);
    let d = Measured(q.b.d, size3(q.b.d) + q.error_d, q.error_d);
    let m = Measured(to_end.m, to_end.size, to_end.error);
    let square = square_of(q, s);
    var ends = ball_ends(d, m, square);
    let a = measured_dot(d, d);
    if a.value <= 2.0 * a.bound {
        return Proof(true, false, -FARTHEST, FARTHEST);
    }
    if CAPSULES && s.length > 0.0 {
        ends = capsule_proof(q, d, m, s, square, ends);
    }
    if ends.is_passed {
        return MISSED;
    }

    // the first of them in range; an end of a chain's segment includes hits a little beyond it
    let t_min = real_from_bits(params.t_words.xy);
    let t_max = real_from_bits(params.t_words.zw);
    let margin = select(0.0, 2.0 * end_margin(q.b, s, ends.below), SLABBED);
    let is_entered_before = ends.enters_last < t_min - margin;
    let is_entered = ends.enters_first >= t_min && ends.enters_last <= t_max;
    let is_left = two_sided && is_entered_before && ends.leaves_first >= t_min && ends.leaves_last <= t_max;
    if ends.is_met && (is_entered || is_left) {
        let near = select(ends.leaves_first, ends.enters_first, is_entered);
        return Proof(true, true, near, select(ends.leaves_last, ends.enters_last, is_entered));
    }
    let first = select(ends.enters_first, ends.leaves_first, is_entered_before && two_sided);
    let last = select(ends.enters_last, ends.leaves_last, two_sided);
    let is_around = ends.is_met && is_entered_before && ends.leaves_first > t_max + margin;
    if is_around || last < t_min - margin || first > t_max + margin {
        return MISSED;
    }
    return Proof(true, false, max(first, t_min), min(last, t_max));
}
