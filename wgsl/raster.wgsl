// raster: one thread per (slot, tile) pair.
// Reads pairs, triangles, vertices, cells and the camera's rays; merges the visibility key of every pixel that the
// triangle covers at a t in range, and leaves those whose coverage f32 does not prove to recheck. Keys are complemented,
// so that the nearest hit is the largest and 0 is no hit. The list recheck_items may overflow: the counter keeps counting.

#import arithmetic
#import nodes/tables.wgsl
#import optics/start
#import pairs/pair.wgsl
#import rays/bundle
#import rays/coverage
#import shared/bits.wgsl
#import shared/hits.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import shared/recheck_items.wgsl
#import vertices/real
#import vertices/triangle.wgsl
#import vertices/vertex

var<storage, read> pairs: array<vec2<u32>>;

// Nothing is proven.
override ALL_UNCERTAIN: bool = false;

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
    let tile = pair_tile(pair);
    let triangle = triangle_at(pair_slot(pair));
    let id = triangle_id(triangle);
    if is_excluded(id) {
        return;
    }
    if COUNTING && step.value == 0u {
        atomicAdd(&counters[COUNT_PAIRS_KEPT], 1u);
    }

    // find the pixels that it covers, piece by piece
    let within = box_mask(pair_from(pair), pair_to(pair));
    let v = array<real3, 3>(vertex_real(triangle.x), vertex_real(triangle.y), vertex_real(triangle.z));
    for (var k = tile_start[tile]; k < tile_start[tile + 1u]; k++) {
        let cell = cells[k];
        let owned = vec2<u32>(cell.mask_lo, cell.mask_hi) & within;
        if all(owned == vec2<u32>(0u)) {
            continue;
        }
        var found = vec4<u32>(0u, 0u, owned);
        if !ALL_UNCERTAIN {
            found = coverage(cell, owned, pair_from(pair), pair_to(pair), vertex(triangle.x), vertex(triangle.y), vertex(triangle.z));
        }
        if COUNTING && step.value == 0u {
            atomicAdd(&counters[COUNT_FRAGMENTS_TESTED], countOneBits(owned.x) + countOneBits(owned.y));
        }
        leave_to_recheck(pair_slot(pair), tile, 0u, found.z);
        leave_to_recheck(pair_slot(pair), tile, 32u, found.w);
        if any(found.xy != vec2<u32>(0u)) {
            merge_hits(cell, pair_slot(pair), triangle, cell_bundle(cell), v, found.xy);
        }
    }
}
