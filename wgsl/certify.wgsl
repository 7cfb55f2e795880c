// certify: one thread per (slot, tile) pair, twice, after all pairs were rastered and rechecked; then one per pixel of the band.
// Reads what raster reads, and the visibility buffer. The first dispatch finds in each pixel the nearest bound behind which some triangle
// is proven to be met; the second compares every triangle that may be met before it with the one that was found; the third writes
// the plane: 2 proven by f32, 1 by recheck arithmetic, 0 not.

#import arithmetic
#import masks/holes
#import masks/opacity
#import nodes/slabs.wgsl
#import nodes/tables.wgsl
#import pairs/pair.wgsl
#import rays/bundle
#import rays/certainty.wgsl
#import rays/coverage
#import rays/triangle_proof
#import shared/bits.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import vertices/real
#import vertices/triangle.wgsl
#import vertices/vertex

var<storage, read> pairs: array<vec2<u32>>;

@compute @workgroup_size(64)
fn certify(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pair
    let index = item_index(group, groups, lane);
    if step.value == STEP_PIXELS {
        write_certainty(index);
        return;
    }
    if index >= min(atomicLoad(&counters[COUNT_PAIRS]), params.pair_capacity) {
        return;
    }
    let pair = pairs[index];
    let tile = pair_tile(pair);
    let triangle = triangle_at(pair_slot(pair));
    let within = box_mask(pair_from(pair), pair_to(pair));
    let v = array<real3, 3>(vertex_real(triangle.x), vertex_real(triangle.y), vertex_real(triangle.z));
    for (var k = tile_start[tile]; k < tile_start[tile + 1u]; k++) {
        let cell = cells[k];
        let owned = vec2<u32>(cell.mask_lo, cell.mask_hi) & within;
        if any(owned != vec2<u32>(0u)) {
            prove(cell, owned, pair, triangle, v);
        }
    }
}

// Proves what can be of a pair's triangle in the owned pixels of a cell, one by one.
fn prove(cell: Cell, owned: vec2<u32>, pair: vec2<u32>, triangle: vec4<u32>, v: array<real3, 3>) {
    let found = coverage(cell, owned, pair_from(pair), pair_to(pair), vertex(triangle.x), vertex(triangle.y), vertex(triangle.z));
    let id = triangle_id(triangle);
    let slot = pair_slot(pair);
    let whole = cell_bundle(cell);
    let facing = select(1, -1, triangle_reversed(triangle));
    let back_sign = select(0, facing, (triangle.w & ONE_SIDED) != 0u);
    let corner = tile_corner(cell.tile);
    let layer = tile_layer(cell.tile);
    var left = found.xy | found.zw;
    loop {
        let bit = first_bit(left);
        if bit == NONE {
            break;
        }
        left = without_bit(left, bit);
        let is_inside = COVERAGE_PROVES && any((found.xy & bit_mask(bit)) != vec2<u32>(0u));
        take_place(corner + vec2<u32>(bit % TILE, bit / TILE));
        let proof = pixel_proof(cell, whole, bit % TILE, bit / TILE, slot, v, back_sign, is_inside);
        if !proof.may {
            continue;
        }
        let pixel = (corner.y + bit / TILE) * params.width + corner.x + bit % TILE;
        // masks are proven in recheck arithmetic
        weigh(proof, id, layer, pixel, is_inside && is_solid(slot));
    }
}
