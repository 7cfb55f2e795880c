// What to write and how to light it.
struct Shading {
    // plane of each channel, NONE where it was not asked for
    plane_r: u32,
    plane_g: u32,
    plane_b: u32,
    plane_a: u32,
    plane_z: u32,
    plane_t: u32,
    plane_triangle: u32,
    plane_piece: u32,
    plane_u: u32,
    plane_v: u32,
    light_count: u32,       // 0: one headlight along each pixel's ray
    has_normals: u32,
    background: vec3<f32>,
    ambient: f32,
}
