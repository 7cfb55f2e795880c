// Normals of the file.
// Provides: stored_normal
// Needs: table_texel
// Binds: normals

fn stored_normal(index: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(textureLoad(normals, table_texel(index), 0).xyz);
}
