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
    if COUNTING && lane == 0u {
        atomicAdd(&counters[COUNT_PAIRS_TESTED], cluster.count);
    }
    if lane >= cluster.count {
        return;
    }
    let slot = cluster.first + lane;
    let triangle = triangles[slot];
    let v0 = vertex(triangle.x);
    let v1 = vertex(triangle.y);
    let v2 = vertex(triangle.z);

    // set up its edge conics over the node
    let level = node_level(address);
    let node = nodes[node_index(level, node_x(address), node_y(address))];
    let q0 = moment(node, v0);
    let q1 = moment(node, v1);
    let reach_d = length(node.d) + length(node.dx) + length(node.dy);
    let reach_p = length(node.px) + length(node.py);
    let reach_m = max(length(v0 - node.p), length(v1 - node.p)) + reach_p;
    let residual = node.r_d * (reach_m + node.r_p) + reach_d * node.r_p
        + BOUND_SLACK * reach_d * (reach_m + params.vertex_reach + length(node.p));
    let e01 = edge_conic(v1 - v0, q0, residual);
    let e02 = edge_conic(v2 - v0, q0, residual);
    let e12 = edge_conic(v2 - v1, q1, residual);

    // walk the nodes below, a whole subtree at a time where the triangle cannot be
    let count = 1u << (4u * level);
    var i = 0u;
    var depth = level;
    loop {
        if i >= count {
            break;
        }
        // the square of subtree i at this depth: column and row by every other pair of bits
        var x = 0u;
        var y = 0u;
        for (var k = depth; k < level; k++) {
            let digit = (i >> (4u * k)) & 15u;
            x |= (digit & 3u) << (2u * (k - depth));
            y |= (digit >> 2u) << (2u * (k - depth));
        }
        let s = 1.0 / f32(1u << (2u * (level - depth)));
        let cx = (2.0 * f32(x) + 1.0) * s - 1.0;
        let cy = (2.0 * f32(y) + 1.0) * s - 1.0;
        let half = s * select(1.0, CENTRES, depth == 0u);
        let s01 = conic_sign(e01, cx, cy, half);
        let s02 = -conic_sign(e02, cx, cy, half);
        let s12 = conic_sign(e12, cx, cy, half);
        let mixed = min(s01, min(s02, s12)) < 0 && max(s01, max(s02, s12)) > 0;
        if !mixed && depth > 0u {
            depth--;
            continue;
        }
        if !mixed {
            emit(slot, (node_x(address) << (2u * level)) + x, (node_y(address) << (2u * level)) + y);
        }
        // on to the next subtree, as high as its start allows
        i += 1u << (4u * depth);
        while depth < level && (i & ((1u << (4u * (depth + 1u))) - 1u)) == 0u {
            depth++;
        }
    }
}

// Pairs the triangle with every cell of the tile.
fn emit(slot: u32, tile_x: u32, tile_y: u32) {
    if tile_x >= params.tiles_x || tile_y >= params.tiles_y {
        return;
    }
    let tile = tile_y * params.tiles_x + tile_x;
    let first = tile_start[tile];
    let count = tile_start[tile + 1u] - first;
    let at = atomicAdd(&counters[COUNT_PAIRS], count);
    for (var k = 0u; k < count; k++) {
        if at + k < params.pair_capacity {
            pairs[at + k] = vec2<u32>(slot, first + k);
        }
    }
}
