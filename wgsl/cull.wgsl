// cull: one thread per (cluster, node) item of the step's queue; in step 0 per cluster, at a node above the top level.
// Reads clusters and nodes; writes the children that the cluster may meet to the next queue, or to `work`: at level 1,
// or where all children are one affine bundle and continuing with single triangles is cheaper: the cluster meets many children, or an
// extent bounds its position in the bundle.
// Discontinuous nodes of level 1 are queued once more: their tiles go to `work`, and of discontinuous tiles the cells.
// `queue_out` and `work` may overflow: counters keep counting.

#import nodes/extent.wgsl
#import nodes/index.wgsl
#import nodes/meets.wgsl
#import nodes/tables.wgsl
#import nodes/tile_rays
#import shared/items.wgsl
#import shared/params.wgsl
#import shared/places.wgsl
#import shared/table.wgsl

var<storage, read> nodes: array<Node>;
var<storage, read> queue_in: array<vec2<u32>>;
var<storage, read_write> queue_out: array<vec2<u32>>;
var<storage, read_write> work: array<vec2<u32>>;
var clusters: texture_2d<u32>;

// Children met by which a cluster is handed on undivided: descending costs every triangle of the cluster a set-up a
// child, handing on costs 16 tests; a set-up is worth about four tests.
const HAND_ON: u32 = 4u;

// The highest level of what is handed on: bin goes over its 64 x 64 tiles in one loop, and software adapters end a thread's loops after
// 65535 rounds in all.
const HAND_ON_LEVEL: u32 = 3u;

// Of a node of size 2: how large the place may be where a cluster is seen. Beyond, an extent says little of single triangles too.
const CLEAR: f32 = 1.0;

// Without culling every cluster meets every node; `bin` then decides.
override CULLING: bool = true;

@compute @workgroup_size(64)
fn cull(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take an item
    let index = item_index(group, groups, lane);
    var cluster = params.cluster_first + index;
    var node = node_pack(params.levels, 0u, 0u);
    if step.value == 0u {
        if index >= params.cluster_count {
            return;
        }
    } else {
        if index >= min(atomicLoad(&counters[step.value]), params.queue_capacity) {
            return;
        }
        cluster = queue_in[index].x;
        node = queue_in[index].y;
    }
    let level = node_level(node);
    let x = node_x(node) * BRANCH;
    let y = node_y(node) * BRANCH;
    let centre = cluster_centre(cluster);
    let half = cluster_half(cluster);

    // hand it on undivided, where it is seen in a small part of the node's one bundle
    var is_bundle = false;
    if level > 1u && level < params.levels && level <= HAND_ON_LEVEL {
        let own = nodes[node_index(level, x / BRANCH, y / BRANCH)];
        let seen = extent(own, centre - half, centre, centre + half);
        is_bundle = own.rays == RAYS_AFFINE;
        if is_bundle && seen.tight && all(seen.hi - seen.lo < vec2<f32>(CLEAR)) && node_meets(own, centre, half) {
            put_to_work(take_places(COUNT_WORK, 1u), vec2<u32>(cluster, node));
            return;
        }
    }

    // test the cluster's box against the rays of each child
    let columns = min(BRANCH, level_width(level - 1u) - x);
    let rows = min(BRANCH, level_height(level - 1u) - y);
    var kept = 0u;
    var discontinuous = 0u;
    var place = vec2<u32>(0u);
    loop {
        let child = node_index(level - 1u, x + place.x, y + place.y);
        if !CULLING || child_meets(level - 1u, x + place.x, y + place.y, nodes[child], centre, half) {
            let bit = 1u << (place.y * BRANCH + place.x);
            kept |= bit;
            discontinuous |= select(0u, bit, nodes[child].rays == RAYS_DISCONTINUOUS);
        }
        place.x++;
        if place.x == columns {
            place = vec2<u32>(0u, place.y + 1u);
        }
        if place.y == rows {
            break;
        }
    }
    if kept == 0u {
        return;
    }

    // hand it on undivided, where it meets many
    if is_bundle && countOneBits(kept) > HAND_ON {
        put_to_work(take_places(COUNT_WORK, 1u), vec2<u32>(cluster, node));
        return;
    }

    // descend where children have much tighter bounds
    let further = select(discontinuous, kept, level > 2u);
    let done = kept & ~further;
    var at = take_places(COUNT_WORK, countOneBits(done));
    for (var left = done; left != 0u; left &= left - 1u) {
        let bit = firstTrailingBit(left);
        put_to_work(at, vec2<u32>(cluster, node_pack(level - 1u, x + bit % BRANCH, y + bit / BRANCH)));
        at++;
    }
    if level == 1u {
        for (var left = further; left != 0u; left &= left - 1u) {
            let bit = firstTrailingBit(left);
            descend_to_cells((y + bit / BRANCH) * params.tiles_x + x + bit % BRANCH, cluster);
        }
        return;
    }
    at = take_places(step.value + 1u, countOneBits(further));
    for (var left = further; left != 0u; left &= left - 1u) {
        let bit = firstTrailingBit(left);
        if at < params.queue_capacity {
            queue_out[at] = vec2<u32>(cluster, node_pack(level - 1u, x + bit % BRANCH, y + bit / BRANCH));
        }
        at++;
    }
}

// The two texels of a cluster.
fn cluster_centre(cluster: u32) -> vec3<f32> {
    return bitcast<vec4<f32>>(textureLoad(clusters, table_texel(2u * cluster), 0)).xyz;
}

fn cluster_half(cluster: u32) -> vec3<f32> {
    return bitcast<vec4<f32>>(textureLoad(clusters, table_texel(2u * cluster + 1u), 0)).xyz;
}

fn child_meets(level: u32, x: u32, y: u32, node: Node, centre: vec3<f32>, half: vec3<f32>) -> bool {
    return node_meets(node, centre, half) && (level > 0u || tile_meets(x, y, node, centre, half));
}

// The cells of a discontinuous tile whose rays the cluster may meet.
fn descend_to_cells(tile: u32, cluster: u32) {
    let end = tile_start[tile + 1u];
    for (var cell = tile_start[tile]; cell < end; cell++) {
        if !CULLING || node_meets(nodes[cells[cell].node], cluster_centre(cluster), cluster_half(cluster)) {
            put_to_work(take_places(COUNT_WORK, 1u), vec2<u32>(cluster, cell_pack(cell)));
        }
    }
}

fn put_to_work(at: u32, item: vec2<u32>) {
    if at < params.work_capacity {
        work[at] = item;
    }
}
