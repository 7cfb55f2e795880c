// bin: one workgroup per (cluster, node) item of `work`, one thread per triangle.
// Reads triangles, vertices and nodes; writes (slot, cell) pairs of every tile under the node that the triangle may
// cover, by bounds on its three edge conics. `pairs` may overflow: the counter keeps counting.

override COUNTING: bool = false;

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
