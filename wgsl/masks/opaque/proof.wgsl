// Proofs without alpha masks.

#import arithmetic
#import rays/straight/triangle_proof.wgsl

fn mask_side(slot: u32, q: Weighed, v: array<real3, 3>) -> i32 {
    return 1;
}
