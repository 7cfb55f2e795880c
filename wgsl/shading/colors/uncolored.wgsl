// Surfaces whose corners have no colours: three vec4s a slot.

const COLORED: bool = false;
const SURFACE_VEC4S: u32 = 3u;

fn corner_colors(slot: u32) -> array<vec3<f32>, 3> {
    return array<vec3<f32>, 3>(vec3<f32>(1.0), vec3<f32>(1.0), vec3<f32>(1.0));
}
