// mip: one thread per texel of a level of an image.
// Reads the next finer level; writes the mean of the texels that each texel covers there.

#import shared/items.wgsl

var finer: texture_2d<f32>;
var coarser: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(64)
fn mip(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let size = textureDimensions(coarser);
    let index = item_index(group, groups, lane);
    if index >= size.x * size.y {
        return;
    }
    let own = vec2<u32>(index % size.x, index / size.x);

    // of an odd number of texels each covers parts of three
    let finer_size = vec2<f32>(textureDimensions(finer));
    let scale = finer_size / vec2<f32>(size);
    let low = vec2<f32>(own) * scale;
    let high = vec2<f32>(own + 1u) * scale;
    let last = vec2<u32>(min(ceil(high - 1e-3), finer_size));
    var sum = vec4<f32>(0.0);
    for (var y = u32(low.y); y < last.y; y++) {
        for (var x = u32(low.x); x < last.x; x++) {
            let at = vec2<f32>(f32(x), f32(y));
            let covered = min(at + 1.0, high) - max(at, low);
            sum += covered.x * covered.y * textureLoad(finer, vec2<u32>(x, y), 0);
        }
    }
    textureStore(coarser, own, nearest_half(sum / (scale.x * scale.y)));
}

// The nearest numbers of 11 bits: adapters may cut off what half floats do not hold, and each level would darken.
fn nearest_half(v: vec4<f32>) -> vec4<f32> {
    let bits = bitcast<vec4<u32>>(v);
    let even = (bits >> vec4<u32>(13u)) & vec4<u32>(1u);
    return bitcast<vec4<f32>>((bits + vec4<u32>(0xfffu) + even) & vec4<u32>(0xffffe000u));
}
