// What draws of triangles share.

#import shared/params.wgsl
#import vertices/triangle.wgsl

override LAYERS: u32 = 1u;

// A place in band pixels, centres at whole numbers, as the rasterizer has it.
fn clip_place(q: vec2<f32>) -> vec2<f32> {
    let size = vec2<f32>(f32(params.width), f32(params.height));
    return (q + 0.5) / size * vec2<f32>(2.0, -2.0) + vec2<f32>(-1.0, 1.0);
}

// A triangle that only one side of is visible shows the other to this ray.
fn is_back_face(packed_id: u32, normal: vec3<f32>, d: vec3<f32>) -> bool {
    return (packed_id & ONE_SIDED) != 0u && dot(normal, d) >= 0.0;
}

// Counter-clockwise as the file has it.
fn file_normal(triangle: vec4<u32>, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> vec3<f32> {
    return cross(v1 - v0, v2 - v0) * select(1.0, -1.0, triangle_reversed(triangle));
}
