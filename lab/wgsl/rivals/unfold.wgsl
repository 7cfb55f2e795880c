// unfold: one thread per pixel of the band.
// Reads the pixel's ray and the nearest texel of the cube map that it goes through; writes the visibility key of what is there.

#import arithmetic
#import keys/key.wgsl
#import rays/pixel
#import rivals/face
#import rivals/layout.wgsl
#import rivals/range.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import vertices/triangle.wgsl

var<storage, read_write> visibility: array<vec2<u32>>;
var picture: texture_2d<u32>;

@compute @workgroup_size(64)
fn unfold(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let pixel = item_index(group, groups, lane);
    if pixel >= params.width * params.height {
        return;
    }
    let x = pixel % params.width;
    let y = pixel / params.width;
    if !has_ray(0u, x, y) {
        return;
    }
    let d = pixel_ray(0u, x, y, 0.0).d;
    let face = face_of(d);
    let on = on_face(face, d);
    let place = clamp((on.xy / on.z * 0.5 + 0.5) * f32(cube.side), vec2<f32>(0.0), vec2<f32>(f32(cube.side) - 1.0));
    let corner = vec2<u32>(face % 3u, face / 3u) * cube.side;
    let seen = textureLoad(picture, corner + vec2<u32>(place), 0);
    let t = bitcast<f32>(seen.y) / on.z;
    if seen.x != NONE && in_range(t) {
        visibility[pixel] = ~visibility_key(0u, real(t), seen.x & ID_MASK);
    }
}
