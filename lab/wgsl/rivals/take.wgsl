// take: one thread per pixel of the band.
// Reads a picture of ids and depths that the rasterizer made; writes visibility keys.

#import arithmetic
#import keys/key.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import vertices/triangle.wgsl

var<storage, read_write> visibility: array<vec2<u32>>;
var picture: texture_2d<u32>;

@compute @workgroup_size(64)
fn take(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let pixel = item_index(group, groups, lane);
    if pixel >= params.width * params.height {
        return;
    }
    let seen = textureLoad(picture, vec2<u32>(pixel % params.width, pixel / params.width), 0);
    if seen.x != NONE {
        let t = real(bitcast<f32>(seen.y));
        visibility[pixel] = ~visibility_key(seen.x >> 28u, t, seen.x & ID_MASK);
    }
}
