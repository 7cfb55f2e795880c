// write: one thread per pixel of the band. Reads the colour planes; writes 8-bit sRGB of their tones with alpha 255, four bytes a
// word.

#import shading/tone.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import shared/planes.wgsl

var<storage, read_write> srgb8: array<u32>;

@compute @workgroup_size(64)
fn write(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel
    let pixel = item_index(group, groups, lane);
    let count = params.width * params.height;
    if pixel >= count {
        return;
    }
    // encode it
    let r = bitcast<f32>(planes[PLANE_R * count + pixel]);
    let g = bitcast<f32>(planes[PLANE_G * count + pixel]);
    let b = bitcast<f32>(planes[PLANE_B * count + pixel]);
    srgb8[pixel] = packed_srgb(vec3<f32>(r, g, b));
}
