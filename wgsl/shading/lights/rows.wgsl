// The table of lights.

#import shared/table.wgsl

var lights: texture_2d<u32>;

fn light_row(k: u32) -> vec4<f32> {
    return bitcast<vec4<f32>>(textureLoad(lights, table_texel(k), 0));
}
