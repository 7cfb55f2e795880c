// bin: one workgroup per (cluster, node) item of `work`, one thread per triangle.
// Reads triangles, vertices and nodes; writes (slot, cell) pairs of every tile under the node that the triangle may
// cover, by bounds on its three edge conics, or of the one cell that the item names. `pairs` may overflow: the counter
// keeps counting.

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

    // bound the pixel centres it may cover, of a node's square or of the tile of one cell
    let level = node_level(address);
    let lone = level == LEVEL_CELL;
    var at = 0u;
    var corner = vec2<u32>(node_x(address), node_y(address)) << vec2<u32>(2u * level);
    var side = TILE << (2u * level);
    if lone {
        let tile = cells[node_cell(address)].tile;
        at = cells[node_cell(address)].node;
        corner = vec2<u32>(tile % params.tiles_x, tile / params.tiles_x);
        side = TILE;
    } else {
        at = node_index(level, node_x(address), node_y(address));
    }
    let node = nodes[at];
    let where_seen = extent(node, v0, v1, v2);
    let within = pixels_within(where_seen, side);
    let lo = within.xy;
    let end = within.zw;
    let tile_lo = corner + lo / TILE;
    let tile_end = min(corner + (end + TILE - 1u) / TILE, vec2<u32>(params.tiles_x, params.tiles_y));
    if is_empty(within) || any(tile_lo >= tile_end) {
        count_tested(1u);
        return;
    }

    // pair it with the cells of the tiles in that box: all of a few tiles, of many those that its conics may cover
    let loose = node.rays != RAYS_AFFINE || side == TILE;
    let tiles = tile_end - tile_lo;
    let all_tiles = where_seen.tight && tiles.x * tiles.y <= FEW_TILES;
    var over_node: Conics;
    if !all_tiles {
        over_node = conics(node, v0, v1, v2);
    }
    let s = f32(TILE) / f32(side);
    var tested = 0u;
    var tile = tile_lo;
    // of a tile that several share, and what it may show of the triangle
    var cell = select(0u, node_cell(address), lone);
    var cell_end = select(0u, cell + 1u, lone);
    var in_tile = within;
    // one loop over tiles and over cells: software adapters run an inner one of each tile at least once
    loop {
        let by_cell = cell < cell_end;
        let tile_index = tile.y * params.tiles_x + tile.x;
        var leaf = tile_index;
        var pixels = in_tile;
        if by_cell {
            leaf = cells[cell].node;
        } else {
            let first = (tile - corner) * TILE;
            let centre = (2.0 * vec2<f32>(tile - corner) + 1.0) * s - 1.0;
            pixels = vec4<u32>(max(lo, first), min(end, first + TILE)) - first.xyxy;
            if !(all_tiles || may_cover(over_node, centre.x, centre.y, s * CENTRES)) {
                pixels = vec4<u32>(0u);
            }
        }
        // rays that the node bounds only loosely, or that were torn above: ask their own bounds
        if !is_empty(pixels) && (loose || leaf != tile_index) {
            let seen = leaf_pixels(leaf, v0, v1, v2);
            pixels = vec4<u32>(max(pixels.xy, seen.xy), min(pixels.zw, seen.zw));
        }
        if by_cell {
            list(slot, cell, pixels);
            cell++;
        } else {
            cell = tile_start[tile_index];
            cell_end = tile_start[tile_index + 1u];
            tested += cell_end - cell;
            if cell_end - cell == 1u {
                list(slot, cell, pixels);
            }
            if cell_end - cell == 1u || is_empty(pixels) {
                cell = cell_end;
            }
            in_tile = pixels;
        }
        if cell == cell_end {
            tile.x++;
            if tile.x == tile_end.x {
                tile = vec2<u32>(tile_lo.x, tile.y + 1u);
            }
            if tile.y == tile_end.y {
                break;
            }
        }
    }
    count_tested(max(tested, 1u));
}

// (triangle, cell) pairs looked at: the cells of the tiles in its box, or one where there is no box.
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

// The pixels of a tile that the triangle may cover by the bounds of a node of the tile, or of a cell in it.
fn leaf_pixels(index: u32, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> vec4<u32> {
    let leaf = nodes[index];
    if leaf.rays == RAYS_NONE {
        return vec4<u32>(0u);
    }
    let seen = extent(leaf, v0, v1, v2);
    let within = pixels_within(seen, TILE);
    if is_empty(within) || !may_cover(conics(leaf, v0, v1, v2), 0.0, 0.0, CENTRES) {
        return vec4<u32>(0u);
    }
    if SHEETED && !seen.tight {
        // in a sheet t ends soon: the triangle may lie before its start or beyond its end
        let lo = min(v0, min(v1, v2));
        let hi = max(v0, max(v1, v2));
        let rounding = BOUND_SLACK * max(abs(lo), abs(hi));
        if !node_meets(index, 0.5 * (lo + hi), 0.5 * (hi - lo) + rounding) {
            return vec4<u32>(0u);
        }
    }
    return within;
}

// Lists a pair, if there is a pixel to look at.
fn list(slot: u32, cell: u32, pixels: vec4<u32>) {
    if is_empty(pixels) {
        return;
    }
    let at = atomicAdd(&counters[COUNT_PAIRS], 1u);
    if at < params.pair_capacity {
        pairs[at] = pair_pack(slot, cell, pixels.xy, pixels.zw - 1u);
    }
}
