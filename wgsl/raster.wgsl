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
    let id = triangle_id(triangle);
    if is_apart(id) {
        return;
    }

    // find the pixels that it covers
    let owned = vec2<u32>(cell.mask_lo, cell.mask_hi) & box_mask(pair_from(pair), pair_to(pair));
    let found = coverage(cell, owned, pair_from(pair), pair_to(pair), vertex(triangle.x), vertex(triangle.y), vertex(triangle.z));
    if COUNTING && step.value == 0u {
        atomicAdd(&counters[COUNT_FRAGMENTS_TESTED], countOneBits(owned.x) + countOneBits(owned.y));
    }
    if all((found.xy | found.zw) == vec2<u32>(0u)) {
        return;
    }
    let whole = cell_bundle(cell);
    let v0 = vertex_real(triangle.x);
    let v1 = vertex_real(triangle.y);
    let v2 = vertex_real(triangle.z);
    var covered = settled(cell, whole, found, v0, v1, v2);

    // merge the depth of each
    let normal = cross(v1 - v0, v2 - v0);
    let facing = select(real(1.0), real(-1.0), triangle_reversed(triangle));
    let hidden = select(real(0.0), facing, (triangle.w & ONE_SIDED) != 0u);
    let depth = cell_depth(whole, normal, array<real3, 3>(v0, v1, v2), hidden);
    let corner = tile_corner(cell.tile);
    let layer = tile_layer(cell.tile);
    var kept = 0u;
    loop {
        let bit = first_bit(covered);
        if bit == NONE {
            break;
        }
        covered = without_bit(covered, bit);
        let meeting = pixel_depth(depth, cell, bit % TILE, bit / TILE);
        let pixel = (corner.y + bit / TILE) * params.width + corner.x + bit % TILE;
        if meeting.visible && !starts_on(pixel, id) {
            merge(pixel, ~visibility_key(layer, meeting.t, id));
            kept++;
        }
    }
    if COUNTING && step.value == 0u {
        atomicAdd(&counters[COUNT_FRAGMENTS_KEPT], kept);
    }
}
