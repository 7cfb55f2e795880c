// Which hits gather lights in cameras with optics: none on a surface where the ray bounces.

#import optics/layout.wgsl

fn ends_here(id: u32) -> bool {
    return id < optic.first_id;
}

fn light_kept(pixel: u32) -> vec3<f32> {
    return paths[pixel].light;
}
