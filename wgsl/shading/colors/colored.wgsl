// Surfaces whose corners have colours: five vec4s a slot. Nine numbers, from the last of the third vec4 on, are the colours of the
// corners in file order, linear.

#import shading/materials/rows.wgsl
#import vertices/vertex

const COLORED: bool = true;
const SURFACE_VEC4S: u32 = 5u;

fn corner_colors(slot: u32) -> array<vec3<f32>, 3> {
    let first = bitcast<f32>(surface_row(SURFACE_VEC4S * own_slot(slot) + 2u).w);
    let next = bitcast<vec4<f32>>(surface_row(SURFACE_VEC4S * own_slot(slot) + 3u));
    let last = bitcast<vec4<f32>>(surface_row(SURFACE_VEC4S * own_slot(slot) + 4u));
    return array<vec3<f32>, 3>(vec3<f32>(first, next.xy), vec3<f32>(next.zw, last.x), last.yzw);
}
