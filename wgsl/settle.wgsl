// settle: one thread per doubt that sample left, tile by tile.
// Reads doubts, pairs, triangles, vertices, cells and the samples' rays; settles in recheck arithmetic which of a doubt's samples the
// triangle covers, and merges their keys into the rows of `samples`.
// Needs: COUNT_SAMPLE_DOUBTS, STRIPS, TILE, flat_of, item_index, pair_slot, pair_tile, real3, settle_samples, vertex_real
// Binds: cells, counters, doubts, pairs, params, tile_start, triangles

@compute @workgroup_size(64)
fn settle(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a doubt
    let index = item_index(group, groups, lane);
    if index >= min(atomicLoad(&counters[COUNT_SAMPLE_DOUBTS]), params.doubt_capacity / 2u) {
        return;
    }
    let doubt = doubts[2u * index];
    let pair = pairs[doubt.x];
    let tile = pair_tile(pair);
    let triangle = triangles[pair_slot(pair)];
    let strip = doubt.y >> 4u;
    let row = strip / STRIPS;
    let pixel = doubts[2u * index + 1u].x;
    let x = (pixel % params.width) % TILE;
    let y = (pixel / params.width) % TILE;
    let v = array<real3, 3>(vertex_real(triangle.x), vertex_real(triangle.y), vertex_real(triangle.z));
    let flat = flat_of(triangle, v);

    // settle it, piece by piece
    for (var k = tile_start[tile]; k < tile_start[tile + 1u]; k++) {
        let cell = cells[k];
        settle_samples(cell, k, vec2<u32>(x, y), 4u * (strip % STRIPS), doubt.y & 15u, row, triangle, flat, v);
    }
}
