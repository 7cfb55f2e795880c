// Normals of the file at the moment of this thread's pixel; the table has those of all time steps.

#import shared/params.wgsl
#import shared/table.wgsl
#import vertices/timed/vertex.wgsl

var normals: texture_2d<u32>;

fn normal_at_step(index: u32, step: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(textureLoad(normals, table_texel(index * params.steps + step), 0).xyz);
}

fn stored_normal(index: u32) -> vec3<f32> {
    let from_step = normal_at_step(index, moment_step);
    return from_step + moment_share * (normal_at_step(index, next_step()) - from_step);
}
