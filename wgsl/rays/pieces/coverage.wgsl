// What a triangle covers of a cell, by its edge conics over the tile, and how deep.

#import arithmetic
#import masks/there
#import rays/affine_bundle.wgsl
#import rays/meeting.wgsl
#import rays/pieces/bundle.wgsl
#import rays/pieces/table.wgsl
#import rays/straight/meeting.wgsl
#import shared/params.wgsl

// Coverage is proven if true; else it is possible.
const COVERAGE_PROVES: bool = true;

// Rounding of one f32 operation, relative.
const UNIT: f32 = 1.0 / 16777216.0;

// Error of results below the least normal number, which an adapter may flush to 0: 2^-126 an operation, of hundreds of them.
const LEAST: f32 = 1.0e-35;

// Sums of products of sizes beyond this may overflow: a bound on them becomes infinite, and nothing is proven.
const MOST: f32 = 1.0e36;

// Sum of the absolute components: at least the length, and cheaper.
fn size(v: vec3<f32>) -> f32 {
    return abs(v.x) + abs(v.y) + abs(v.z);
}

// d x m for one vertex as a quadratic over the tile in px, m = v h - p; and bounds on its size and on its rounding.
struct Moment {
    c: vec3<f32>,
    x: vec3<f32>,
    y: vec3<f32>,
    xx: vec3<f32>,
    xy: vec3<f32>,
    yy: vec3<f32>,
    size: f32,
    rounding: f32,
}

fn moment(cell: Cell, piece: Piece, v: vec3<f32>) -> Moment {
    let m = v * cell.h - cell.p;
    let mx = v * piece.hx_hi - piece.px_hi;
    let my = v * piece.hy_hi - piece.py_hi;
    var q: Moment;
    q.c = cross(cell.d, m);
    q.x = cross(piece.dx_hi, m) + cross(cell.d, mx);
    q.y = cross(piece.dy_hi, m) + cross(cell.d, my);
    q.xx = cross(piece.dx_hi, mx);
    q.xy = cross(piece.dx_hi, my) + cross(piece.dy_hi, mx);
    q.yy = cross(piece.dy_hi, my);
    q.size = size(q.c) + TILE_REACH * (size(q.x) + size(q.y))
        + TILE_REACH * TILE_REACH * (size(q.xx) + size(q.xy) + size(q.yy));
    // m: stored v, h and p, a product and a difference, 4 units of what was subtracted; d: 1 unit as stored; the
    // cross product and the sums of up to two of them: 8 units of |d| |m|; the perturbation of the ray, up to 2^-24 px:
    // less than 1 unit of |d| |m|
    let reach_d = size(cell.d) + TILE_REACH * (size(piece.dx_hi) + size(piece.dy_hi));
    let reach_m = size(m) + TILE_REACH * (size(mx) + size(my));
    let reach_h = abs(cell.h) + TILE_REACH * (abs(piece.hx_hi) + abs(piece.hy_hi));
    let reach_p = size(cell.p) + TILE_REACH * (size(piece.px_hi) + size(piece.py_hi));
    q.rounding = UNIT * reach_d * (11.0 * reach_m + 4.0 * (size(v) * reach_h + reach_p)) + LEAST * (1.0 + reach_d);
    return q;
}

// One edge over the tile: E(x, y), and the bound below which its sign is not proven.
struct Conic {
    c: f32,
    x: f32,
    y: f32,
    xx: f32,
    xy: f32,
    yy: f32,
    bound: f32,
}

// e = w - v: two stored vertices, 2 units of both sizes, and a difference, 1 of |e|; dot product and evaluation: 12 units.
fn conic(v: vec3<f32>, w: vec3<f32>, q: Moment) -> Conic {
    let e = w - v;
    let size_e = size(e);
    let bound = size_e * q.rounding + UNIT * (2.0 * (size(v) + size(w)) + 13.0 * size_e) * q.size + LEAST * (1.0 + q.size);
    let fits = size_e * q.size < MOST;
    return Conic(dot(e, q.c), dot(e, q.x), dot(e, q.y), dot(e, q.xx), dot(e, q.xy), dot(e, q.yy), bound * select(MOST, 1.0, fits));
}

// One row of pixels of a conic: E(x) = c + x (b + x a).
fn conic_row(k: Conic, y: f32) -> vec3<f32> {
    return vec3<f32>(k.c + y * (k.y + y * k.yy), k.x + y * k.xy, k.xx);
}

fn row_at(r: vec3<f32>, x: f32) -> f32 {
    return r.x + x * (r.y + x * r.z);
}

// Coverage of the owned pixels in a box of the cell: two words of proven pixels, then two of pixels whose signs are not proven.
fn coverage(
    cell: Cell,
    owned: vec2<u32>,
    from_px: vec2<u32>,
    to_px: vec2<u32>,
    v0: vec3<f32>,
    v1: vec3<f32>,
    v2: vec3<f32>,
) -> vec4<u32> {
    let piece = piece_at(cell.piece);
    let q0 = moment(cell, piece, v0);
    let q1 = moment(cell, piece, v1);
    let e01 = conic(v0, v1, q0);
    let e20 = conic(v2, v0, q0);
    let e12 = conic(v1, v2, q1);
    var covered = vec2<u32>(0u);
    var uncertain = vec2<u32>(0u);
    for (var j = from_px.y; j <= to_px.y; j++) {
        let y = f32(j) - TILE_REACH;
        let r01 = conic_row(e01, y);
        let r20 = conic_row(e20, y);
        let r12 = conic_row(e12, y);
        var in_bits = 0u;
        var uncertain_bits = 0u;
        for (var i = from_px.x; i <= to_px.x; i++) {
            let x = f32(i) - TILE_REACH;
            let a = row_at(r01, x);
            let b = row_at(r20, x);
            let c = row_at(r12, x);
            let all_in = (a > e01.bound && b > e20.bound && c > e12.bound)
                || (a < -e01.bound && b < -e20.bound && c < -e12.bound);
            let some_up = a > e01.bound || b > e20.bound || c > e12.bound;
            let some_down = a < -e01.bound || b < -e20.bound || c < -e12.bound;
            in_bits |= select(0u, 1u << i, all_in);
            uncertain_bits |= select(1u << i, 0u, all_in || (some_up && some_down));
        }
        let shift = 8u * (j & 3u);
        if j < 4u {
            covered.x |= in_bits << shift;
            uncertain.x |= uncertain_bits << shift;
        } else {
            covered.y |= in_bits << shift;
            uncertain.y |= uncertain_bits << shift;
        }
    }
    return vec4<u32>(covered & owned, uncertain & owned);
}

// N . (v h - p) and N . d over a tile: their ratio is t.
struct CellDepth {
    along: real3,           // value at the tile's centre, slopes in x and y
    across: real3,
    v: array<real3, 3>,
    normal: real3,
    reach: real,
    back_sign: real,
    slot: u32,
    whole: Bundle,
}

fn cell_depth(whole: Bundle, normal: real3, v: array<real3, 3>, back_sign: real, slot: u32) -> CellDepth {
    var q: CellDepth;
    q.along = real3(
        dot(normal, v[0] * whole.h - whole.p),
        dot(normal, v[0] * whole.hx - whole.px),
        dot(normal, v[0] * whole.hy - whole.py),
    );
    q.across = real3(dot(normal, whole.d), dot(normal, whole.dx), dot(normal, whole.dy));
    q.back_sign = back_sign;
    q.slot = slot;
    q.whole = whole;
    q.v = v;
    q.normal = normal;
    q.reach = reach3(v);
    return q;
}

fn pixel_depth(q: CellDepth, cell: Cell, x: u32, y: u32) -> Meeting {
    let fx = real(f32(x) - TILE_REACH);
    let fy = real(f32(y) - TILE_REACH);
    let along = q.along.x + fx * q.along.y + fy * q.along.z;
    let across = q.across.x + fx * q.across.y + fy * q.across.z;
    let b = bundle_at(q.whole, fx, fy);
    var meeting = ray_meeting(b, q.v, q.normal, along, across, end_rounding(b, q.normal, across, q.reach), q.back_sign);
    meeting.visible = meeting.visible && is_there(q.slot, b);
    return meeting;
}
