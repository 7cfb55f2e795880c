// What proofs about hits make of pixels. In a first step the nearest bound is found in each pixel behind which something is proven to be met;
// in a second all that may be met before it is compared with what was found; in a third the plane is written.
// `proofs` has two words per pixel: the complement of that bound, so that 0 is none, and flags.

#import arithmetic
#import depth/nearness.wgsl
#import keys/key.wgsl
#import rays/proof.wgsl
#import shared/params.wgsl
#import shared/planes.wgsl

var<storage, read> visibility: array<u32>;
var<storage, read_write> proofs: array<atomic<u32>>;

const PROOF_SURE: u32 = 1u;        // what was found is proven to be met
const PROOF_CONTESTED: u32 = 2u;   // something else may be met first
const PROOF_RECHECKED: u32 = 4u;   // f32 did not prove all

const STEP_BOUND: u32 = 0u;
const STEP_PIXELS: u32 = 2u;

// Of a triangle or sphere in a pixel that it may be seen in.
fn weigh(proof: Proof, id: u32, layer: u32, pixel: u32, is_by_f32: bool) {
    if step.value == STEP_BOUND {
        if proof.sure {
            atomicMax(&proofs[2u * pixel], ~(nearness(layer, finite(proof.far)) + 1u));
        }
    } else if nearness(layer, finite(proof.near)) - 1u <= ~atomicLoad(&proofs[2u * pixel]) {
        var flags = select(PROOF_RECHECKED, 0u, is_by_f32);
        let won = vec2<u32>(visibility[2u * pixel], visibility[2u * pixel + 1u]);
        let is_found = any(won != vec2<u32>(0u)) && key_id(~won) == id && key_layer(~won) == layer;
        flags |= select(PROOF_CONTESTED, PROOF_SURE, is_found && proof.sure);
        atomicOr(&proofs[2u * pixel + 1u], flags);
    }
}

fn finite(t: real) -> f32 {
    return f32(min(max(t, -FARTHEST), FARTHEST));
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
