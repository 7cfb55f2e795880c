// Vertices in recheck arithmetic.
// Provides: vertex_lo, vertex_real
// Needs: real3, vertex
// Binds: vertices_lo

// A vertex relative to the anchor, as stored.
fn vertex_real(index: u32) -> real3 {
    return real3(vertex(index)) + real3(vertex_lo(index));
}

fn vertex_lo(index: u32) -> vec3<f32> {
    return vec3<f32>(vertices_lo[3u * index], vertices_lo[3u * index + 1u], vertices_lo[3u * index + 2u]);
}
