// Normals of the file at the place that this thread looks at.

#import shared/table.wgsl
#import vertices/placed/vertex.wgsl

var normals: texture_2d<u32>;

// Normals go by the inverse transpose: a sum of rows of the inverse.
fn stored_normal(index: u32) -> vec3<f32> {
    let n = bitcast<vec3<f32>>(textureLoad(normals, table_texel(index), 0).xyz);
    let x = bitcast<vec3<f32>>(instance_row(1u).xyz);
    let y = bitcast<vec3<f32>>(instance_row(2u).xyz);
    let z = bitcast<vec3<f32>>(instance_row(3u).xyz);
    let sum = n.x * x + n.y * y + n.z * z;
    let size = max(abs(sum.x), max(abs(sum.y), abs(sum.z)));
    return select(n, normalize(sum / size), size > 0.0);
}
