// sample: one thread per (slot, tile) pair, once the edge pixels are listed.
// Reads what recheck reads, the listed pixels and which cells samples lie in; finds in f32, and where that proves nothing in recheck
// arithmetic, which samples of those pixels the triangle covers, and merges their keys into the records of `samples`: a pixel, and a
// visibility key per sample.

#import arithmetic
#import nodes/conics.wgsl
#import nodes/slabs.wgsl
#import nodes/tables.wgsl
#import pairs/pair.wgsl
#import samples/cells.wgsl
#import samples/hits.wgsl
#import samples/offsets.wgsl
#import shared/bits.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import vertices/real
#import vertices/vertex

var<storage, read> edge_of: array<u32>;
var<storage, read> nodes: array<Node>;
var<storage, read> pairs: array<vec2<u32>>;

@compute @workgroup_size(64)
fn sample(
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
    let within = box_mask(pair_from(pair), pair_to(pair));
    let corner = tile_corner(tile);
    let v = array<real3, 3>(vertex_real(triangle.x), vertex_real(triangle.y), vertex_real(triangle.z));
    let flat = flat_of(triangle, v);

    // find the listed pixels that it may cover, piece by piece
    for (var k = tile_start[tile]; k < tile_start[tile + 1u]; k++) {
        var left = pixels_in_part(k) & within;
        if all(left == vec2<u32>(0u)) {
            continue;
        }
        let cell = cells[k];
        let sides = conics(nodes[cell.node], vertex(triangle.x), vertex(triangle.y), vertex(triangle.z));
        loop {
            let bit = first_bit(left);
            if bit == NONE {
                break;
            }
            left = without_bit(left, bit);
            let x = bit % TILE;
            let y = bit / TILE;
            let number = edge_of[(corner.y + y) * params.width + corner.x + x];
            let place = (vec2<f32>(f32(x), f32(y)) + 0.5) * NODE_PX - 1.0;
            if number != 0u && may_cover(sides, place.x, place.y, SAMPLE_REACH * NODE_PX) {
                let covered = covered_samples(sides, place);
                recheck_hits(cell, k, vec2<u32>(x, y), 0u, covered.may, covered.sure, number - 1u, pair_slot(pair), triangle, flat, v);
            }
        }
    }
}

// Samples of a pixel that the triangle may cover, and those of them that it is proven to, as bits.
struct Covered {
    may: u32,
    sure: u32,
}

// The bounds of a node hold perturbed rays too.
fn covered_samples(sides: Conics, place: vec2<f32>) -> Covered {
    var covered = Covered(0u, 0u);
    for (var n = 0u; n < SAMPLES; n++) {
        let at = place + NODE_PX * sample_offset(n);
        let s01 = conic_sign(sides.e01, at.x, at.y, 0.0);
        let s20 = -conic_sign(sides.e02, at.x, at.y, 0.0);
        let s12 = conic_sign(sides.e12, at.x, at.y, 0.0);
        let least = min(s01, min(s20, s12));
        let most = max(s01, max(s20, s12));
        covered.may |= select(0u, 1u << n, least >= 0 || most <= 0);
        covered.sure |= select(0u, 1u << n, least > 0 || most < 0);
    }
    return covered;
}
