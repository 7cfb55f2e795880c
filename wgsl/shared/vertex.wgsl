// A vertex relative to the anchor, rounded to f32.
// Provides: vertex
// Binds: vertices_hi

fn vertex(index: u32) -> vec3<f32> {
    return vec3<f32>(vertices_hi[3u * index], vertices_hi[3u * index + 1u], vertices_hi[3u * index + 2u]);
}
