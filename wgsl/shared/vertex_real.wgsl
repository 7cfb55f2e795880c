// Vertices in recheck arithmetic.
// Provides: vertex_lo, vertex_real
// Needs: real3, table_texel, vertex
// Binds: vertices

// A vertex relative to the anchor, as stored.
fn vertex_real(index: u32) -> real3 {
    return real3(vertex(index)) + real3(vertex_lo(index));
}

fn vertex_lo(index: u32) -> vec3<f32> {
    let first = textureLoad(vertices, table_texel(2u * index), 0).w;
    let more = textureLoad(vertices, table_texel(2u * index + 1u), 0).xy;
    return bitcast<vec3<f32>>(vec3<u32>(first, more));
}
