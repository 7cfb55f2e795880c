// Surfaces without images.

#import rays/ray.wgsl
#import shading/materials/rows.wgsl
#import shared/params.wgsl
#import vertices/vertex

const TEXTURED: bool = false;

fn surface_albedo(slot: u32, triangle: vec4<u32>, ray: Ray, differential: RayDifferential) -> vec3<f32> {
    return material_at(triangle_surface(slot).w).diffuse;
}

fn surface_uv(slot: u32, triangle: vec4<u32>, ray: Ray) -> vec2<f32> {
    return vec2<f32>(0.0);
}

fn triangle_surface(slot: u32) -> vec4<u32> {
    return surface_row(params.surface_rows * own_slot(slot));
}
