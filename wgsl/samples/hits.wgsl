// Coverage of one pixel's samples by a triangle, in recheck arithmetic.

#import arithmetic
#import keys/key.wgsl
#import keys/merge
#import masks/there
#import nodes/slabs.wgsl
#import rays/affine_bundle.wgsl
#import rays/bundle
#import rays/meeting.wgsl
#import rays/sample
#import rays/straight/meeting.wgsl
#import rays/straight/perturb.wgsl
#import rays/straight/sides.wgsl
#import samples/cells.wgsl
#import shared/bits.wgsl
#import shared/params.wgsl
#import vertices/triangle.wgsl

// Merges the keys of those of the samples from `first` on, bit by bit of `some`, that lie in the cell and that the triangle covers, which is
// known of those of `sure`.
fn recheck_hits(
    cell: Cell,
    number: u32,
    at: vec2<u32>,
    first: u32,
    some: u32,
    sure: u32,
    record: u32,
    slot: u32,
    triangle: vec4<u32>,
    flat: Flat,
    v: array<real3, 3>,
) {
    let whole = cell_bundle(cell);
    let own = bit_mask(at.y * TILE + at.x);
    var here = 0u;
    for (var left = some; left != 0u; left &= left - 1u) {
        let bit = firstTrailingBit(left);
        here |= select(0u, 1u << bit, any((pixels_of_sample(number, first + bit) & own) != vec2<u32>(0u)));
    }
    // loops of their own: software adapters take every branch
    var covered = here & sure;
    for (var left = here & ~sure; left != 0u; left &= left - 1u) {
        let bit = firstTrailingBit(left);
        let b = sample_bundle(whole, cell, at.x, at.y, first + bit);
        covered |= select(0u, 1u << bit, is_between(perturbed(b, real(params.scene_size)), v));
    }
    for (var left = covered; left != 0u; left &= left - 1u) {
        let n = first + firstTrailingBit(left);
        let b = sample_bundle(whole, cell, at.x, at.y, n);
        let met = flat_meeting(flat, b);
        if met.visible && is_there(slot, b) {
            merge(record * (SAMPLES + 1u) + 1u + n, ~visibility_key(tile_layer(cell.tile), met.t, triangle_id(triangle)));
        }
    }
}

// A triangle's plane, and its invisible side.
struct Flat {
    normal: real3,
    v: array<real3, 3>,
    reach: real,
    back_sign: real,
}

fn flat_of(triangle: vec4<u32>, v: array<real3, 3>) -> Flat {
    let facing = select(real(1.0), real(-1.0), triangle_reversed(triangle));
    let back_sign = select(real(0.0), facing, (triangle.w & ONE_SIDED) != 0u);
    return Flat(cross(v[1] - v[0], v[2] - v[0]), v, reach3(v), back_sign);
}

fn flat_meeting(q: Flat, b: Bundle) -> Meeting {
    let along = dot(q.normal, q.v[0] * b.h - b.p);
    let across = dot(q.normal, b.d);
    return ray_meeting(b, q.v, q.normal, along, across, end_rounding(b, q.normal, across, q.reach), q.back_sign);
}
