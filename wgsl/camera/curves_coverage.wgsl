// Where a pixel's curve meets a triangle first: the roots of N . (X(t) - v) over a span of t, which is a polynomial of
// the curve's degree, that lie inside.

// Rounding of one f32 operation, relative.
const UNIT: f32 = 1.0 / 16777216.0;

fn span_of(tile: u32) -> vec2<u32> {
    let span = tile_sheet(tile) % params.spans;
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

// The owned pixels whose control net over the span no side of the triangle parts from it: two words; and two of none.
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
    let e0 = v1 - v0;
    let e1 = v2 - v1;
    let e2 = v0 - v2;
    let n = cross(e0, -e2);
    let size_e = max(length(e0), max(length(e1), length(e2)));
    // an edge: two stored vertices and a difference, 4 units of reach; N: two edges and a product; N x e: once more
    let lost_e = 4.0 * UNIT * (params.vertex_reach + size_e);
    let lost_n = 4.0 * size_e * lost_e;
    let lost_m = 2.0 * size_e * lost_n + 2.0 * length(n) * lost_e;
    var may = vec2<u32>(0u);
    var left = owned;
    loop {
        let bit = first_bit(left);
        if bit == NONE {
            break;
        }
        left = without_bit(left, bit);
        let place = curve_place(layer, corner.x + bit % TILE, corner.y + bit / TILE);
        var net = array<vec3<f32>, 4>(control_point(place, 0u), control_point(place, 1u), vec3<f32>(0.0), vec3<f32>(0.0));
        net[2] = net[1];
        if DEGREE >= 2u {
            net[2] = control_point(place, 2u);
        }
        net[3] = net[2];
        if DEGREE >= 3u {
            net[3] = control_point(place, 3u);
        }
        // how large the factors are that a product has, and what the control points and a vertex lost when stored
        let reach = params.vertex_reach + max(max(length(net[0]), length(net[1])), max(length(net[2]), length(net[3])));
        let slack_n = 2.0 * reach * lost_n + 12.0 * UNIT * reach * length(n);
        let slack_m = 2.0 * reach * lost_m + 12.0 * UNIT * reach * length(n) * size_e;
        let plane = along(net, v0, n, span);
        var apart = least(plane) > slack_n || largest(plane) < -slack_n;
        apart = apart || largest(along(net, v0, cross(n, e0), span)) < -slack_m;
        apart = apart || largest(along(net, v1, cross(n, e1), span)) < -slack_m;
        apart = apart || largest(along(net, v2, cross(n, e2), span)) < -slack_m;
        if !apart {
            may = with_bit(may, bit);
        }
    }
    return vec4<u32>(may, 0u, 0u);
}

// Whether a curve meets the triangle is found with where: nothing to settle before.
fn settled(cell: Cell, whole: Bundle, found: vec4<u32>, v0: real3, v1: real3, v2: real3) -> vec2<u32> {
    return found.xy;
}

// Curves have no bundle.
fn cell_bundle(cell: Cell) -> Bundle {
    let z = real3(0.0);
    return Bundle(z, z, z, z, z, z, real(1.0), real(0.0), real(0.0));
}

struct CellDepth {
    normal: real3,
    v: array<real3, 3>,
    hidden: real,
}

fn cell_depth(whole: Bundle, normal: real3, v: array<real3, 3>, hidden: real) -> CellDepth {
    return CellDepth(normal, v, hidden);
}

// The first visible meeting over the span. Between its critical points the polynomial has one root or none.
fn pixel_depth(q: CellDepth, cell: Cell, x: u32, y: u32) -> Meeting {
    let corner = tile_corner(cell.tile);
    let c = curve_stored(curve_place(tile_layer(cell.tile), corner.x + x, corner.y + y));
    let b = real4(dot(q.normal, c.c0 - q.v[0]), dot(q.normal, c.c1 - q.v[0]), dot(q.normal, c.c2 - q.v[0]), dot(q.normal, c.c3 - q.v[0]));
    let sizes = real(params.vertex_reach) + max(max(size3(c.c0), size3(c.c1)), max(size3(c.c2), size3(c.c3)));
    // stored numbers, differences and two products: 16 units of what is summed up
    let lost = 16.0 * REAL_UNIT * sizes;
    let bound = size3(q.normal) * lost;
    let span = vec2<f32>(span_of(cell.tile));
    let spans = real(f32(params.spans));
    let end = real(span.y) / spans;
    var from_t = real(span.x) / spans;
    let turns = critical_points(b, from_t, end);
    var from_value = polynomial(b, from_t);
    for (var k = 0u; k < DEGREE; k++) {
        let to_t = select(turns[min(k, 1u)], end, k + 1u == DEGREE);
        let to_value = polynomial(b, to_t);
        if abs(from_value) <= bound {
            let at = meeting_at(q, c, from_t, lost, bound);
            if at.visible {
                return at;
            }
        }
        if (from_value < 0.0 && to_value > 0.0) || (from_value > 0.0 && to_value < 0.0) {
            let at = meeting_at(q, c, root_between(b, from_t, to_t, from_value < 0.0), lost, bound);
            if at.visible {
                return at;
            }
        }
        from_t = to_t;
        from_value = to_value;
    }
    if abs(from_value) <= bound {
        return meeting_at(q, c, end, lost, bound);
    }
    return Meeting(0.0, false);
}

fn polynomial(b: real4, t: real) -> real {
    return dot(bernstein(DEGREE, t), b);
}

// The first DEGREE - 1 are where the polynomial may turn in (lo, hi), in order; those that do not exist are at an end.
fn critical_points(b: real4, lo: real, hi: real) -> array<real, 2> {
    if DEGREE == 1u {
        return array<real, 2>(lo, lo);
    }
    let d0 = b.y - b.x;
    let d1 = b.z - b.y;
    if DEGREE == 2u {
        let t = select(lo, d0 / (d0 - d1), d0 != d1);
        return array<real, 2>(min(max(t, lo), hi), hi);
    }
    // d0 + 2 t (d1 - d0) + t^2 (d0 - 2 d1 + d2) = 0
    let a = d0 - 2.0 * d1 + (b.w - b.z);
    let h = d1 - d0;
    let discriminant = h * h - a * d0;
    if discriminant < 0.0 {
        return array<real, 2>(lo, lo);
    }
    let root = sqrt(discriminant);
    let w = -(h + select(root, -root, h < 0.0));
    let first = select(lo, min(max(w / a, lo), hi), a != 0.0);
    let second = select(lo, min(max(d0 / w, lo), hi), w != 0.0);
    return array<real, 2>(min(first, second), max(first, second));
}

// Halving alone takes a bracket in [0, 1] to the last bit within 64 steps.
const ROOT_STEPS: u32 = 64u;

// The root between two ts at which the polynomial has different signs: Newton's steps, halved where they leave the bracket.
fn root_between(b: real4, from_t: real, to_t: real, rises: bool) -> real {
    var lo = from_t;
    var hi = to_t;
    var t = 0.5 * (lo + hi);
    for (var k = 0u; k < ROOT_STEPS; k++) {
        let value = polynomial(b, t);
        if (value < 0.0) == rises {
            lo = t;
        } else {
            hi = t;
        }
        let w = real(f32(DEGREE)) * bernstein(DEGREE - 1u, t);
        let slope = w.x * (b.y - b.x) + w.y * (b.z - b.y) + w.z * (b.w - b.z);
        var next = t - value / slope;
        if slope == 0.0 || !(next > lo && next < hi) {
            next = 0.5 * (lo + hi);
        }
        let done = value == 0.0 || abs(next - t) <= REAL_ROUNDING;
        t = select(next, t, value == 0.0);
        if done {
            break;
        }
    }
    return t;
}

// The curve's point at a root, inside the triangle within rounding: of two triangles at an edge the one or the other is met,
// or both at one t, but never none.
fn meeting_at(q: CellDepth, c: Curve, t: real, lost: real, bound: real) -> Meeting {
    let at = curve_point(c, t);
    let way = curve_tangent(c, t);
    let across = dot(q.normal, way);
    if across * q.hidden > 0.0 {
        return Meeting(t, false);
    }
    // a root is off by the polynomial's rounding over its slope; a double one by the square root of it
    let off = min(bound / max(abs(across), bound), REAL_UNIT_ROOT);
    let room = size3(q.normal) * (lost + off * size3(way));
    var inside = true;
    for (var k = 0u; k < 3u; k++) {
        let e = q.v[(k + 1u) % 3u] - q.v[k];
        inside = inside && dot(cross(e, at - q.v[k]), q.normal) >= -size3(e) * room;
    }
    return Meeting(t, inside);
}
