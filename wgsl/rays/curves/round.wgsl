// Where a curve meets a primitive in scenes with spheres and capsules: on a sphere at a root of |X(t) - c|^2 - r^2, a polynomial of twice the
// curve's degree, in recheck arithmetic.

#import arithmetic
#import keys/key.wgsl
#import nodes/slabs.wgsl
#import optics/start
#import primitives/round/capsule.wgsl
#import primitives/round/kinds.wgsl
#import rays/affine_bundle.wgsl
#import rays/coverage
#import rays/curves/curve.wgsl
#import rays/seen
#import rays/stretch
#import shared/params.wgsl
#import vertices/traced
#import vertices/triangle.wgsl
#import vertices/vertex

fn with_primitive(path: Path, stretch: Stretch, before: Seen, own: BvhTriangle) -> Seen {
    if is_round(vec4<u32>(own.word)) {
        return with_round(path, stretch, before, own);
    }
    return with_triangle(path, stretch, before, own);
}

// The stretch is within its slack of a chord: a sphere farther away from that is not met. A component of m is off by a unit for each
// coordinate and 2 of itself, one of d x m by twice that and 6 units of |m|, as |d| is no larger than the way from end to end.
fn with_round(path: Path, stretch: Stretch, before: Seen, own: BvhTriangle) -> Seen {
    let is_ball = !is_capsule(vec4<u32>(own.word));
    let axis = select(own.from_last, vec3<f32>(0.0), is_ball);
    let to_end = own.v - stretch.p;
    let size_d = length(stretch.d);
    let lost = 24.0 * UNIT * (2.0 + length(to_end) + length(axis)) + LEAST;
    let reach = own.to_next.x + length(stretch.slack) + lost;
    // a capsule is no farther from the middle of its segment than half of that, and the lines are no closer than the two parts
    let around = reach + 0.5 * length(axis);
    let is_around = length(cross(stretch.d, to_end + 0.5 * axis)) <= 1.0001 * around * size_d + LEAST;
    let apart = abs(dot(axis, cross(stretch.d, to_end))) - lost * size_d * length(axis);
    var may = is_around && (is_ball || apart <= 1.0001 * reach * length(cross(stretch.d, axis)) + LEAST);
    var seen = before;
    // a loop: software adapters take every branch
    loop {
        if !may {
            break;
        }
        may = false;
        let here = round_hit(path, stretch, triangle_at(own.slot));
        let is_nearer = here.key.y > seen.key.y || (here.key.y == seen.key.y && here.key.x > seen.key.x);
        seen.key = select(seen.key, here.key, is_nearer);
        seen.t = select(seen.t, here.t, is_nearer);
    }
    return seen;
}

fn round_hit(path: Path, stretch: Stretch, triangle: vec4<u32>) -> Seen {
    let id = triangle_id(triangle);
    let tile = path.item >> 6u;
    let bit = path.item & 63u;
    let corner = tile_corner(tile);
    let c = curve_stored(curve_place(tile_layer(tile), corner.x + bit % TILE, corner.y + bit / TILE));
    let spans = real(f32(params.spans));
    let from_t = real(f32(stretch.number)) / spans;
    let to_t = real(f32(stretch.number + 1u)) / spans;
    let root = capsule_crossing(c, from_nearer_end(c, triangle), from_t, to_t, (triangle.w & ONE_SIDED) == 0u);
    let is_met = root.is_there && path.start != id && !is_excluded(id);
    let t = f32(root.t);
    let key = ~visibility_key(tile_layer(tile), root.t, id);
    return Seen(select(vec2<u32>(0u), key, is_met), t + 2.0 * UNIT * abs(t));
}

// A capsule from the end that is nearer to the curve's first point: places are rounded relative to their distance from that end.
fn from_nearer_end(c: Curve, triangle: vec4<u32>) -> Capsule {
    let s = capsule_of(triangle);
    if !is_capsule(triangle) || 2.0 * dot(c.c0 - s.end, s.axis) <= s.length {
        return s;
    }
    return Capsule(vertex_real(triangle.x + 1u), s.radius, -s.axis, s.length);
}

// By how much of its radius a place may lie beyond the end of a part of a capsule: the parts touch there, so that the surface is off by half
// the square of that.
const SEAM: real = 1.0 / 1048576.0;

// A curve meets the ball about an end beyond that end, and the tube between the ends.
fn is_on_part(c: Curve, s: Capsule, part: u32, t: real) -> bool {
    let place = dot(curve_point(c, t) - s.end, s.axis);
    let seam = SEAM * s.radius;
    let is_before = place <= seam;
    let is_behind = place >= s.length - seam;
    switch part {
        case 0u: { return is_before || s.length == 0.0; }
        case 1u: { return is_behind; }
        default: { return place >= -seam && place <= s.length + seam; }
    }
}

// The most roots of one part that are looked at.
const ROOTS: u32 = 6u;

// The first of the roots of the ball about an end, of that about the other, and of the tube.
fn capsule_crossing(c: Curve, s: Capsule, from_t: real, to_t: real, two_sided: bool) -> Crossing {
    let parts = select(3u, 1u, !CAPSULES || s.length == 0.0);
    var nearest = Crossing(to_t, false);
    for (var part = 0u; part < parts; part++) {
        let height = height_of(c, s, part);
        var begin = from_t;
        for (var k = 0u; k < ROOTS; k++) {
            let root = first_crossing(height, begin, to_t, two_sided);
            if !root.is_there || (nearest.is_there && root.t >= nearest.t) {
                break;
            }
            if is_on_part(c, s, part, root.t) {
                nearest = root;
                break;
            }
            begin = root.t + PAST * (to_t - from_t);
            if begin >= to_t {
                break;
            }
        }
    }
    return nearest;
}

// A polynomial of degree 6 in Bernstein form.
struct Sextic {
    b: array<real, 7>,
}

// |X(t) - c|^2 - r^2, and how far from 0 its values may be where it is 0.
struct Height {
    p: Sextic,
    zero: real,
}

// From a ball's centre, or from the axis of a tube.
fn offset_from(s: Capsule, part: u32, place: real3) -> real3 {
    let offset = place - s.end;
    return offset - select(select(dot(offset, s.axis), s.length, part == 1u), 0.0, part == 0u) * s.axis;
}

// Curves of lower degrees are cubics too. The products of two cubics' Bernstein polynomials are those of degree 6 times a ratio of binomials.
fn height_of(c: Curve, s: Capsule, part: u32) -> Height {
    let o0 = offset_from(s, part, c.c0);
    var o1 = offset_from(s, part, c.c1);
    var o2 = offset_from(s, part, c.c2);
    let o3 = offset_from(s, part, c.c3);
    if DEGREE == 1u {
        o1 = o0 + (o3 - o0) / 3.0;
        o2 = o3 + (o0 - o3) / 3.0;
    } else if DEGREE == 2u {
        let middle = o1;
        o1 = (o0 + 2.0 * middle) / 3.0;
        o2 = (o3 + 2.0 * middle) / 3.0;
    }
    let square = s.radius * s.radius;
    var p: Sextic;
    p.b[0] = dot(o0, o0) - square;
    p.b[1] = dot(o0, o1) - square;
    p.b[2] = (2.0 * dot(o0, o2) + 3.0 * dot(o1, o1)) / 5.0 - square;
    p.b[3] = (dot(o0, o3) + 9.0 * dot(o1, o2)) / 10.0 - square;
    p.b[4] = (2.0 * dot(o1, o3) + 3.0 * dot(o2, o2)) / 5.0 - square;
    p.b[5] = dot(o2, o3) - square;
    p.b[6] = dot(o3, o3) - square;
    // an offset is off by 2 units of what was subtracted, its square by 4 of that, and a sum of squares and r^2 by as many
    let far = select(real(0.0), s.length, part == 1u);
    let sizes = size3(s.end) + far + s.radius + max(max(size3(c.c0), size3(c.c1)), max(size3(c.c2), size3(c.c3)));
    return Height(p, 16.0 * REAL_UNIT * sizes * sizes);
}

// A step of de Casteljau's construction: the first `count` coefficients move to the next ones by a share.
fn halfway(p: Sextic, count: u32, share: real) -> Sextic {
    var q = p;
    q.b[0] += share * (p.b[1] - p.b[0]);
    if count > 1u { q.b[1] += share * (p.b[2] - p.b[1]); }
    if count > 2u { q.b[2] += share * (p.b[3] - p.b[2]); }
    if count > 3u { q.b[3] += share * (p.b[4] - p.b[3]); }
    if count > 4u { q.b[4] += share * (p.b[5] - p.b[4]); }
    if count > 5u { q.b[5] += share * (p.b[6] - p.b[5]); }
    return q;
}

// The part behind a share of the interval. Without loops, of whose rounds software adapters have a limited number for all that a pixel does.
fn behind(p: Sextic, share: real) -> Sextic {
    return halfway(halfway(halfway(halfway(halfway(halfway(p, 6u, share), 5u, share), 4u, share), 3u, share), 2u, share), 1u, share);
}

fn reversed(p: Sextic) -> Sextic {
    return Sextic(array<real, 7>(p.b[6], p.b[5], p.b[4], p.b[3], p.b[2], p.b[1], p.b[0]));
}

// The part before it.
fn in_front(p: Sextic, share: real) -> Sextic {
    return reversed(behind(reversed(p), 1.0 - share));
}

struct Crossing {
    t: real,
    is_there: bool,
}

// Steps towards a root at most; most take four.
const CLIP_STEPS: u32 = 64u;

// Past a root that does not count, the share of the span behind which it goes on.
const PAST: real = 1.0 / 16777216.0;

// The steepest way, for a step of a sixth, from the first coefficient to another, where some are on the other side of 0; else 0.
fn steepest(p: Sextic, side: real) -> real {
    let ways = max(way_to(p, 1u, side), max(way_to(p, 2u, side), way_to(p, 3u, side)));
    let least = min(side * p.b[1], min(side * p.b[2], side * p.b[3]));
    let farther = min(side * p.b[4], min(side * p.b[5], side * p.b[6]));
    let steep = max(ways, max(way_to(p, 4u, side), max(way_to(p, 5u, side), way_to(p, 6u, side))));
    return select(0.0, steep, min(least, farther) < 0.0);
}

fn way_to(p: Sextic, k: u32, side: real) -> real {
    return side * (p.b[0] - p.b[k]) / real(f32(k));
}

// Of [0, 1], the part between two t.
fn over_part(p: Sextic, from_t: real, to_t: real) -> Sextic {
    return in_front(behind(p, from_t), (to_t - from_t) / (1.0 - from_t));
}

// The first root where a surface is entered, or left and its back seen. A root within rounding of an end counts as on it, as the next span
// or layer begins there. The graph of a polynomial lies in the hull of its coefficients, and so does not come to 0 before the steepest
// line from its start to one of these does: up to there the interval is cut off; where rounding says that this has cut off the root too, it
// is there. Then a part in front is looked at: if its ends have different signs, the rest is cut off, and if it keeps off 0, it is itself;
// else a smaller one is looked at next.
fn first_crossing(h: Height, from_t: real, to_t: real, two_sided: bool) -> Crossing {
    var p = over_part(h.p, from_t, to_t);
    if abs(p.b[0]) <= h.zero && (two_sided || p.b[1] < p.b[0]) {
        return Crossing(from_t, true);
    }
    let is_at_end = abs(p.b[6]) <= h.zero && (two_sided || p.b[6] < p.b[5]);
    var lo = from_t;
    var hi = to_t;
    var side = select(real(-1.0), real(1.0), p.b[0] > 0.0);
    var reach = real(0.5);
    for (var k = 0u; k < CLIP_STEPS; k++) {
        let steep = steepest(p, side);
        let is_there = side * p.b[0] <= 0.0;
        if steep == 0.0 && !is_there {
            break;
        }
        let share = select(side * p.b[0] / (6.0 * steep), 0.0, is_there);
        lo += share * (hi - lo);
        if share * (hi - lo) <= REAL_UNIT {
            if side > 0.0 || two_sided {
                return Crossing(lo, true);
            }
            lo += PAST * (to_t - from_t);
            hi = to_t;
            if lo >= to_t {
                break;
            }
            p = over_part(h.p, lo, to_t);
            side = select(real(-1.0), real(1.0), p.b[0] > 0.0);
            reach = 0.5;
            continue;
        }
        p = behind(p, share);
        let front = in_front(p, reach);
        if side * front.b[6] < 0.0 {
            p = front;
            hi = lo + reach * (hi - lo);
            reach = 0.5;
        } else if steepest(front, side) == 0.0 {
            p = behind(p, reach);
            lo += reach * (hi - lo);
            reach = 0.5;
        } else {
            reach *= 0.5;
        }
    }
    return Crossing(to_t, is_at_end);
}
