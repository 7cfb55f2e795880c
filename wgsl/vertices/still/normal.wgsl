// Normals of the file.

#import shared/table.wgsl

var normals: texture_2d<u32>;

fn stored_normal(index: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(textureLoad(normals, table_texel(index), 0).xyz);
}
