// certify: one thread per (slot, tile) pair, twice, after all pairs were rastered and rechecked; then one per pixel of the band.
// Reads what raster reads, and the visibility buffer. The first dispatch finds in each pixel the nearest bound behind which some triangle
// is proven to be met; the second compares every triangle that may be met before it with the one that was found; the third writes
// the plane: 2 proven by f32, 1 by recheck arithmetic, 0 not.
// `proofs` has two words per pixel: the complement of that bound, so that 0 is none, and flags.
// Needs: COUNT_PAIRS, COVERAGE_PROVES, Cell, ENDLESS, NONE, ONE_SIDED, TILE, bit_mask, box_mask, cell_bundle, coverage, first_bit,
//   item_index, key_id, key_layer, nearness, pair_from, pair_slot, pair_tile, pair_to, pixel_proof, real, real3, tile_corner, tile_layer,
//   triangle_at, triangle_id, triangle_reversed, vertex, vertex_real, without_bit
// Binds: cells, counters, pairs, params, planes, proofs, step, tile_start, visibility

const PROOF_SURE: u32 = 1u;        // what was found is proven to be met
const PROOF_CONTESTED: u32 = 2u;   // something else may be met first
const PROOF_RECHECKED: u32 = 4u;   // f32 did not prove all

const STEP_BOUND: u32 = 0u;
const STEP_PIXELS: u32 = 2u;


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
        let proof = pixel_proof(cell, whole, bit % TILE, bit / TILE, v, back_sign, is_inside);
        if !proof.may {
            continue;
        }
        let pixel = (corner.y + bit / TILE) * params.width + corner.x + bit % TILE;
        if step.value == STEP_BOUND {
            if proof.sure {
                atomicMax(&proofs[2u * pixel], ~(nearness(layer, finite(proof.far)) + 1u));
            }
        } else if nearness(layer, finite(proof.near)) - 1u <= ~atomicLoad(&proofs[2u * pixel]) {
            var flags = select(PROOF_RECHECKED, 0u, is_inside);
            let won = vec2<u32>(visibility[2u * pixel], visibility[2u * pixel + 1u]);
            let is_found = any(won != vec2<u32>(0u)) && key_id(~won) == id && key_layer(~won) == layer;
            flags |= select(PROOF_CONTESTED, PROOF_SURE, is_found && proof.sure);
            atomicOr(&proofs[2u * pixel + 1u], flags);
        }
    }
}

fn finite(t: real) -> f32 {
    return f32(min(max(t, -ENDLESS), ENDLESS));
}

fn write_certainty(pixel: u32) {
    let count = params.width * params.height;
    if pixel >= count || PLANE_CERTIFIED == NONE {
        return;
    }
    let flags = atomicLoad(&proofs[2u * pixel + 1u]);
    let is_hit = any(vec2<u32>(visibility[2u * pixel], visibility[2u * pixel + 1u]) != vec2<u32>(0u));
    let is_proven = (flags & (PROOF_SURE | PROOF_CONTESTED)) == select(0u, PROOF_SURE, is_hit);
    planes[PLANE_CERTIFIED * count + pixel] = select(0u, select(2u, 1u, (flags & PROOF_RECHECKED) != 0u), is_proven);
}
