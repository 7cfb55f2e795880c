// The three edges of a triangle over a node, with bounds: which places of the node it cannot cover.

#import shared/params.wgsl

// Relative rounding allowed for a bound: some 12 operations of 2^-24 each.
const BOUND_TOLERANCE: f32 = 1.0 / 1048576.0;

// What is lost below the least normal number, where an adapter takes 0 instead: 2^-126 an operation, of hundreds of them.
const LEAST: f32 = 1.0e-35;

// Sums of products of sizes beyond this may overflow: a bound on them becomes infinite, and nothing is proven.
const MOST: f32 = 1.0e36;

// An edge conic over a node: value, slopes and second-order coefficients in node units, and its tolerance.
struct Conic {
    c: f32,
    x: f32,
    y: f32,
    xx: f32,
    xy: f32,
    yy: f32,
    tolerance: f32,
}

// The conic of the edge from a vertex along e, from the vector quadratic d x m of that vertex.
fn edge_conic(e: vec3<f32>, q: Moment, residual: f32, reach: f32) -> Conic {
    let size = length(q.c) + length(q.x) + length(q.y) + length(q.xx) + length(q.xy) + length(q.yy);
    // e is the difference of two rounded vertices: 2^-23 of the larger of error, taken twice for the difference's own
    let tolerance = length(e) * (residual + BOUND_TOLERANCE * size) + BOUND_TOLERANCE * 0.25 * reach * size + LEAST * (1.0 + size);
    let fits = length(e) * size < MOST;
    return Conic(dot(e, q.c), dot(e, q.x), dot(e, q.y), dot(e, q.xx), dot(e, q.xy), dot(e, q.yy), tolerance * select(MOST, 1.0, fits));
}

// d x m as a quadratic over the node, m = v - P for one vertex v.
struct Moment {
    c: vec3<f32>,
    x: vec3<f32>,
    y: vec3<f32>,
    xx: vec3<f32>,
    xy: vec3<f32>,
    yy: vec3<f32>,
}

fn moment(node: Node, v: vec3<f32>) -> Moment {
    let m = v - node.p;
    return Moment(
        cross(node.d, m),
        cross(node.dx, m) - cross(node.d, node.px),
        cross(node.dy, m) - cross(node.d, node.py),
        -cross(node.dx, node.px),
        -cross(node.dx, node.py) - cross(node.dy, node.px),
        -cross(node.dy, node.py),
    );
}

// Sign of the conic over the box of half-size s about (x, y): 1, -1, or 0 where not proven.
fn conic_sign(q: Conic, x: f32, y: f32, s: f32) -> i32 {
    let value = q.c + x * (q.x + x * q.xx + y * q.xy) + y * (q.y + y * q.yy);
    let gx = q.x + 2.0 * x * q.xx + y * q.xy;
    let gy = q.y + x * q.xy + 2.0 * y * q.yy;
    let r = s * (abs(gx) + abs(gy) + s * (abs(q.xx) + abs(q.xy) + abs(q.yy))) + q.tolerance;
    return select(0, 1, value > r) - select(0, 1, value < -r);
}

// Pixel centres lie within 7/8 of a tile's half-size.
const CENTRES: f32 = 0.875;

// Largest distance of a sample from its pixel's centre, px.
override SAMPLE_REACH: f32 = 0.0;

// A pixel in the units of a tile's node.
const NODE_PX: f32 = 2.0 / f32(TILE);

// The three edge conics of a triangle over one node.
struct Conics {
    e01: Conic,
    e02: Conic,
    e12: Conic,
}

fn conics(node: Node, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> Conics {
    let q0 = moment(node, v0);
    let q1 = moment(node, v1);
    let reach_d = length(node.d) + length(node.dx) + length(node.dy);
    let reach_p = length(node.px) + length(node.py);
    let reach_m = max(length(v0 - node.p), length(v1 - node.p)) + reach_p;
    let reach = max(length(v0), max(length(v1), length(v2)));
    let residual = node.r_d * (reach_m + node.r_p) + reach_d * node.r_p
        + BOUND_TOLERANCE * reach_d * (reach_m + reach + length(node.p)) + LEAST * (1.0 + reach_d);
    return Conics(
        edge_conic(v1 - v0, q0, residual, reach),
        edge_conic(v2 - v0, q0, residual, reach),
        edge_conic(v2 - v1, q1, residual, reach),
    );
}

// The triangle may cover a place in the box: no edge is proven up while another is proven down.
fn may_cover(q: Conics, x: f32, y: f32, s: f32) -> bool {
    let s01 = conic_sign(q.e01, x, y, s);
    let s20 = -conic_sign(q.e02, x, y, s);
    let s12 = conic_sign(q.e12, x, y, s);
    return min(s01, min(s20, s12)) >= 0 || max(s01, max(s20, s12)) <= 0;
}
