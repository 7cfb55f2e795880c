// The path of a pixel in a layer: one straight ray, about a scene none of whose coordinates is larger than 1.

#import nodes/slabs.wgsl
#import rays/coverage
#import shared/params.wgsl
#import vertices/vertex

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

fn last_of(stretch: Stretch, seen: Seen) -> f32 {
    return min(stretch.last, seen.last);
}

// The ray in f32 about the origin of the hierarchy, its direction of size 1/2 to 1: the sum loses a unit. The slack: what is lost of P, and of D on the way to the farthest box, as |s| is at most
// (1 + |P|) / (1/2 - error_d). Then 24 units of the largest distance, 29 where corners move: those of corners, 8 for the grid of boxes, which is computed in
// f32; here 1 for the way to its origin, 5 for 1 / d, and 7 for two products and two sums of twice that distance at most.
fn stretch_of(path: Path, k: u32, scale: f32) -> Stretch {
    let p = (path.p + params.bvh_offset) * scale;
    let exponent = clamp(bitcast<u32>(largest_of(path.d)) >> 23u, 1u, 252u);
    // a power of two that brings d under 1, and its inverse
    let share = bitcast<f32>((253u - exponent) << 23u);
    let back = bitcast<f32>((exponent + 1u) << 23u);
    // coverage is decided on the perturbed ray
    let error_p = path.error_p * scale + UNIT * largest_of(p) + PERTURB_BOUND * params.scene_size * scale + LEAST;
    let error_d = select(path.error_d * share, ENDLESS, path.error_d >= ENDLESS) + PERTURB_BOUND + LEAST;
    let far = 1.0 + largest_of(p) + error_p;
    let slack = min(error_p + far * (error_d / max(0.5 - error_d, LEAST) + (23.0 + CORNER_UNITS) * UNIT), ENDLESS);
    // ends that are infinite lie at ENDLESS
    let t_share = scale * back;
    let s_first = clamp((params.t_min.x + params.t_min.y + params.t_min.z) * t_share, -ENDLESS, ENDLESS);
    let s_last = clamp((params.t_max.x + params.t_max.y + params.t_max.z) * t_share, -ENDLESS, ENDLESS);
    // hits nearer than `more` to an end may count as hits at it: END_BOUND; in a chain end_rounding / |N . d|, which is less than a 256th, but for
    // triangles almost edge-on, whose t is rounding alone
    let more = select(END_BOUND * params.scene_size * scale, 0.00390625 * (s_last - s_first), SLABBED);
    let margin_first = more + slack + 4.0 * UNIT * abs(s_first);
    let margin_last = more + slack + 4.0 * UNIT * abs(s_last);
    return Stretch(
        p, error_p, path.d * share, error_d, vec3<f32>(slack),
        s_first - margin_first, s_last + margin_last, s_first + margin_first, s_last - margin_last,
    );
}

fn largest_of(v: vec3<f32>) -> f32 {
    return max(abs(v.x), max(abs(v.y), abs(v.z)));
}
