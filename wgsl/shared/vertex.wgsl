// Triangles, and vertices relative to the anchor, rounded to f32.
// Provides: table_texel, triangle_at, vertex
// Needs: TEXELS_A_ROW
// Binds: triangles, vertices

// The place of a texel of a table.
fn table_texel(index: u32) -> vec2<u32> {
    return vec2<u32>(index % TEXELS_A_ROW, index / TEXELS_A_ROW);
}

// The packed triangle of a slot.
fn triangle_at(slot: u32) -> vec4<u32> {
    return textureLoad(triangles, table_texel(slot), 0);
}

fn vertex(index: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(textureLoad(vertices, table_texel(2u * index), 0).xyz);
}
