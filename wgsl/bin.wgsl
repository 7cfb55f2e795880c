// bin: one thread per triangle of a (triangle group, node) item of `tasks`, or per (triangle, node) item of `large`.
// Reads triangles, vertices and nodes; writes (slot, tile) pairs of the tiles under the node that the triangle may cover, by its extent
// and its three edge conics there, or of the one tile of the cell that the item names. `pairs` may overflow: the counter keeps counting.

#import bin/items
#import nodes/box_met.wgsl
#import nodes/conics.wgsl
#import nodes/extent.wgsl
#import nodes/index.wgsl
#import nodes/item_rays
#import nodes/tables.wgsl
#import nodes/within.wgsl
#import pairs
#import pairs/pair.wgsl
#import shared/params.wgsl
#import shared/places.wgsl
#import vertices/vertex

override COUNTING: bool = false;

@compute @workgroup_size(64)
fn bin(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a triangle and a node
    let item = bin_item(group, groups, lane);
    let address = item.address;
    let level = node_level(address);
    let node = item.node;
    let rays = item.rays;
    if item.slot == NONE {
        return;
    }
    let slot = item.slot;
    let triangle = triangle_at(slot);
    let v0 = vertex(triangle.x);
    let v1 = vertex(triangle.y);
    let v2 = vertex(triangle.z);

    // of incoherent rays, keep the pixels of the item's tile whose rays may meet the triangle's box
    let lo = min(v0, min(v1, v2));
    let hi = max(v0, max(v1, v2));
    let half = 0.5 * (hi - lo) + BOUND_TOLERANCE * max(abs(lo), abs(hi));
    let met = item_pixels(address, rays, node, 0.5 * (lo + hi), half);
    if is_empty(met) {
        return;
    }

    // bound the pixels it may cover, of a node's square or of the tile of one cell
    var corner = vec2<u32>(node_x(address), node_y(address)) << vec2<u32>(2u * level);
    var side = TILE << (2u * level);
    if level == LEVEL_CELL {
        let tile = cells[node_cell(address)].tile;
        corner = vec2<u32>(tile % params.tiles_x, tile / params.tiles_x);
        side = TILE;
    }
    let seen = close_extent(node, v0, v1, v2);
    var within = pixels_within(seen, side, SAMPLE_REACH);
    if !seen.tight && !box_met(node, v0, v1, v2) {
        within = vec4<u32>(0u);
    }
    let tile_lo = corner + within.xy / TILE;
    let tile_end = min(corner + (within.zw + TILE - 1u) / TILE, vec2<u32>(params.tiles_x, params.tiles_y));
    if is_empty(within) || any(tile_lo >= tile_end) {
        return;
    }

    // pair it with every tile there that its conics may cover
    let over_node = conics(node, v0, v1, v2);
    let s = f32(TILE) / f32(side);
    var tile = tile_lo;
    loop {
        let centre = (2.0 * vec2<f32>(tile - corner) + 1.0) * s - 1.0;
        if may_cover(over_node, centre.x, centre.y, s * (CENTRES + SAMPLE_REACH * NODE_PX)) {
            let from_px = (tile - corner) * TILE;
            let pixels = vec4<u32>(max(within.xy, from_px), min(within.zw, from_px + TILE)) - from_px.xyxy;
            let tile_index = tile.y * params.tiles_x + tile.x;
            let left = tile_pixels(tile_index, node, v0, v1, v2, pixels);
            list(slot, tile_index, vec4<u32>(max(left.xy, met.xy), min(left.zw, met.zw)));
        }
        tile.x++;
        if tile.x == tile_end.x {
            tile = vec2<u32>(tile_lo.x, tile.y + 1u);
        }
        if tile.y == tile_end.y {
            break;
        }
    }
    if COUNTING {
        let tiles = tile_end - tile_lo;
        atomicAdd(&counters[COUNT_PAIRS_TESTED], tiles.x * tiles.y);
    }
}

// Lists a pair if its box has a pixel.
fn list(slot: u32, tile: u32, pixels: vec4<u32>) {
    if is_empty(pixels) {
        return;
    }
    let at = take_places(COUNT_PAIRS, 1u);
    if at < params.pair_capacity {
        store(at, tile, pair_pack(slot, tile, pixels.xy, pixels.zw - 1u));
    }
}
