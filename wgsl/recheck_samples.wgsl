// recheck_samples: one thread per item that sample left, tile by tile.
// Reads recheck_items, pairs, triangles, vertices, cells and the samples' rays; finds in recheck arithmetic which of an item's samples the
// triangle covers, and merges their keys into the records of `samples`.

#import arithmetic
#import nodes/tables.wgsl
#import pairs/pair.wgsl
#import samples/cells.wgsl
#import samples/hits.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import vertices/real
#import vertices/vertex

var<storage, read> pairs: array<vec2<u32>>;
var<storage, read> recheck_items: array<vec2<u32>>;

@compute @workgroup_size(64)
fn recheck_samples(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take an item
    let index = item_index(group, groups, lane);
    if index >= min(atomicLoad(&counters[COUNT_RECHECK_SAMPLES]), params.recheck_capacity / 2u) {
        return;
    }
    let item = recheck_items[2u * index];
    let pair = pairs[item.x];
    let tile = pair_tile(pair);
    let triangle = triangle_at(pair_slot(pair));
    let strip = item.y >> 4u;
    let record = strip / STRIPS;
    let pixel = recheck_items[2u * index + 1u].x;
    let x = (pixel % params.width) % TILE;
    let y = (pixel / params.width) % TILE;
    let v = array<real3, 3>(vertex_real(triangle.x), vertex_real(triangle.y), vertex_real(triangle.z));
    let flat = flat_of(triangle, v);

    // recheck it, piece by piece
    for (var k = tile_start[tile]; k < tile_start[tile + 1u]; k++) {
        let cell = cells[k];
        recheck_hits(cell, k, vec2<u32>(x, y), 4u * (strip % STRIPS), item.y & 15u, 0u, record, pair_slot(pair), triangle, flat, v);
    }
}
