// What a fragment leaves in the picture that take reads.
// Provides: Drawn, clip_place, drawn, file_normal, is_back_face
// Needs: ONE_SIDED, triangle_reversed
// Binds: params

struct Drawn {
    @location(0) seen: vec2<u32>,       // layer and id, and the bits of t
    @builtin(frag_depth) depth: f32,    // larger is nearer, those of lower layers first
}

fn drawn(layer: u32, id: u32, t: f32) -> Drawn {
    let near = 0.5 / (1.0 + abs(t));
    let depth = select(1.0 - near, near, t >= 0.0);
    // a chain's t is in [0, 1]; of a lone layer all of the depth's bits are its t's
    let sorted = select((f32(LAYERS - 1u - layer) + depth) / f32(LAYERS), depth, LAYERS == 1u);
    return Drawn(vec2<u32>((layer << 28u) | id, bitcast<u32>(t)), sorted);
}

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
