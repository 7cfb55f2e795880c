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

    // bound the pixel centres it may cover
    let level = node_level(address);
    let node = nodes[node_index(level, node_x(address), node_y(address))];
    let side = TILE << (2u * level);
    let where_seen = extent(node, v0, v1, v2);
    let within = pixels_within(where_seen, side);
    let lo = within.xy;
    let end = within.zw;
    if is_empty(within) {
        count_tested(1u);
        return;
    }

    // pair it with the tiles of that box: all of a few, of many those that its conics may cover
    let corner = vec2<u32>(node_x(address), node_y(address)) << vec2<u32>(2u * level);
    let tile_lo = lo / TILE;
    let tile_end = min((end + TILE - 1u) / TILE, vec2<u32>(params.tiles_x, params.tiles_y) - corner);
    let loose = node.rays != RAYS_AFFINE;
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
            if !(all_tiles || may_cover(over_node, centre.x, centre.y, s * CENTRES)) {
                continue;
            }
            let first = vec2<u32>(x, y) * TILE;
            var in_tile = vec4<u32>(max(lo, first), min(end, first + TILE)) - first.xyxy;
            if loose {
                // rays that the node bounds only loosely: ask the tile's own bounds
                let own = tile_pixels(corner.x + x, corner.y + y, v0, v1, v2);
                in_tile = vec4<u32>(max(in_tile.xy, own.xy), min(in_tile.zw, own.zw));
                if is_empty(in_tile) {
                    continue;
                }
            }
            emit(slot, (corner.y + y) * params.tiles_x + corner.x + x, in_tile, v0, v1, v2);
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

// The first columns and rows, and the ends, of the pixels in a square of `side` pixels that an extent holds: pixel k has
// its centre at k + 1/2. None where it ends before the range of t or begins behind.
fn pixels_within(seen: Extent, side: u32) -> vec4<u32> {
    if seen.tight && (seen.t_hi < params.t_min.x || seen.t_lo > params.t_max.x) {
        return vec4<u32>(0u);
    }
    let first = ceil((seen.lo + 1.0) * 0.5 * f32(side) - 0.5 - CENTRE_SLACK * f32(side));
    let last = floor((seen.hi + 1.0) * 0.5 * f32(side) - 0.5 + CENTRE_SLACK * f32(side));
    let most = vec4<f32>(f32(side));
    return vec4<u32>(clamp(vec4<f32>(first, last + 1.0), vec4<f32>(0.0), most));
}

fn is_empty(pixels: vec4<u32>) -> bool {
    return any(pixels.xy >= pixels.zw);
}

// The pixels of a tile that the triangle may cover by the tile's own bounds.
fn tile_pixels(x: u32, y: u32, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> vec4<u32> {
    let tile = nodes[node_index(0u, x, y)];
    if tile.rays == RAYS_NONE || !may_cover(conics(tile, v0, v1, v2), 0.0, 0.0, CENTRES) {
        return vec4<u32>(0u);
    }
    let seen = extent(tile, v0, v1, v2);
    if SHEETED && !seen.tight {
        // in a sheet t ends soon: the triangle may lie before its start or beyond its end
        let lo = min(v0, min(v1, v2));
        let hi = max(v0, max(v1, v2));
        let rounding = vec3<f32>(BOUND_SLACK * params.vertex_reach);
        if !node_meets(node_index(0u, x, y), 0.5 * (lo + hi), 0.5 * (hi - lo) + rounding) {
            return vec4<u32>(0u);
        }
    }
    return pixels_within(seen, TILE);
}

// Pairs the triangle with the cells of the tile, and with the box of pixels to look at: with a lone cell as the tile's
// bounds say, with each of several as its own do.
fn emit(slot: u32, tile: u32, in_tile: vec4<u32>, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) {
    let first = tile_start[tile];
    let end = tile_start[tile + 1u];
    for (var cell = first; cell < end; cell++) {
        var in_cell = in_tile;
        if end - first > 1u {
            let own = cell_pixels(cell, v0, v1, v2);
            in_cell = vec4<u32>(max(in_tile.xy, own.xy), min(in_tile.zw, own.zw));
            if is_empty(in_cell) {
                continue;
            }
        }
        let at = atomicAdd(&counters[COUNT_PAIRS], 1u);
        if at < params.pair_capacity {
            pairs[at] = pair_pack(slot, cell, in_cell.xy, in_cell.zw - 1u);
        }
    }
}
