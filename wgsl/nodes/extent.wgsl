// The part of a node in which a triangle may be seen.

#import nodes/conics.wgsl
#import shared/params.wgsl

// The part of a node in which a triangle may be seen, in node units; its range of t; and whether these are proven.
struct Extent {
    lo: vec2<f32>,
    hi: vec2<f32>,
    t_lo: f32,
    t_hi: f32,
    tight: bool,
}

// Before the first step: all of the node, t guessed from the node's centre.
fn anywhere(node: Node, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> Extent {
    let t0 = dot(v0 + v1 + v2 - 3.0 * node.p, node.d) / (3.0 * dot(node.d, node.d));
    return Extent(vec2<f32>(-1.0), vec2<f32>(1.0), t0, t0, false);
}

// The extent by one certified Newton step: for a tile.
fn extent(node: Node, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> Extent {
    return narrowed(node, anywhere(node, v0, v1, v2), v0, v1, v2);
}

// By three steps, each about the centre of the previous extent: for nodes of many tiles.
fn close_extent(node: Node, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> Extent {
    let first = extent(node, v0, v1, v2);
    return narrowed(node, narrowed(node, first, v0, v1, v2), v0, v1, v2);
}

// One step: a point X is seen at c + (x, y) and t, c the centre of the extent so far, with
//   X - p - c_x px - c_y py = x A + y B + t D + (t - t0)(x dx + y dy) + r,
//   A = px + t0 dx, B = py + t0 dy, D = d + c_x dx + c_y dy, |r| <= r_p + |t| r_d,
// so the rows w of the inverse of [A B D] give x = w_x . (X - p - ...) up to |t - t0| (|x| |w_x . dx| + |y| |w_x . dy|) + |w_x| |r|,
// and t - t0 is bounded alike. The extent of the triangle is then that of its vertices.
fn narrowed(node: Node, before: Extent, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> Extent {
    let c = 0.5 * (before.lo + before.hi);
    let s = 0.5 * (before.hi - before.lo) + BOUND_TOLERANCE;
    let t0 = 0.5 * (before.t_lo + before.t_hi);
    let p = node.p + c.x * node.px + c.y * node.py;
    let d = node.d + c.x * node.dx + c.y * node.dy;
    let m0 = v0 - p;
    let m1 = v1 - p;
    let m2 = v2 - p;
    let a = node.px + t0 * node.dx;
    let b = node.py + t0 * node.dy;
    let n = cross(a, b);
    let det = dot(n, d);
    let wx = cross(b, d) / det;
    let wy = cross(d, a) / det;
    let wt = n / det;

    // how far t goes from t0 over the triangle
    let t = vec3<f32>(dot(wt, m0), dot(wt, m1), dot(wt, m2)) - t0;
    let bend_t = s.x * abs(dot(wt, node.dx)) + s.y * abs(dot(wt, node.dy));
    let size_m = max(size1(m0), max(size1(m1), size1(m2)));
    let size_a = size1(node.px) + size1(node.py) + abs(t0) * (size1(node.dx) + size1(node.dy));
    let size_wt = size1(wt);
    // rounding: what was subtracted to form the m and A, B; and the inverse's, which its condition magnifies
    let condition = size1(a) * size1(b) * size1(d) / abs(det);
    let size_p = size1(node.p) + size1(node.px) + size1(node.py);
    let size_d = abs(t0) * (size1(node.d) + size1(node.dx) + size1(node.dy));
    let error_m = node.r_p
        + BOUND_TOLERANCE * (size_m * (1.0 + condition) + size_a + max(size1(v0), max(size1(v1), size1(v2))) + size_p + size_d);
    let error_wt = size_wt * (error_m + abs(t0) * node.r_d);
    let contraction = 1.0 - bend_t - size_wt * node.r_d;
    let reach_t = (max(abs(t.x), max(abs(t.y), abs(t.z))) + error_wt) / contraction;

    // how far x and y go from the vertices' own
    let bend = vec2<f32>(
        s.x * abs(dot(wx, node.dx)) + s.y * abs(dot(wx, node.dy)),
        s.x * abs(dot(wy, node.dx)) + s.y * abs(dot(wy, node.dy)),
    );
    let error = error_m + (abs(t0) + reach_t) * node.r_d;
    let tolerance = reach_t * bend + vec2<f32>(size1(wx), size1(wy)) * error;
    let x = vec3<f32>(dot(wx, m0), dot(wx, m1), dot(wx, m2));
    let y = vec3<f32>(dot(wy, m0), dot(wy, m1), dot(wy, m2));
    let lo = c + vec2<f32>(min(x.x, min(x.y, x.z)), min(y.x, min(y.y, y.z))) - tolerance;
    let hi = c + vec2<f32>(max(x.x, max(x.y, x.z)), max(y.x, max(y.y, y.z))) + tolerance;
    // NaN and infinities of a singular step fail these comparisons
    let sound = abs(det) > DET_MIN && abs(det) < MOST && contraction > CONTRACTION_MIN && tolerance.x < TOLERANCE_MAX && tolerance.y < TOLERANCE_MAX;
    if !sound || any(before.lo > before.hi) {
        return before;
    }
    // a hit may be moved to an end of t_range; w_t . D = 1, so that 1 / |D| is at most the size of w_t
    let error_t = reach_t + BOUND_TOLERANCE * abs(t0) + END_BOUND * params.scene_size * size_wt;
    return Extent(max(lo, before.lo), min(hi, before.hi), t0 - error_t, t0 + error_t, true);
}

// Sum of the absolute components: at least the length, and cheaper.
fn size1(v: vec3<f32>) -> f32 {
    return abs(v.x) + abs(v.y) + abs(v.z);
}

// The step must contract, and its tolerance be worth having.
const CONTRACTION_MIN: f32 = 0.25;
const TOLERANCE_MAX: f32 = 4.0;

// What is lost of a determinant below the least normal number is less than its rounding.
const DET_MIN: f32 = LEAST / BOUND_TOLERANCE;
