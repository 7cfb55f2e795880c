// The table of lights.
// Provides: light_row
// Needs: table_texel
// Binds: lights

fn light_row(k: u32) -> vec4<f32> {
    return bitcast<vec4<f32>>(textureLoad(lights, table_texel(k), 0));
}
