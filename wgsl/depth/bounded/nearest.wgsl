// Tests a triangle against four rays at once, in f32: coverage, proven, and depth, with a bound. What is nearest is left to recheck, which
// finds its t.

#import depth/bounded/column.wgsl
#import depth/column
#import depth/edges.wgsl
#import lanes
#import lanes/together.wgsl
#import nodes/conics.wgsl
#import nodes/slabs.wgsl
#import raster_by_tile.wgsl
#import shared/params.wgsl
#import shared/places.wgsl
#import vertices/still/vertex.wgsl
#import vertices/triangle.wgsl

var<storage, read_write> recheck_items: array<vec2<u32>>;

// What four pixels see: a triangle, the depths between which it is met, and a depth that nothing nearer lies beyond. Depths are s = back t.
struct Nearest {
    slot: vec4<u32>,
    first: vec4<f32>,
    last: vec4<f32>,
}

fn nothing_nearest() -> Nearest {
    return Nearest(vec4<u32>(NONE), vec4<f32>(INFINITE), vec4<f32>(INFINITE));
}

fn lines_of(s: Strip, exists: vec4<bool>) -> Lines {
    return Lines(s.dx, s.dy, s.dz, s.dy * s.pz - s.dz * s.py, s.dz * s.px - s.dx * s.pz, s.dx * s.py - s.dy * s.px);
}

// Of a tile: the largest size of p, which no q = d x p exceeds, as |d| <= 1, and the largest errors of p, q and d.
struct Reach {
    p: f32,
    error_p: f32,
    error_q: f32,
    error_d: f32,
}

fn largest4(v: vec4<f32>) -> f32 {
    return max(max(v.x, v.y), max(v.z, v.w));
}

// A thousandth more is for products of errors, and for what bounds lose themselves.
const MORE: f32 = 1.001;

// q is off by what p and d lost, and by 4 units.
fn strip_reach(s: Strip) -> Reach {
    let size_p = size4(s.px, s.py, s.pz);
    let error_q = s.error_p + s.error_d * (size_p + s.error_p) + 4.0 * UNIT * size_p;
    return Reach(largest4(size_p), MORE * largest4(s.error_p), MORE * largest4(error_q), MORE * largest4(s.error_d));
}

fn tile_reach(column: Column, upper: Lines, lower: Lines, lane: u32) -> Reach {
    let a = strip_reach(column.upper);
    let b = strip_reach(column.lower);
    return Reach(
        lanes_max(max(a.p, b.p), lane), lanes_max(max(a.error_p, b.error_p), lane),
        lanes_max(max(a.error_q, b.error_q), lane), lanes_max(max(a.error_d, b.error_d), lane),
    );
}

// From the corner m along e, of triangles that reach so far. m is off by 2 units and e by 3, a cross product by 4 of both sizes, three
// products and three sums by 5, scaling by 2: 18 of |m| |e|, as |d| <= 1, and 14 of |e| |q|; then what d and q lost. The side is that of
// the perturbed ray: its d changes (d x m)' by |m| times d's change, its origin by the origin's change.
fn edge_from(m: vec3<f32>, e: vec3<f32>, reach: Reach, far: f32) -> Edge {
    let size_m = size(m);
    let size_e = size(e);
    let lost = size_e * (size_m * reach.error_d + reach.error_q);
    let error = STORED_UNIT * far * (size_e + size_m + reach.p) + PERTURB_BOUND * size_e * (size_m + params.scene_size);
    let bound = UNIT * size_e * (18.0 * size_m + 14.0 * reach.p) + lost + error + LEAST * (2.0 + size_m + reach.p);
    let fits = size_e * (size_m + reach.p) < MOST;
    // an edge of 0 proves nothing, and infinities times 0 would be NaN
    let share = 1.0 / bound;
    return Edge(select(vec3<f32>(0.0), cross(m, e) * share, fits), select(vec3<f32>(0.0), e * share, fits));
}

// A triangle's values that all lanes share.
struct Shared {
    a: Edge,
    b: Edge,
    c: Edge,
    normal: vec3<f32>,
    height: f32,            // N . v
    error_height: f32,      // of N . (v - p)
    error_across: f32,      // of N . d
    back_sign: f32,
    id: u32,
    slot: u32,
}

// The values of lane k.
fn given(own: Shared, k: u32) -> Shared {
    let place = subgroup_lane(k);
    return Shared(
        Edge(subgroupShuffle(own.a.c, place), subgroupShuffle(own.a.e, place)),
        Edge(subgroupShuffle(own.b.c, place), subgroupShuffle(own.b.e, place)),
        Edge(subgroupShuffle(own.c.c, place), subgroupShuffle(own.c.e, place)),
        subgroupShuffle(own.normal, place),
        subgroupShuffle(own.height, place),
        subgroupShuffle(own.error_height, place),
        subgroupShuffle(own.error_across, place),
        subgroupShuffle(own.back_sign, place),
        subgroupShuffle(own.id, place),
        subgroupShuffle(own.slot, place),
    );
}

// Sizes of what may be met are less than this, and N . (v - p) is finite.
const FAR_MOST: f32 = 1.0e30;

// What the lanes will share of a triangle, the first words of whose corners are hi. Edges are divided by a power of two,
// so that N is at most 1. N is off by 10 units, as edges are by 3 and a cross product by 4; N . (v - p) and N . d by what N, p, v and d
// lost, and by 6 and 3 units of |N|. A quarter more on both bounds: where N . d is at least 8 of its own, their quotient needs a seventh.
fn triangle_shared(slot: u32, triangle: vec4<u32>, hi: array<vec3<f32>, 3>, node: Node, reach: Reach) -> Shared {
    let lo = array<vec3<f32>, 3>(vertex_lo(triangle.x), vertex_lo(triangle.y), vertex_lo(triangle.z));
    let m0 = (hi[0] - node.p) + lo[0];
    let m1 = (hi[1] - node.p) + lo[1];
    let e01 = (hi[1] - hi[0]) + (lo[1] - lo[0]);
    let e20 = (hi[0] - hi[2]) + (lo[0] - lo[2]);
    let e12 = (hi[2] - hi[1]) + (lo[2] - lo[1]);
    let far = max(size(hi[0]), max(size(hi[1]), size(hi[2]))) + size(node.p);
    let size_m = size(m0) + reach.p;
    let exponent = clamp(bitcast<u32>(max(size(e01), size(e20))) >> 23u, 1u, 252u);
    let share = select(0.0, bitcast<f32>((253u - exponent) << 23u), size_m < FAR_MOST);
    let normal = cross(e20 * share, e01 * share);
    let size_n = size(normal);
    let stored = STORED_UNIT * far;
    let error_n = 10.0 * UNIT + 4.0 * stored * share;
    let error_height = size_m * (error_n + 6.0 * UNIT * size_n) + size_n * (reach.error_p + stored) + LEAST;
    let error_across = error_n + size_n * (reach.error_d + 3.0 * UNIT) + LEAST;
    let facing = select(1.0, -1.0, triangle_reversed(triangle));
    return Shared(
        edge_from(m0, e01, reach, far),
        edge_from(m0, e20, reach, far),
        edge_from(m1, e12, reach, far),
        normal,
        dot(normal, m0),
        1.25 * error_height,
        1.25 * error_across,
        select(0.0, facing, (triangle.w & ONE_SIDED) != 0u),
        triangle_id(triangle),
        slot,
    );
}

struct Found {
    nearest: Nearest,
    uncertain: vec4<bool>,
    met: vec4<bool>,
}

// Tests a triangle against four rays. What may be met and is not proven to be the nearest is uncertain, unless what is proven hides it.
fn test_pixels(f: Shared, l: Lines, s: Strip, exists: vec4<bool>, starts: vec4<u32>, before: Nearest) -> Found {
    let a = along(f.a, l);
    let b = along(f.b, l);
    let c = along(f.c, l);
    let least = min(a, min(b, c));
    let most = max(a, max(b, c));
    let inside = (least > vec4<f32>(1.0)) | (most < vec4<f32>(-1.0));
    let outside = (least < vec4<f32>(-1.0)) & (most > vec4<f32>(1.0));

    // between which depths its plane is met
    let across = f.normal.x * l.dx + f.normal.y * l.dy + f.normal.z * l.dz;
    let is_across = abs(across) > vec4<f32>(8.0 * f.error_across);
    let share = 1.0 / across;
    let depth = (f.height - (f.normal.x * s.px + f.normal.y * s.py + f.normal.z * s.pz)) * share;
    let error = (f.error_height + abs(depth) * f.error_across) * abs(share) + 8.0 * UNIT * abs(depth);
    let first = select(vec4<f32>(-INFINITE), depth - error, is_across);
    let last = select(vec4<f32>(INFINITE), depth + error, is_across);

    // hits nearer than `more` to an end of the range may count as hits at it: END_BOUND; in a chain end_rounding / |N . d|, which is less than a
    // 256th, but for triangles almost edge-on, whose t is rounding alone
    let from_depth = clamp((params.t_min.x + params.t_min.y + params.t_min.z) * s.back, vec4<f32>(-INFINITE), vec4<f32>(INFINITE));
    let to_depth = clamp((params.t_max.x + params.t_max.y + params.t_max.z) * s.back, vec4<f32>(-INFINITE), vec4<f32>(INFINITE));
    let more = select(vec4<f32>(END_BOUND * params.scene_size), 0.00390625 * (to_depth - from_depth), SLABBED);
    let margin_from = more + 8.0 * UNIT * abs(from_depth);
    let margin_to = more + 8.0 * UNIT * abs(to_depth);

    let is_back = is_across & (across * f.back_sign > vec4<f32>(0.0));
    let is_in_reach = (last >= from_depth - margin_from) & (first <= to_depth + margin_to) & (first <= before.last);
    let may = exists & is_in_reach & (starts != vec4<u32>(f.id)) & !(outside | is_back);
    let met = may & inside & is_across & (first >= from_depth + margin_from) & (last <= to_depth - margin_to);
    let is_nearest = met & (last < before.first);
    let nearest = Nearest(
        select(before.slot, vec4<u32>(f.slot), is_nearest),
        select(before.first, first, is_nearest),
        select(before.last, min(before.last, last), met),
    );
    return Found(nearest, may & !is_nearest, met & is_nearest);
}

// No t of four pixels' nearest is larger: of none without a ray.
fn farthest(nearest: Nearest, s: Strip, exists: vec4<bool>) -> f32 {
    let most = largest4(select(vec4<f32>(-INFINITE), nearest.last / s.back, exists));
    return most + 8.0 * UNIT * abs(most);
}

// Leaves what a column of a tile sees to recheck, and says of how many pixels.
fn keep_nearest(tile: u32, lane: u32, pixels: vec4<u32>, upper: Nearest, lower: Nearest) -> u32 {
    let has_upper = select(vec4<u32>(0u), vec4<u32>(1u), upper.slot != vec4<u32>(NONE));
    let has_lower = select(vec4<u32>(0u), vec4<u32>(1u), lower.slot != vec4<u32>(NONE));
    let count_upper = has_upper.x + has_upper.y + has_upper.z + has_upper.w;
    let count = count_upper + has_lower.x + has_lower.y + has_lower.z + has_lower.w;
    if count == 0u {
        return 0u;
    }
    atomicAdd(&counters[COUNT_PROVEN], count);
    let at = take_places(COUNT_RECHECK_ITEMS, count);
    leave_proven(at, (tile << 6u) | lane, upper.slot, has_upper);
    leave_proven(at + count_upper, (tile << 6u) | (4u * TILE + lane), lower.slot, has_lower);
    return count;
}

fn leave_proven(first: u32, item: u32, slots: vec4<u32>, has: vec4<u32>) {
    let places = first + vec4<u32>(0u, has.x, has.x + has.y, has.x + has.y + has.z);
    for (var k = 0u; k < 4u; k++) {
        if has[k] != 0u && places[k] < params.recheck_capacity {
            recheck_items[places[k]] = vec2<u32>(slots[k] | PROVEN, item + TILE * k);
        }
    }
}
