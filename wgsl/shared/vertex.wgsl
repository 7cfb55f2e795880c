// Triangles, and vertices relative to the anchor, rounded to f32.
// Provides: triangle_at, vertex
// Needs: table_texel
// Binds: triangles, vertices

// The packed triangle of a slot.
fn triangle_at(slot: u32) -> vec4<u32> {
    return textureLoad(triangles, table_texel(slot), 0);
}

fn vertex(index: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(textureLoad(vertices, table_texel(2u * index), 0).xyz);
}
