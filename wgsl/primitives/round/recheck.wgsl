// Items of triangles, spheres and capsules.

#import arithmetic
#import keys/key.wgsl
#import keys/merge
#import nodes/slabs.wgsl
#import optics/start
#import primitives/round/capsule.wgsl
#import primitives/round/chord.wgsl
#import primitives/round/end.wgsl
#import rays/affine_bundle.wgsl
#import rays/bundle
#import rays/meeting.wgsl
#import recheck.wgsl
#import shared/hits.wgsl
#import shared/params.wgsl
#import vertices/triangle.wgsl

fn recheck_primitive(slot: u32, triangle: vec4<u32>, is_proven: bool, cell: Cell, bit: u32) {
    if is_round(triangle) {
        recheck_round(triangle, is_proven, cell, bit);
    } else {
        recheck_triangle(slot, triangle, is_proven, cell, bit);
    }
}

fn recheck_round(triangle: vec4<u32>, is_proven: bool, cell: Cell, bit: u32) {
    let id = triangle_id(triangle);
    let b = pixel_bundle(cell_bundle(cell), cell, bit % TILE, bit / TILE);
    let meeting = round_meeting(b, capsule_of(triangle), is_proven, (triangle.w & ONE_SIDED) == 0u);
    let corner = tile_corner(cell.tile);
    let pixel = (corner.y + bit / TILE) * params.width + corner.x + bit % TILE;
    if meeting.visible && start_of(pixel) != id {
        merge(pixel, ~visibility_key(tile_layer(cell.tile), meeting.t, id));
        if COUNTING && step.value == 0u {
            atomicAdd(&counters[COUNT_FRAGMENTS_KEPT], 1u);
        }
    }
}

// The first t in range at which the ray is on the surface; where it leaves it, its back is seen. In a chain a hit within rounding beyond an
// end of its segment counts as on that end.
fn round_meeting(b: Bundle, s: Capsule, is_met: bool, two_sided: bool) -> Meeting {
    let chord = chord_of(b, s);
    var t_min = real_from_bits(params.t_words.xy);
    var t_max = real_from_bits(params.t_words.zw);
    let from_t = t_min;
    let to_t = t_max;
    if SLABBED {
        let margin = end_margin(b, s, chord.below);
        t_min -= margin;
        t_max += margin;
    }
    let enters = chord.enters >= t_min && chord.enters <= t_max;
    let leaves = two_sided && chord.leaves >= t_min && chord.leaves <= t_max;
    let t = select(chord.leaves, chord.enters, enters);
    return Meeting(select(t, min(max(t, from_t), to_t), SLABBED), (is_met || chord.below >= 0.0) && (enters || leaves));
}
