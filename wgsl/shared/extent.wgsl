// Where in a node a triangle may be seen, in node units, at which t, and whether that is more than a guess.
struct Extent {
    lo: vec2<f32>,
    hi: vec2<f32>,
    t_lo: f32,
    t_hi: f32,
    tight: bool,
}

// The extent by one certified Newton step. A point X is seen at (x, y, t) with
//   X - p = x A + y B + t d + (t - t0)(x dx + y dy) + r,   A = px + t0 dx, B = py + t0 dy, |r| <= r_p + |t| r_d,
// so the rows w of the inverse of [A B d] give x = w_x . (X - p) up to |t - t0| (|w_x . dx| + |w_x . dy|) + |w_x| |r|
// over the node, and t - t0 is bounded alike. The extent of the triangle is then that of its vertices.
fn extent(node: Node, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> Extent {
    let m0 = v0 - node.p;
    let m1 = v1 - node.p;
    let m2 = v2 - node.p;
    let t0 = dot(m0 + m1 + m2, node.d) / (3.0 * dot(node.d, node.d));
    let a = node.px + t0 * node.dx;
    let b = node.py + t0 * node.dy;
    let n = cross(a, b);
    let det = dot(n, node.d);
    let wx = cross(b, node.d) / det;
    let wy = cross(node.d, a) / det;
    let wt = n / det;

    // how far t goes from t0 over the triangle
    let t = vec3<f32>(dot(wt, m0), dot(wt, m1), dot(wt, m2)) - t0;
    let bend_t = abs(dot(wt, node.dx)) + abs(dot(wt, node.dy));
    let size_m = max(length(m0), max(length(m1), length(m2)));
    let size_a = length(node.px) + length(node.py) + abs(t0) * (length(node.dx) + length(node.dy));
    let size_wt = length(wt);
    // rounding: what was subtracted to form the m and A, B; and the inverse's, which its condition magnifies
    let condition = length(a) * length(b) * length(node.d) / abs(det);
    let lost_m = node.r_p
        + BOUND_SLACK * (size_m * (1.0 + condition) + size_a + max(length(v0), max(length(v1), length(v2))) + length(node.p));
    let lost_t = size_wt * (lost_m + abs(t0) * node.r_d);
    let room = 1.0 - bend_t - size_wt * node.r_d;
    let reach_t = (max(abs(t.x), max(abs(t.y), abs(t.z))) + lost_t) / room;

    // how far x and y go from the vertices' own
    let bend = vec2<f32>(abs(dot(wx, node.dx)) + abs(dot(wx, node.dy)), abs(dot(wy, node.dx)) + abs(dot(wy, node.dy)));
    let lost = lost_m + (abs(t0) + reach_t) * node.r_d;
    let slack = reach_t * bend + vec2<f32>(length(wx), length(wy)) * lost;
    let x = vec3<f32>(dot(wx, m0), dot(wx, m1), dot(wx, m2));
    let y = vec3<f32>(dot(wy, m0), dot(wy, m1), dot(wy, m2));
    let lo = vec2<f32>(min(x.x, min(x.y, x.z)), min(y.x, min(y.y, y.z))) - slack;
    let hi = vec2<f32>(max(x.x, max(x.y, x.z)), max(y.x, max(y.y, y.z))) + slack;
    // NaN and infinities of a singular step fail these comparisons
    let sound = abs(det) > DET_MIN && abs(det) < MOST && room > ROOM_MIN && slack.x < SLACK_MAX && slack.y < SLACK_MAX;
    if !sound {
        return Extent(vec2<f32>(-1.0), vec2<f32>(1.0), 0.0, 0.0, false);
    }
    let room_t = reach_t + BOUND_SLACK * abs(t0);
    return Extent(max(lo, vec2<f32>(-1.0)), min(hi, vec2<f32>(1.0)), t0 - room_t, t0 + room_t, true);
}

// The step must contract, and its slack be worth having: less than half the node.
const ROOM_MIN: f32 = 0.25;
const SLACK_MAX: f32 = 0.5;

// What is lost of a determinant below the least normal number is less than its rounding.
const DET_MIN: f32 = LEAST / BOUND_SLACK;
