// Which hits gather lights in cameras with optics: none on a surface where the ray bounces.
// Provides: ends_here, light_kept
// Binds: optic, paths

fn ends_here(id: u32) -> bool {
    return id < optic.first_id;
}

fn light_kept(pixel: u32) -> vec3<f32> {
    return paths[pixel].light;
}
