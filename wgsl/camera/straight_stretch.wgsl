// The path of a pixel in a layer: one straight ray, about a scene none of whose coordinates is larger than 1; and what it meets, to f32.
// Provides: ENDLESS, Seen, Stretch, is_seen, key_of, last_of, nothing_seen, stretch_of, stretches, with_triangle
// Needs: BvhTriangle, COUNT_RECHECK_ITEMS, LEAST, NONE, ONE_SIDED, PERTURB_BOUND, Path, SLABBED, UNIT, is_excluded, path_depth, real3,
//   tile_layer, triangle_at, triangle_id, triangle_reversed, vertex_real, visibility_key
// Binds: counters, params, recheck_items

// Nothing is proven.
override ALL_UNCERTAIN: bool = false;

const ENDLESS: f32 = 1.0e30;

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

// The ray in f32, its direction of about size 1. Rounding: what was lost of P, and of D up to the farthest box; then of the way to a box,
// of that to a plane of its grid, and of its share, 24 units of the largest distance.
fn stretch_of(path: Path, k: u32, scale: f32) -> Stretch {
    let p = path.p * scale;
    let exponent = clamp(bitcast<u32>(largest_of(path.d)) >> 23u, 1u, 252u);
    // a power of two that brings d under 1, and its inverse
    let share = bitcast<f32>((253u - exponent) << 23u);
    let back = bitcast<f32>((exponent + 1u) << 23u);
    let error_p = path.error_p * scale + LEAST;
    let error_d = path.error_d * share + LEAST;
    let slack = error_p + (1.0 + largest_of(p)) * (2.0 * error_d + 24.0 * UNIT + 2.0 * PERTURB_BOUND);
    let t_share = scale * back;
    let t_first = params.t_min.x + params.t_min.y + params.t_min.z;
    let t_last = params.t_max.x + params.t_max.y + params.t_max.z;
    // in a chain what lies a little beyond an end may count as on it
    let more = select(0.0, 0.00390625, SLABBED) * (t_last - t_first);
    let first = (more + 4.0 * UNIT * abs(t_first)) * t_share;
    let last = (more + 4.0 * UNIT * abs(t_last)) * t_share;
    return Stretch(
        p, error_p, path.d * share, error_d, vec3<f32>(slack),
        t_first * t_share - first - slack, t_last * t_share + last + slack,
        t_first * t_share + first + slack, t_last * t_share - last - slack,
    );
}

// Sizes of vectors are their largest components here; |d| <= 1 and |v| <= 1. A corner and d are off by what was lost of them, edges as
// stored by a unit, the third by 3, and m by error_m.
//
// The ray passes an edge on the side that E = e . (d x m) tells. A component of d x m is off by 2 (error_m + |m| error_d) and 4 units of
// |m|; E by 3 |e| times that, and by 18 units of |e| |d x m|: 3 products, each with 3 units of the edge and 3 of rounding.
// s = N . m / N . d: a component of N is off by 8 units of |e|^2; N . m by 3 |m| times that, by the sum of |N| times error_m, and by 3 units
// of the products' sum; N . d likewise.
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
    let size_e = largest_of(abs(e01) + abs(e20));
    let size_m = largest_of(m0) + size_e;
    let error_m = UNIT * (1.0 + size_m) + stretch.error_p;
    let error_g = 2.0 * (error_m + size_m * stretch.error_d) + UNIT * (4.0 * size_m + 6.0 * max(largest_of(g0), largest_of(g1)));
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
    let error_along = error_n * size_m + size_n * (error_m + 3.0 * UNIT * size_m);
    let is_across = abs(across) > 2.0 * error_across;
    let s = dot(normal, m0) / across;
    let error_s = (error_along + abs(s) * error_across) / (abs(across) - error_across) + 4.0 * UNIT * abs(s);
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

// The complemented key of the triangle that is seen.
fn key_of(path: Path, seen: Seen) -> vec2<u32> {
    let triangle = triangle_at(seen.slot);
    let v = array<real3, 3>(vertex_real(triangle.x), vertex_real(triangle.y), vertex_real(triangle.z));
    let normal = cross(v[1] - v[0], v[2] - v[0]);
    let t = path_depth(path, normal, v, seen.slot);
    return ~visibility_key(tile_layer(path.item >> 6u), t, triangle_id(triangle));
}
