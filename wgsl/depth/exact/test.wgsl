// Tests a triangle against four rays at once: coverage, proven by f32, and depth, in recheck arithmetic.

#import arithmetic
#import arithmetic/f64.wgsl
#import depth/column
#import depth/edges.wgsl
#import lanes
#import nodes/conics.wgsl
#import nodes/slabs.wgsl
#import shared/params.wgsl
#import vertices/triangle.wgsl

// Beyond all t.
const FARTHEST: real = 1.0e300;

fn lines_of(s: Strip, exists: vec4<bool>) -> Lines {
    let share = 1.0 / (abs(s.dx) + abs(s.dy) + abs(s.dz) + select(real4(1.0), real4(0.0), exists));
    let dx = s.dx * share;
    let dy = s.dy * share;
    let dz = s.dz * share;
    return Lines(
        vec4<f32>(dx), vec4<f32>(dy), vec4<f32>(dz),
        vec4<f32>(dy * s.pz - dz * s.py), vec4<f32>(dz * s.px - dx * s.pz), vec4<f32>(dx * s.py - dy * s.px),
    );
}

// The largest sum of absolute components of the cross products.
fn reach_of(l: Lines) -> f32 {
    let q = abs(l.qx) + abs(l.qy) + abs(l.qz);
    return max(max(q.x, q.y), max(q.z, q.w));
}

// From the corner m along e, of triangles that reach so far. m and e as rounded 1 unit each, a cross product 4 of both sizes, d and q
// 1 each, six products and five sums 8, and a unit for the scaling: 16 of |m| |e|, as |d| <= 1, and 12 of |e| |q|. The side is that of the
// perturbed ray: its d changes (d x m)' by |m| times d's change, its origin by the origin's change.
fn edge_from(m: vec3<f32>, e: vec3<f32>, reach_q: f32, reach: f32) -> Edge {
    let size_m = size(m);
    let size_e = size(e);
    let error = STORED_UNIT * reach * (size_e + size_m + reach_q) + PERTURB_BOUND * size_e * (size_m + params.scene_size);
    let bound = UNIT * size_e * (16.0 * size_m + 12.0 * reach_q) + error + LEAST * (2.0 + size_m + reach_q);
    let fits = size_e * (size_m + reach_q) < MOST;
    // an edge of 0 proves nothing, and infinities times 0 would be NaN
    let share = 1.0 / bound;
    return Edge(select(vec3<f32>(0.0), cross(m, e) * share, fits), select(vec3<f32>(0.0), e * share, fits));
}

// A triangle's values that all lanes share.
struct Shared {
    a: Edge,
    b: Edge,
    c: Edge,
    normal: real3,
    height: real,       // N . v
    back_sign: real,
    id: u32,
}

// The value of one lane.
fn lanes_real(value: real, lane: u32) -> real {
    let words = real_to_bits(value);
    return real_from_bits(vec2<u32>(subgroupShuffle(words.x, subgroup_lane(lane)), subgroupShuffle(words.y, subgroup_lane(lane))));
}

// The values of lane k.
fn given(own: Shared, k: u32) -> Shared {
    let place = subgroup_lane(k);
    return Shared(
        Edge(subgroupShuffle(own.a.c, place), subgroupShuffle(own.a.e, place)),
        Edge(subgroupShuffle(own.b.c, place), subgroupShuffle(own.b.e, place)),
        Edge(subgroupShuffle(own.c.c, place), subgroupShuffle(own.c.e, place)),
        real3(lanes_real(own.normal.x, k), lanes_real(own.normal.y, k), lanes_real(own.normal.z, k)),
        lanes_real(own.height, k),
        lanes_real(own.back_sign, k),
        subgroupShuffle(own.id, place),
    );
}

// What four pixels see, as keys of depth: see depth_key.
struct Nearest {
    keys: real4,
}

fn nothing_nearest() -> Nearest {
    return Nearest(real4(FARTHEST));
}

// How far from an end of t_range, in t, a hit may lie that counts as a hit at it. In a chain end_rounding / |N . d| is less than a 256th, but
// for triangles whose sine to the ray is below 2^-36 (|v| + |p| + |d|) / |d|: their t is rounding alone.
fn end_reach(s: Strip, t_min: real, t_max: real) -> real4 {
    let of_chain = real4(0.00390625 * (t_max - t_min));
    let size_d = abs(s.dx) + abs(s.dy) + abs(s.dz);
    return select(real(END_BOUND * params.scene_size) / size_d, of_chain, vec4<bool>(SLABBED));
}

struct Found {
    nearest: Nearest,
    uncertain: vec4<bool>,
    met: vec4<bool>,
}

// Tests a triangle against four rays. What may count as a hit at an end of t_range is uncertain.
fn test_pixels(f: Shared, l: Lines, s: Strip, exists: vec4<bool>, starts: vec4<u32>, before: Nearest) -> Found {
    let a = along(f.a, l);
    let b = along(f.b, l);
    let c = along(f.c, l);
    let least = min(a, min(b, c));
    let most = max(a, max(b, c));
    let inside = (least > vec4<f32>(1.0)) | (most < vec4<f32>(-1.0));
    let outside = (least < vec4<f32>(-1.0)) & (most > vec4<f32>(1.0));
    let across = f.normal.x * s.dx + f.normal.y * s.dy + f.normal.z * s.dz;
    let t_min = real_from_bits(params.t_words.xy);
    let t_max = real_from_bits(params.t_words.zw);
    let height = f.height - (f.normal.x * s.px + f.normal.y * s.py + f.normal.z * s.pz);
    let t = height / across;
    let reach = end_reach(s, t_min, t_max);
    let in_range = (t > t_min + reach) & (t < t_max - reach);
    let at_end = (t >= t_min - reach) & (t <= t_max + reach) & !in_range;
    let is_shown = (across != real4(0.0)) & (across * f.back_sign <= real4(0.0)) & (starts != vec4<u32>(f.id));
    let met = inside & exists & is_shown & in_range;
    let keys = real4(depth_key(t.x, f.id), depth_key(t.y, f.id), depth_key(t.z, f.id), depth_key(t.w, f.id));
    return Found(Nearest(select(before.keys, keys, met & (keys < before.keys))), exists & !outside & (at_end | !inside), met);
}

// Low bits of t that the id replaces.
fn key_mask() -> u64 {
    return (1lu << select(params.id_bits, params.id_bits + 2u, SLABBED)) - 1lu;
}

// The least normal number, 2^-1022, and its bits. It stands for t = 0: an id in the last bits of 0 would be a subnormal number, which an
// adapter may flush to 0, and -0 must not count as negative.
const LEAST_NORMAL: real = 2.2250738585072014e-308;
const LEAST_NORMAL_BITS: u64 = 0x0010000000000000lu;

// t with the id in place of its last bits, as a number: of what is equal but for these the smaller id is the nearer.
fn depth_key(t: real, id: u32) -> real {
    let is_zero = abs(t) < LEAST_NORMAL;
    let bits = select(bitcast<u64>(t), LEAST_NORMAL_BITS, is_zero);
    let low = select(u64(id), key_mask() - u64(id), t < 0.0 && !is_zero);
    return bitcast<f64>((bits & ~key_mask()) | low);
}

// The complemented visibility key of a depth key, 0 of none.
fn complemented_key(layer: u32, key: real) -> vec2<u32> {
    var bits = ordered_bits(key);
    // t = 0
    bits.y = select(bits.y, 0x80000000u, bits.y == 0x80100000u);
    let mask = vec2<u32>(u32(key_mask() & 0xfffffffflu), u32(key_mask() >> 32u));
    let id = bits.x & mask.x;
    if SLABBED {
        bits = vec2<u32>((bits.x >> 2u) | (bits.y << 30u), ((bits.y & 0x3fffffffu) >> 2u) | (layer << 28u));
    }
    return select(vec2<u32>(0u), ~vec2<u32>((bits.x & ~((1u << params.id_bits) - 1u)) | id, bits.y), key < FARTHEST);
}

// The shared values of a triangle from its corners in f64. No corner is farther than `reach` from the centre; reach_of the lines is at
// most reach_q.
fn shared_of(triangle: vec4<u32>, v0: real3, v1: real3, v2: real3, centre: real3, reach: f32, reach_q: f32) -> Shared {
    let m0 = vec3<f32>(v0 - centre);
    let m1 = vec3<f32>(v1 - centre);
    let normal = cross(v1 - v0, v2 - v0);
    let facing = select(real(1.0), real(-1.0), triangle_reversed(triangle));
    return Shared(
        edge_from(m0, vec3<f32>(v1 - v0), reach_q, reach),
        edge_from(m0, vec3<f32>(v0 - v2), reach_q, reach),
        edge_from(m1, vec3<f32>(v2 - v1), reach_q, reach),
        normal,
        dot(normal, v0 - centre),
        select(real(0.0), facing, (triangle.w & ONE_SIDED) != 0u),
        triangle_id(triangle),
    );
}
