// Surfaces whose corners have no colours: three vec4s a slot.
// Provides: COLORED, SURFACE_VEC4S, corner_colors

const COLORED: bool = false;
const SURFACE_VEC4S: u32 = 3u;

fn corner_colors(slot: u32) -> array<vec3<f32>, 3> {
    return array<vec3<f32>, 3>(vec3<f32>(1.0), vec3<f32>(1.0), vec3<f32>(1.0));
}
