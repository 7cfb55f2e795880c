// bin: one workgroup per (cluster, node) item of `work`, one thread per triangle.
// Reads triangles, vertices and nodes; writes (slot, cell) pairs of every tile under the node that the triangle may
// cover, by bounds on its three edge conics. `pairs` may overflow: the counter keeps counting.

override COUNTING: bool = false;

// Relative rounding allowed for a bound: some 12 operations of 2^-24 each.
const BOUND_SLACK: f32 = 1.0 / 1048576.0;

// An edge conic over a node: value, slopes and second-order coefficients in node units, and its slack.
struct Conic {
    c: f32,
    x: f32,
    y: f32,
    xx: f32,
    xy: f32,
    yy: f32,
    slack: f32,
}

// The conic of the edge from a vertex along e, from the vector quadratic d x m of that vertex.
fn edge_conic(e: vec3<f32>, q: Moment, residual: f32) -> Conic {
    let size = length(q.c) + length(q.x) + length(q.y) + length(q.xx) + length(q.xy) + length(q.yy);
    // e is the difference of two rounded vertices: 2^-23 reach of error, taken twice for the difference's own
    let slack = length(e) * (residual + BOUND_SLACK * size) + BOUND_SLACK * 0.25 * params.vertex_reach * size;
    return Conic(dot(e, q.c), dot(e, q.x), dot(e, q.y), dot(e, q.xx), dot(e, q.xy), dot(e, q.yy), slack);
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
    let r = s * (abs(gx) + abs(gy) + s * (abs(q.xx) + abs(q.xy) + abs(q.yy))) + q.slack;
    return select(0, 1, value > r) - select(0, 1, value < -r);
}

// Pixel centres lie within 7/8 of a tile's half-size.
const CENTRES: f32 = 0.875;

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
    let residual = node.r_d * (reach_m + node.r_p) + reach_d * node.r_p
        + BOUND_SLACK * reach_d * (reach_m + params.vertex_reach + length(node.p));
    return Conics(
        edge_conic(v1 - v0, q0, residual),
        edge_conic(v2 - v0, q0, residual),
        edge_conic(v2 - v1, q1, residual),
    );
}

// The triangle may cover a place in the box: no edge is proven up while another is proven down.
fn may_cover(q: Conics, x: f32, y: f32, s: f32) -> bool {
    let s01 = conic_sign(q.e01, x, y, s);
    let s20 = -conic_sign(q.e02, x, y, s);
    let s12 = conic_sign(q.e12, x, y, s);
    return min(s01, min(s20, s12)) >= 0 || max(s01, max(s20, s12)) <= 0;
}

// Where in a node a triangle may be seen, in node units, and whether that is more than a guess.
struct Extent {
    lo: vec2<f32>,
    hi: vec2<f32>,
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
        + BOUND_SLACK * (size_m * (1.0 + condition) + size_a + params.vertex_reach + length(node.p));
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
    let sound = room > ROOM_MIN && slack.x < SLACK_MAX && slack.y < SLACK_MAX;
    if !sound {
        return Extent(vec2<f32>(-1.0), vec2<f32>(1.0), false);
    }
    return Extent(max(lo, vec2<f32>(-1.0)), min(hi, vec2<f32>(1.0)), true);
}

// The step must contract, and its slack be worth having: less than half the node.
const ROOM_MIN: f32 = 0.25;
const SLACK_MAX: f32 = 0.5;

// Tiles up to which a pair each is cheaper than three conics.
const FEW_TILES: u32 = 4u;

@compute @workgroup_size(64)
fn bin(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a triangle of a work item
    let index = group_index(group, groups);
    if index >= min(atomicLoad(&counters[COUNT_WORK]), params.work_capacity) {
        return;
    }
    let cluster = clusters[work[index].x];
    let address = work[index].y;
    if lane >= cluster.count {
        return;
    }
    let slot = cluster.first + lane;
    let triangle = triangles[slot];
    let v0 = vertex(triangle.x);
    let v1 = vertex(triangle.y);
    let v2 = vertex(triangle.z);

    // bound the pixel centres it may cover: pixel k of the node's side has its centre at k + 1/2
    let level = node_level(address);
    let node = nodes[node_index(level, node_x(address), node_y(address))];
    let side = TILE << (2u * level);
    let where_seen = extent(node, v0, v1, v2);
    let first = ceil((where_seen.lo + 1.0) * 0.5 * f32(side) - 0.5 - CENTRE_SLACK * f32(side));
    let last = floor((where_seen.hi + 1.0) * 0.5 * f32(side) - 0.5 + CENTRE_SLACK * f32(side));
    let lo = vec2<u32>(clamp(first, vec2<f32>(0.0), vec2<f32>(f32(side))));
    let end = vec2<u32>(clamp(last + 1.0, vec2<f32>(0.0), vec2<f32>(f32(side))));
    if lo.x >= end.x || lo.y >= end.y {
        count_tested(1u);
        return;
    }

    // pair it with the tiles of that box: all of a few, of many those that its conics may cover
    let corner = vec2<u32>(node_x(address), node_y(address)) << vec2<u32>(2u * level);
    let tile_lo = lo / TILE;
    let tile_end = min((end + TILE - 1u) / TILE, vec2<u32>(params.tiles_x, params.tiles_y) - corner);
    let loose = node.rays != RAYS_AFFINE && !where_seen.tight;
    let all_tiles = where_seen.tight && (tile_end.x - tile_lo.x) * (tile_end.y - tile_lo.y) <= FEW_TILES;
    var over_node: Conics;
    if !all_tiles {
        over_node = conics(node, v0, v1, v2);
    }
    let s = f32(TILE) / f32(side);
    var tested = 0u;
    for (var y = tile_lo.y; y < tile_end.y; y++) {
        for (var x = tile_lo.x; x < tile_end.x; x++) {
            let centre = (2.0 * vec2<f32>(f32(x), f32(y)) + 1.0) * s - 1.0;
            if COUNTING {
                let tile = (corner.y + y) * params.tiles_x + corner.x + x;
                tested += tile_start[tile + 1u] - tile_start[tile];
            }
            var may = all_tiles || may_cover(over_node, centre.x, centre.y, s * CENTRES);
            if may && loose {
                // rays that the node bounds only loosely: ask the tile's own bounds
                may = tile_may_cover(corner.x + x, corner.y + y, v0, v1, v2);
            }
            if may {
                let tile = vec2<u32>(x, y);
                let from_px = max(lo, tile * TILE) - tile * TILE;
                let to_px = min(end, tile * TILE + TILE) - 1u - tile * TILE;
                emit(slot, (corner.y + y) * params.tiles_x + corner.x + x, from_px, to_px);
            }
        }
    }
    count_tested(max(tested, 1u));
}

// (triangle, cell) pairs looked at: the cells of the tiles in its box, or one for a whole node.
fn count_tested(pairs_tested: u32) {
    if COUNTING {
        atomicAdd(&counters[COUNT_PAIRS_TESTED], pairs_tested);
    }
}

// Rounding of a place in node units on its way to pixels: 4 roundings of values up to 2.
const CENTRE_SLACK: f32 = 1.0 / 2097152.0;

fn tile_may_cover(x: u32, y: u32, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> bool {
    let tile = nodes[node_index(0u, x, y)];
    return tile.rays != RAYS_NONE && may_cover(conics(tile, v0, v1, v2), 0.0, 0.0, CENTRES);
}

// Pairs the triangle with every cell of the tile, and with the box of pixels to look at.
fn emit(slot: u32, tile: u32, from_px: vec2<u32>, to_px: vec2<u32>) {
    let first = tile_start[tile];
    let count = tile_start[tile + 1u] - first;
    let at = atomicAdd(&counters[COUNT_PAIRS], count);
    for (var k = 0u; k < count; k++) {
        if at + k < params.pair_capacity {
            pairs[at + k] = pair_pack(slot, first + k, from_px, to_px);
        }
    }
}
