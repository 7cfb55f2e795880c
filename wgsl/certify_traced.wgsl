// certify_traced: one thread per pixel, one workgroup per tile, twice, after all was traced and rechecked; then one per pixel of the band.
// Takes the place of certify where there are spheres or capsules.
// Reads what trace reads, and the visibility buffer. Follows each pixel's ray through the hierarchy, and proves in recheck arithmetic what can
// be of each primitive that it may meet; what f32 leaves out by its boxes is proven to be missed. Writes bounds and flags, and from
// them the plane.

#choose primitives certify_traced.wgsl
#import arithmetic
#import hierarchy/followed.wgsl
#import hierarchy/nodes.wgsl
#import masks/opacity
#import nodes/slabs.wgsl
#import nodes/tables.wgsl
#import pixels/tiles
#import primitives/round/capsule.wgsl
#import rays/affine_bundle.wgsl
#import rays/bundle
#import rays/certainty.wgsl
#import rays/path
#import rays/pixel
#import rays/proof.wgsl
#import rays/straight/round_proof.wgsl
#import rays/stretch
#import rays/triangle_proof
#import shared/bits.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import vertices/followed
#import vertices/real
#import vertices/traced
#import vertices/triangle.wgsl
#import vertices/vertex

var<storage, read_write> proofs: array<atomic<u32>>;

// The cell of this thread's pixel in the layer that it is followed in.
var<private> own_cell: u32;

@compute @workgroup_size(64)
fn certify(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel
    if step.value == STEP_PIXELS {
        write_certainty(item_index(group, groups, lane));
        return;
    }
    let at = pixel_at(group, groups, lane);
    if at.x >= params.width || at.y >= params.height {
        return;
    }

    // follow its ray in every layer
    let layers = select(1u, params.tiles_y / max(params.slab_rows * params.spans, 1u), SLABBED);
    var layer = 0u;
    // as in trace
    var is_finished = false;
    loop {
        if layer == layers {
            is_finished = true;
            break;
        }
        if has_ray(layer, at.x, at.y) {
            take_place(at);
            let path = path_of(layer, at.x, at.y);
            take_cell(path.item);
            let found = followed(path, stretch_of(path, 0u, bvh_scale()), nothing_seen(), 0u);
            if found.rounds >= ROUNDS && step.value != STEP_BOUND {
                atomicOr(&proofs[2u * (at.y * params.width + at.x) + 1u], PROOF_CONTESTED);
            }
        }
        layer++;
    }
    if !is_finished && step.value != STEP_BOUND {
        atomicOr(&proofs[2u * (at.y * params.width + at.x) + 1u], PROOF_CONTESTED);
    }
}

// Finds the cell that owns the pixel of an item.
fn take_cell(item: u32) {
    let tile = item >> 6u;
    let own = bit_mask(item & 63u);
    var k = tile_start[tile];
    let last = tile_start[tile + 1u] - 1u;
    loop {
        if k == last || any((vec2<u32>(cells[k].mask_lo, cells[k].mask_hi) & own) != vec2<u32>(0u)) {
            break;
        }
        k++;
    }
    own_cell = k;
}

// Nothing counts as seen: all along the ray is proven.
fn with_primitive(path: Path, stretch: Stretch, before: Seen, own: BvhTriangle) -> Seen {
    let cell = cells[own_cell];
    let triangle = triangle_at(own.slot);
    let tile = path.item >> 6u;
    let x = path.item % TILE;
    let y = (path.item & 63u) / TILE;
    let whole = cell_bundle(cell);
    let proof = primitive_proof(cell, whole, x, y, own.slot, triangle);
    if proof.may {
        let corner = tile_corner(tile);
        weigh(proof, triangle_id(triangle), tile_layer(tile), (corner.y + y) * params.width + corner.x + x, false);
    }
    return before;
}

fn primitive_proof(cell: Cell, whole: Bundle, x: u32, y: u32, slot: u32, triangle: vec4<u32>) -> Proof {
    let is_one_sided = (triangle.w & ONE_SIDED) != 0u;
    if is_round(triangle) {
        return round_proof(cell, whole, x, y, capsule_of(triangle), !is_one_sided);
    }
    let back_sign = select(0, select(1, -1, triangle_reversed(triangle)), is_one_sided);
    let v = array<real3, 3>(vertex_real(triangle.x), vertex_real(triangle.y), vertex_real(triangle.z));
    return pixel_proof(cell, whole, x, y, slot, v, back_sign, false);
}
