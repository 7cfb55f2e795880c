// take_samples: one thread per pixel of the band.
// Reads a picture of ids and depths that the rasterizer made, four samples a pixel; writes visibility keys, of the first sample, and a record
// in `samples` for each pixel whose samples do not all see one triangle, with its number into `edge_of`.

#import arithmetic
#import keys/key.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import vertices/triangle.wgsl

var<storage, read_write> edge_of: array<u32>;
var<storage, read_write> samples: array<vec2<u32>>;
var<storage, read_write> visibility: array<vec2<u32>>;
var picture: texture_multisampled_2d<u32>;

@compute @workgroup_size(64)
fn take_samples(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let pixel = item_index(group, groups, lane);
    if pixel >= params.width * params.height {
        return;
    }
    let first = sample_at(pixel, 0u);
    var alike = true;
    for (var n = 1u; n < SAMPLES; n++) {
        alike &= sample_at(pixel, n).x == first.x;
    }
    visibility[pixel] = key_of(first);
    var record = 0u;
    if !alike {
        record = atomicAdd(&counters[COUNT_EDGES], 1u) + 1u;
    }
    edge_of[pixel] = record;
    if record == 0u || record > params.edge_capacity {
        return;
    }
    let at = (record - 1u) * (SAMPLES + 1u);
    samples[at] = vec2<u32>(pixel, select(first.x & ID_MASK, NONE, first.x == NONE));
    for (var n = 0u; n < SAMPLES; n++) {
        samples[at + 1u + n] = key_of(sample_at(pixel, n));
    }
}

override SAMPLES: u32 = 4u;

// Layer and id, and the bits of t.
fn sample_at(pixel: u32, n: u32) -> vec2<u32> {
    let halves = textureLoad(picture, vec2<u32>(pixel % params.width, pixel / params.width), n);
    return vec2<u32>(halves.x | (halves.y << 16u), halves.z | (halves.w << 16u));
}

fn key_of(seen: vec2<u32>) -> vec2<u32> {
    if seen.x == NONE {
        return vec2<u32>(0u);
    }
    return ~visibility_key(seen.x >> 28u, real(bitcast<f32>(seen.y)), seen.x & ID_MASK);
}
