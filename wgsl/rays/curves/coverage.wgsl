// Which pixels' curves may meet a triangle over a span of t, by their control nets.

#import nodes/slabs.wgsl
#import rays/curves/curve.wgsl
#import rays/curves/meeting.wgsl
#import shared/bits.wgsl
#import shared/params.wgsl
#import vertices/vertex

// Coverage is proven if true; else it is possible.
const COVERAGE_PROVES: bool = false;

// Rounding of one f32 operation, relative.
const UNIT: f32 = 1.0 / 16777216.0;

// Error of results below the least normal number, which an adapter may flush to 0: 2^-126 an operation, of hundreds of them.
const LEAST: f32 = 1.0e-35;

// Sums of products of sizes beyond this may overflow: a bound on them becomes infinite, and nothing is proven.
const MOST: f32 = 1.0e36;

fn span_of(tile: u32) -> vec2<u32> {
    let span = tile_slab(tile) % params.spans;
    return vec2<u32>(span, span + 1u);
}

// The Bernstein coefficients of a polynomial over a span of t: its blossoms, sums of the old ones with weights in [0, 1].
fn over_span(b: vec4<f32>, span: vec2<f32>) -> vec4<f32> {
    if DEGREE == 1u {
        let r = b.x + span * (b.y - b.x);
        return vec4<f32>(r.x, r.y, r.x, r.y);
    }
    let lo = b + span.x * (b.yzww - b);
    let hi = b + span.y * (b.yzww - b);
    if DEGREE == 2u {
        let q = vec3<f32>(lo.x + span.x * (lo.y - lo.x), lo.x + span.y * (lo.y - lo.x), hi.x + span.y * (hi.y - hi.x));
        return q.xyzx;
    }
    let lolo = lo.xy + span.x * (lo.yz - lo.xy);
    let lohi = lo.xy + span.y * (lo.yz - lo.xy);
    let hihi = hi.xy + span.y * (hi.yz - hi.xy);
    return vec4<f32>(
        lolo.x + span.x * (lolo.y - lolo.x),
        lolo.x + span.y * (lolo.y - lolo.x),
        lohi.x + span.y * (lohi.y - lohi.x),
        hihi.x + span.y * (hihi.y - hihi.x),
    );
}

// The control points less a vertex along one direction, over the span.
fn along(net: array<vec3<f32>, 4>, v: vec3<f32>, n: vec3<f32>, span: vec2<f32>) -> vec4<f32> {
    return over_span(vec4<f32>(dot(net[0] - v, n), dot(net[1] - v, n), dot(net[2] - v, n), dot(net[3] - v, n)), span);
}

fn least(b: vec4<f32>) -> f32 {
    return min(min(b.x, b.y), min(b.z, b.w));
}

fn largest(b: vec4<f32>) -> f32 {
    return max(max(b.x, b.y), max(b.z, b.w));
}

// The control points of a curve; those above its degree repeat the last.
fn control_net(place: u32) -> array<vec3<f32>, 4> {
    var net = array<vec3<f32>, 4>(control_point(place, 0u), control_point(place, 1u), vec3<f32>(0.0), vec3<f32>(0.0));
    net[2] = net[1];
    if DEGREE >= 2u {
        net[2] = control_point(place, 2u);
    }
    net[3] = net[2];
    if DEGREE >= 3u {
        net[3] = control_point(place, 3u);
    }
    return net;
}

// Whether a curve with this control net may meet a triangle over a span of t: not if a side of the triangle separates them. `stored` is the
// largest coordinate that control points were rounded at before they were moved, 0 if they were not.
fn net_may_meet(net: array<vec3<f32>, 4>, stored: f32, span: vec2<f32>, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> bool {
    let e0 = v1 - v0;
    let e1 = v2 - v1;
    let e2 = v0 - v2;
    let n = cross(e0, -e2);
    let size_e = max(length(e0), max(length(e1), length(e2)));
    // an edge: two stored vertices and a difference, 4 units of the largest; N: two edges and a product; N x e: once more
    let reach_v = corner_reach(max(length(v0), max(length(v1), length(v2))));
    let lost_e = 4.0 * UNIT * (reach_v + size_e);
    let lost_n = 4.0 * size_e * lost_e;
    let lost_m = 2.0 * size_e * lost_n + 2.0 * length(n) * lost_e;
    // how large the factors are that a product has, and what the control points and a vertex lost when stored
    let reach = reach_v + stored + max(max(length(net[0]), length(net[1])), max(length(net[2]), length(net[3])));
    let size = reach * length(n);
    let beyond = select(MOST, 1.0, size < MOST && size * size_e < MOST);
    let error_n = beyond * (2.0 * reach * lost_n + 12.0 * UNIT * size + LEAST * (1.0 + reach));
    let error_m = beyond * (2.0 * reach * lost_m + 12.0 * UNIT * size * size_e + LEAST * (1.0 + reach) * (1.0 + size_e));
    let plane = along(net, v0, n, span);
    var separated = least(plane) > error_n || largest(plane) < -error_n;
    separated = separated || largest(along(net, v0, cross(n, e0), span)) < -error_m;
    separated = separated || largest(along(net, v1, cross(n, e1), span)) < -error_m;
    separated = separated || largest(along(net, v2, cross(n, e2), span)) < -error_m;
    return !separated;
}

// Pixels that may be covered, as two words, then two words of 0. There is one owned pixel; it is excluded if a side of the triangle
// separates the triangle from the curve's control net over the span. The hit test decides coverage, so nothing is left to recheck.
fn coverage(
    cell: Cell,
    owned: vec2<u32>,
    from_px: vec2<u32>,
    to_px: vec2<u32>,
    v0: vec3<f32>,
    v1: vec3<f32>,
    v2: vec3<f32>,
) -> vec4<u32> {
    let corner = tile_corner(cell.tile);
    let layer = tile_layer(cell.tile);
    let span = vec2<f32>(span_of(cell.tile)) / f32(params.spans);
    var may = vec2<u32>(0u);
    var left = owned;
    loop {
        let bit = first_bit(left);
        left = without_bit(left, bit);
        let place = curve_place(layer, corner.x + bit % TILE, corner.y + bit / TILE);
        let net = control_net(place);
        if net_may_meet(net, 0.0, span, v0, v1, v2) {
            may = with_bit(may, bit);
        }
        if all(left == vec2<u32>(0u)) {
            break;
        }
    }
    return vec4<u32>(may, 0u, 0u);
}
