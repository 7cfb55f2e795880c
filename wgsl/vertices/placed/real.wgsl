// Vertices at the place that this thread looks at.

#import arithmetic
#import shared/table.wgsl
#import vertices/placed/vertex.wgsl

var vertices: texture_2d<u32>;

// A sum over a row of the matrix, whose last number is not multiplied.
fn along_row(row: u32, v: real3) -> real {
    let hi = bitcast<vec4<f32>>(instance_row(row));
    let lo = bitcast<vec4<f32>>(instance_row(row + 3u));
    let m = real3(hi.xyz) + real3(lo.xyz);
    return m.x * v.x + m.y * v.y + m.z * v.z + (real(hi.w) + real(lo.w));
}

// A vertex relative to the anchor.
fn vertex_real(index: u32) -> real3 {
    let first = textureLoad(vertices, table_texel(2u * index), 0);
    let more = textureLoad(vertices, table_texel(2u * index + 1u), 0).xy;
    let v = real3(bitcast<vec3<f32>>(first.xyz)) + real3(bitcast<vec3<f32>>(vec3<u32>(first.w, more)));
    return real3(along_row(5u, v), along_row(6u, v), along_row(7u, v));
}

// Rounded to f32.
fn vertex(index: u32) -> vec3<f32> {
    return vec3<f32>(vertex_real(index));
}
