// recheck: one thread per item that was left to it.
// Reads recheck_items, triangles, vertices, cells and the camera's rays; finds in recheck arithmetic whether the triangle or sphere covers the
// item's pixel, where that is not proven, and at which t, and merges its key.

#import arithmetic
#import nodes/slabs.wgsl
#import nodes/tables.wgsl
#import primitives/recheck
#import rays/bundle
#import rays/straight/perturb.wgsl
#import rays/straight/sides.wgsl
#import shared/bits.wgsl
#import shared/hits.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import vertices/real
#import vertices/vertex

var<storage, read_write> recheck_items: array<vec2<u32>>;

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
    let slot = recheck_items[index].x & ~PROVEN;
    let is_proven = (recheck_items[index].x & PROVEN) != 0u;
    let tile = recheck_items[index].y >> 6u;
    let bit = recheck_items[index].y & 63u;
    let triangle = triangle_at(slot);

    // find the piece that owns the pixel
    let own = bit_mask(bit);
    var k = tile_start[tile];
    let last = tile_start[tile + 1u] - 1u;
    loop {
        if k == last || any((vec2<u32>(cells[k].mask_lo, cells[k].mask_hi) & own) != vec2<u32>(0u)) {
            break;
        }
        k++;
    }

    // recheck it
    let corner = tile_corner(tile);
    take_moment((corner.y + bit / TILE) * params.width + corner.x + bit % TILE);
    recheck_primitive(slot, triangle, is_proven, cells[k], bit);
}

// Merges the key of a triangle, if it covers the pixel of a cell.
fn recheck_triangle(slot: u32, triangle: vec4<u32>, is_proven: bool, cell: Cell, bit: u32) {
    let v = array<real3, 3>(vertex_real(triangle.x), vertex_real(triangle.y), vertex_real(triangle.z));
    let whole = cell_bundle(cell);
    // a loop: software adapters take every branch
    var covers = is_proven;
    var is_left = !is_proven;
    loop {
        if !is_left {
            break;
        }
        is_left = false;
        let b = pixel_bundle(whole, cell, bit % TILE, bit / TILE);
        covers = is_between(perturbed(b, real(params.scene_size)), v);
    }
    if covers {
        merge_hits(cell, slot, triangle, whole, v, bit_mask(bit));
    }
}
