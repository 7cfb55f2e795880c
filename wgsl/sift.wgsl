// sift: one thread per point, down the tree of beams.
// Reads beams and points; writes to `found`, for each point: the number of nodes that may see it, then their indices, ascending, as
// many as there are slots. Lists overflow where the number is larger than `slots`; it is true up to `most`, and NONE for
// points that are too far away for f32.

#import project/beams.wgsl
#import project/half_meets.wgsl
#import shared/items.wgsl
#import shared/params.wgsl

var<uniform> chunk: Chunk;
var<storage, read> beams: array<Beam>;
var<storage, read> points: array<vec4<f32>>;
var<storage, read_write> found: array<u32>;

// Rounding of the difference of a point and an end, relative to both, 2^-24 each of the point, of the difference and of
// adding the tolerance: space for four.
const POINT_TOLERANCE: f32 = 2.4e-7;
// Never false where a ray of the beam passes through the point at a t in range. `x.w` is the point's own tolerance.
fn beam_meets(k: u32, x: vec4<f32>) -> bool {
    let p_lo = beams[k].p_lo;
    let p_hi = beams[k].p_hi;
    let d_lo = beams[k].d_lo;
    let d_hi = beams[k].d_hi;
    let above = x.xyz - p_lo + (vec3<f32>(x.w) + POINT_TOLERANCE * abs(p_lo));
    let below = p_hi - x.xyz + (vec3<f32>(x.w) + POINT_TOLERANCE * abs(p_hi));
    let ahead = vec2<f32>(max(chunk.t_min, 0.0), chunk.t_max);
    let behind = vec2<f32>(max(-chunk.t_max, 0.0), -chunk.t_min);
    return (chunk.t_max >= 0.0 && half_meets(above, below, d_lo, d_hi, ahead))
        || (chunk.t_min < 0.0 && half_meets(above, below, -d_hi, -d_lo, behind));
}

@compute @workgroup_size(64)
fn sift(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a point
    let index = item_index(group, groups, lane);
    if index >= chunk.points {
        return;
    }
    let x = points[index];
    let list = index * (chunk.slots + 1u);
    if x.w < 0.0 {
        found[list] = NONE;
        return;
    }

    // on to the next row, or past all that is below
    var count = 0u;
    var k = 0u;
    while k < chunk.beams && count <= chunk.most {
        var next = beams[k].next;
        if beam_meets(k, x) {
            let node = beams[k].node;
            if node == NONE {
                next = k + 1u;
            } else {
                if count < chunk.slots {
                    found[list + 1u + count] = node;
                }
                count++;
            }
        }
        k = next;
    }
    found[list] = count;
}
