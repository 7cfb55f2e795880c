// A vertex relative to the anchor, as stored.
fn vertex_real(index: u32) -> real3 {
    let hi = vertex(index);
    let lo = vec3<f32>(vertices_lo[3u * index], vertices_lo[3u * index + 1u], vertices_lo[3u * index + 2u]);
    return real3(hi) + real3(lo);
}
