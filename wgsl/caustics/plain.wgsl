// Which hits gather lights in cameras without optics: all.

fn ends_here(id: u32) -> bool {
    return true;
}

fn light_kept(pixel: u32) -> vec3<f32> {
    return vec3<f32>(1.0);
}
