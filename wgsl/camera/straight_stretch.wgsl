// The path of a pixel in a layer: one straight ray, about a scene none of whose coordinates is larger than 1; and what it meets, to f32.
// Provides: ALL_UNCERTAIN, ENDLESS, Path, Seen, Stretch, is_seen, keep_seen, largest_of, last_of, nothing_seen, stretch_of, stretches,
//   with_triangle
// Needs: BvhTriangle, CORNER_UNITS, COUNT_RECHECK_ITEMS, COUNT_SETTLED, LEAST, NONE, ONE_SIDED, PERTURB_BOUND, PROVEN, SLABBED, UNIT,
//   is_excluded, triangle_id, triangle_reversed
// Binds: counters, params, recheck_items

// No hit is proven: all that may be one is left to recheck.
override ALL_UNCERTAIN: bool = false;

const ENDLESS: f32 = 1.0e30;

// P and D in f32, and bounds on the errors of their coordinates.
struct Path {
    p: vec3<f32>,
    error_p: f32,
    d: vec3<f32>,
    error_d: f32,
    item: u32,              // of recheck: the tile, and in the low 6 bits the pixel
    start: u32,             // the triangle that the ray starts on
}

// X = p + s d for s from `first` to `last`: no point of the path that counts is farther off than the slack, a coordinate.
struct Stretch {
    p: vec3<f32>,
    error_p: f32,
    d: vec3<f32>,
    error_d: f32,
    slack: vec3<f32>,
    first: f32,
    last: f32,
    inner_first: f32,       // within these s is certainly in range
    inner_last: f32,
}

// A triangle that is met between two s, and an s that no nearer triangle lies beyond.
struct Seen {
    slot: u32,
    first: f32,
    last: f32,
}

fn nothing_seen() -> Seen {
    return Seen(NONE, ENDLESS, ENDLESS);
}

fn is_seen(seen: Seen) -> bool {
    return seen.slot != NONE;
}

fn last_of(stretch: Stretch, seen: Seen) -> f32 {
    return min(stretch.last, seen.last);
}

fn stretches() -> u32 {
    return 1u;
}

// The ray in f32, its direction of size 1/2 to 1. The slack: what is lost of P, and of D on the way to the farthest box, as |s| is at most
// (1 + |P|) / (1/2 - error_d). Then 24 units of the largest distance, 29 where corners move: those of corners, 8 for the grid of boxes, which is computed in
// f32; here 1 for the way to its origin, 5 for 1 / d, and 7 for two products and two sums of twice that distance at most.
fn stretch_of(path: Path, k: u32, scale: f32) -> Stretch {
    let p = path.p * scale;
    let exponent = clamp(bitcast<u32>(largest_of(path.d)) >> 23u, 1u, 252u);
    // a power of two that brings d under 1, and its inverse
    let share = bitcast<f32>((253u - exponent) << 23u);
    let back = bitcast<f32>((exponent + 1u) << 23u);
    // coverage is decided on the perturbed ray
    let error_p = path.error_p * scale + PERTURB_BOUND * params.scene_size * scale + LEAST;
    let error_d = select(path.error_d * share, ENDLESS, path.error_d >= ENDLESS) + PERTURB_BOUND + LEAST;
    let far = 1.0 + largest_of(p) + error_p;
    let slack = min(error_p + far * (error_d / max(0.5 - error_d, LEAST) + (23.0 + CORNER_UNITS) * UNIT), ENDLESS);
    // ends that are infinite lie at ENDLESS
    let t_share = scale * back;
    let s_first = clamp((params.t_min.x + params.t_min.y + params.t_min.z) * t_share, -ENDLESS, ENDLESS);
    let s_last = clamp((params.t_max.x + params.t_max.y + params.t_max.z) * t_share, -ENDLESS, ENDLESS);
    // in a chain a hit up to end_rounding / |N . d| beyond an end counts as on it: less than this, but for triangles within 2^-36 of
    // edge-on, whose t is rounding alone
    let more = select(0.0, 0.00390625 * (s_last - s_first), SLABBED);
    let margin_first = more + slack + 4.0 * UNIT * abs(s_first);
    let margin_last = more + slack + 4.0 * UNIT * abs(s_last);
    return Stretch(
        p, error_p, path.d * share, error_d, vec3<f32>(slack),
        s_first - margin_first, s_last + margin_last, s_first + margin_first, s_last - margin_last,
    );
}

// Sizes of vectors are their largest components here; |d| <= 1 and |v| <= 1. Edges are off by a unit as stored, the third by 3. m is off by
// what was lost of p, by the units of a corner, and by 2 of its size: two differences and an edge.
//
// The side on which the ray passes an edge is the sign of E = e . (d x m). A component of d x m is off by twice the sum of error_m and
// (|m| + error_m) error_d, and by 4 units of |m|. E is off by 3 |e| times that, and by 18 units of |e| |d x m|: three products, each with 3
// units of the edge and 3 of rounding.
// s = N . m / N . d. A component of N is off by 8 units of |e|^2. N . m is off by 3 |m| times that, by error_m times the sum of |N|, and by
// 3 units of |N| |m|; N . d alike. 8 units of s: a quotient, off by 2.5 ulp at most, and the sum below.
fn with_triangle(path: Path, stretch: Stretch, before: Seen, own: BvhTriangle) -> Seen {
    let m0 = own.v - stretch.p;
    let e01 = own.to_next;
    let e20 = own.from_last;
    let e12 = -(e01 + e20);
    let g0 = cross(stretch.d, m0);
    let g1 = cross(stretch.d, m0 + e01);
    let a = dot(e01, g0);
    let b = dot(e20, g0);
    let c = dot(e12, g1);
    let size_e = own.size;
    let size_m = largest_of(m0) + size_e;
    let error_m = UNIT * (CORNER_UNITS + 2.0 * size_m) + stretch.error_p;
    let error_g = 2.0 * (error_m + (size_m + error_m) * stretch.error_d)
        + UNIT * (4.0 * size_m + 6.0 * max(largest_of(g0), largest_of(g1)));
    let bound = 3.0 * size_e * error_g + LEAST;
    let low = min(a, min(b, c));
    let high = max(a, max(b, c));
    let is_inside = low > bound || high < -bound;
    let is_outside = low < -bound && high > bound;

    // where it meets the plane
    let normal = cross(e20, e01);
    let size_n = abs(normal.x) + abs(normal.y) + abs(normal.z);
    let error_n = 24.0 * UNIT * size_e * size_e + LEAST;
    let across = dot(normal, stretch.d);
    let error_across = error_n + size_n * (stretch.error_d + 3.0 * UNIT);
    let error_along = (error_n + 3.0 * UNIT * size_n) * (size_m + error_m) + size_n * error_m;
    let is_across = abs(across) > 2.0 * error_across;
    let s = dot(normal, m0) / across;
    let error_s = (error_along + abs(s) * error_across) / (abs(across) - error_across) + 8.0 * UNIT * abs(s);
    let first = select(-ENDLESS, s - error_s, is_across);
    let last = select(ENDLESS, s + error_s, is_across);

    // a face that does not show, s out of range, or behind what is seen
    let is_back = is_across && (own.word & ONE_SIDED) != 0u && (across < 0.0) == triangle_reversed(vec4<u32>(own.word));
    let id = triangle_id(vec4<u32>(own.word));
    let may = !is_outside && !is_back && last >= stretch.first && first <= last_of(stretch, before)
        && !is_excluded(id) && path.start != id;
    let is_met = may && is_inside && is_across && first >= stretch.inner_first && last <= stretch.inner_last && !ALL_UNCERTAIN;
    let is_nearest = is_met && last < before.first;
    var is_left = may && !is_nearest;
    loop {
        if !is_left {
            break;
        }
        is_left = false;
        let at = atomicAdd(&counters[COUNT_RECHECK_ITEMS], 1u);
        if at < params.recheck_capacity {
            recheck_items[at] = vec2<u32>(own.slot, path.item);
        }
    }
    var seen = before;
    seen.slot = select(seen.slot, own.slot, is_nearest);
    seen.first = select(seen.first, first, is_nearest);
    seen.last = select(seen.last, min(seen.last, last), is_met);
    return seen;
}

fn largest_of(v: vec3<f32>) -> f32 {
    return max(abs(v.x), max(abs(v.y), abs(v.z)));
}

// Leaves what is seen to recheck, which finds its t, and says how many hits recheck will count.
fn keep_seen(path: Path, seen: Seen, pixel: u32) -> u32 {
    atomicAdd(&counters[COUNT_SETTLED], 1u);
    let at = atomicAdd(&counters[COUNT_RECHECK_ITEMS], 1u);
    if at < params.recheck_capacity {
        recheck_items[at] = vec2<u32>(seen.slot | PROVEN, path.item);
    }
    return 1u;
}
