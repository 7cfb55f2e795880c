// raster: one thread per (slot, cell) pair.
// Reads pairs, triangles, vertices, cells and the camera's rays; merges the visibility key of every pixel that the
// triangle covers at a t in range, and leaves those whose coverage f32 does not prove to recheck, as doubts. Keys are complemented,
// so that the nearest hit is the largest and 0 is no hit. The list of doubts may overflow: the counter keeps counting.

// Nothing is proven.
override DOUBTING: bool = false;

@compute @workgroup_size(64)
fn raster(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pair
    let index = item_index(group, groups, lane);
    if index >= min(atomicLoad(&counters[COUNT_PAIRS]), params.pair_capacity) {
        return;
    }
    let pair = pairs[index];
    let cell = cells[pair_cell(pair)];
    let triangle = triangles[pair_slot(pair)];
    let id = triangle_id(triangle);
    if is_apart(id) {
        return;
    }

    // find the pixels that it covers
    let owned = vec2<u32>(cell.mask_lo, cell.mask_hi) & box_mask(pair_from(pair), pair_to(pair));
    var found = vec4<u32>(0u, 0u, owned);
    if !DOUBTING {
        found = coverage(cell, owned, pair_from(pair), pair_to(pair), vertex(triangle.x), vertex(triangle.y), vertex(triangle.z));
    }
    if COUNTING && step.value == 0u {
        atomicAdd(&counters[COUNT_FRAGMENTS_TESTED], countOneBits(owned.x) + countOneBits(owned.y));
    }
    if all((found.xy | found.zw) == vec2<u32>(0u)) {
        return;
    }
    leave_to_recheck(2u * index, found.z);
    leave_to_recheck(2u * index + 1u, found.w);
    if all(found.xy == vec2<u32>(0u)) {
        return;
    }

    // merge the depth of each
    let v = array<real3, 3>(vertex_real(triangle.x), vertex_real(triangle.y), vertex_real(triangle.z));
    merge_hits(cell, triangle, cell_bundle(cell), v, found.xy);
}

// A doubt: twice the pair's index, 1 more for the tile's lower half; and the pixels there.
fn leave_to_recheck(half: u32, doubtful: u32) {
    if doubtful != 0u {
        let at = atomicAdd(&counters[COUNT_DOUBTS], 1u);
        if at < params.doubt_capacity {
            doubts[at] = vec2<u32>(half, doubtful);
        }
    }
}
