// recheck: one thread per item that raster left to recheck.
// Reads recheck_items, pairs, triangles, vertices, cells and the camera's rays; finds in recheck arithmetic which of an item's pixels
// the triangle covers, and merges their keys.
// Needs: COUNT_RECHECKED, COUNT_RECHECK_ITEMS, NONE, TILE, cell_bundle, first_bit, is_between, item_index, merge_hits, pair_slot,
//   pair_tile, perturbed, pixel_bundle, real, real3, vertex_real, with_bit, without_bit
// Binds: cells, counters, pairs, params, recheck_items, step, tile_start, triangles

@compute @workgroup_size(64)
fn recheck(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take an item
    let index = item_index(group, groups, lane);
    if index >= min(atomicLoad(&counters[COUNT_RECHECK_ITEMS]), params.recheck_capacity) {
        return;
    }
    let item = recheck_items[index];
    let pair = pairs[item.x >> 1u];
    let tile = pair_tile(pair);
    let triangle = triangles[pair_slot(pair)];
    let uncertain = select(vec2<u32>(item.y, 0u), vec2<u32>(0u, item.y), (item.x & 1u) != 0u);
    if step.value == 0u {
        atomicAdd(&counters[COUNT_RECHECKED], countOneBits(item.y));
    }

    // recheck it, piece by piece
    let v = array<real3, 3>(vertex_real(triangle.x), vertex_real(triangle.y), vertex_real(triangle.z));
    for (var k = tile_start[tile]; k < tile_start[tile + 1u]; k++) {
        let cell = cells[k];
        let whole = cell_bundle(cell);
        var covered = vec2<u32>(0u);
        var left = uncertain & vec2<u32>(cell.mask_lo, cell.mask_hi);
        loop {
            let bit = first_bit(left);
            if bit == NONE {
                break;
            }
            left = without_bit(left, bit);
            let b = pixel_bundle(whole, cell, bit % TILE, bit / TILE);
            if is_between(perturbed(b, real(params.scene_size)), v) {
                covered = with_bit(covered, bit);
            }
        }
        if any(covered != vec2<u32>(0u)) {
            merge_hits(cell, pair_slot(pair), triangle, whole, v, covered);
        }
    }
}
