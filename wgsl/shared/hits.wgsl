// The hits of a pair's triangle, merged into the visibility buffer.

#import arithmetic
#import keys/key.wgsl
#import keys/merge
#import masks/opacity
#import nodes/slabs.wgsl
#import optics/start
#import rays/affine_bundle.wgsl
#import rays/coverage
#import shared/bits.wgsl
#import shared/params.wgsl
#import vertices/triangle.wgsl

override COUNTING: bool = false;

// Merges the visibility keys of all covered pixels (at least one) where the triangle is visible at a t in range.
fn merge_hits(cell: Cell, slot: u32, triangle: vec4<u32>, whole: Bundle, v: array<real3, 3>, pixels: vec2<u32>) {
    let id = triangle_id(triangle);
    let normal = cross(v[1] - v[0], v[2] - v[0]);
    let facing = select(real(1.0), real(-1.0), triangle_reversed(triangle));
    let back_sign = select(real(0.0), facing, (triangle.w & ONE_SIDED) != 0u);
    let depth = cell_depth(whole, normal, v, back_sign, slot);
    let corner = tile_corner(cell.tile);
    let layer = tile_layer(cell.tile);
    var covered = pixels;
    var kept = 0u;
    loop {
        let bit = first_bit(covered);
        covered = without_bit(covered, bit);
        let place = corner + vec2<u32>(bit % TILE, bit / TILE);
        take_place(place);
        let meeting = pixel_depth(depth, cell, bit % TILE, bit / TILE);
        let pixel = place.y * params.width + place.x;
        if meeting.visible && start_of(pixel) != id {
            merge(pixel, ~visibility_key(layer, meeting.t, id));
            kept++;
        }
        if all(covered == vec2<u32>(0u)) {
            break;
        }
    }
    if COUNTING && step.value == 0u {
        atomicAdd(&counters[COUNT_FRAGMENTS_KEPT], kept);
    }
}
