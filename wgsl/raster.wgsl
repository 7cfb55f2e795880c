// raster: one thread per (slot, cell) pair.
// Reads pairs, triangles, vertices, cells and the camera's rays; merges the visibility key of every pixel that the
// triangle covers at a t in range. Keys are complemented, so that the nearest hit is the largest and 0 is no hit.

override COUNTING: bool = false;

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

    // test its pixels against the three edges
    let owned = vec2<u32>(cell.mask_lo, cell.mask_hi) & box_mask(pair_from(pair), pair_to(pair));
    let found = coverage(cell, owned, pair_from(pair), pair_to(pair), vertex(triangle.x), vertex(triangle.y), vertex(triangle.z));
    var covered = found.xy;
    var doubtful = found.zw;
    if COUNTING && step.value == 0u {
        atomicAdd(&counters[COUNT_FRAGMENTS_TESTED], countOneBits(owned.x) + countOneBits(owned.y));
    }
    if all((covered | doubtful) == vec2<u32>(0u)) {
        return;
    }

    // recheck the pixels whose signs are not proven
    let whole = cell_bundle(cell);
    let v0 = vertex_real(triangle.x);
    let v1 = vertex_real(triangle.y);
    let v2 = vertex_real(triangle.z);
    var rechecked = 0u;
    loop {
        let bit = first_bit(doubtful);
        if bit == NONE {
            break;
        }
        doubtful = without_bit(doubtful, bit);
        rechecked++;
        let b = pixel_bundle(whole, cell, bit % TILE, bit / TILE);
        let s01 = edge_side(b, v0, v1);
        if s01 == -edge_side(b, v0, v2) && s01 == edge_side(b, v1, v2) {
            covered = with_bit(covered, bit);
        }
    }
    if rechecked > 0u && step.value == 0u {
        atomicAdd(&counters[COUNT_RECHECKED], rechecked);
    }

    // merge the depth of the covered ones: t = N . (v0 h - p) / (N . d)
    let normal = cross(v1 - v0, v2 - v0);
    let depth = cell_depth(whole, normal, v0);
    let facing = select(real(1.0), real(-1.0), triangle_reversed(triangle));
    let one_sided = (triangle.w & ONE_SIDED) != 0u;
    let t_min = real(params.t_min.x) + real(params.t_min.y) + real(params.t_min.z);
    let t_max = real(params.t_max.x) + real(params.t_max.y) + real(params.t_max.z);
    let corner_x = (cell.tile % params.tiles_x) * TILE;
    let corner_y = (cell.tile / params.tiles_x) * TILE;
    var kept = 0u;
    loop {
        let bit = first_bit(covered);
        if bit == NONE {
            break;
        }
        covered = without_bit(covered, bit);
        let at = pixel_depth(depth, cell, bit % TILE, bit / TILE);
        if at.across == 0.0 || (one_sided && at.across * facing > 0.0) {
            continue;
        }
        let t = at.along / at.across;
        if t >= t_min && t <= t_max {
            let pixel = (corner_y + bit / TILE) * params.width + corner_x + bit % TILE;
            merge(pixel, ~visibility_key(t, triangle_id(triangle)));
            kept++;
        }
    }
    if COUNTING && step.value == 0u {
        atomicAdd(&counters[COUNT_FRAGMENTS_KEPT], kept);
    }
}
