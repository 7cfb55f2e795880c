// Surfaces without images.
// Provides: TEXTURED, surface_albedo, surface_uv, triangle_surface
// Needs: Ray, RayDifferential, material_at, own_slot, surface_row
// Binds: params

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
