// Rays of a ray field, pixel by pixel: it has one layer and one piece.

#import rays/affine_bundle.wgsl
#import rays/field/bundle.wgsl
#import rays/field/table.wgsl
#import rays/ray.wgsl

fn ray_bundle(layer: u32, x: u32, y: u32, t: f32) -> Bundle {
    return field_bundle(x, y);
}

fn has_ray(layer: u32, x: u32, y: u32) -> bool {
    return any(field_direction(field_at(x, y)) != vec3<f32>(0.0));
}

fn pixel_ray(layer: u32, x: u32, y: u32, t: f32) -> Ray {
    let at = field_at(x, y);
    return Ray(field_origin(at), field_direction(at));
}

fn ray_differential(layer: u32, x: u32, y: u32, t: f32) -> RayDifferential {
    return field_differential(x, y, t);
}

// Point at t of a pixel's ray.
fn point_at(ray: Ray, t: f32) -> vec3<f32> {
    return ray.p + t * ray.d;
}

fn piece_number(layer: u32, x: u32, y: u32) -> u32 {
    return 0u;
}

// Distance along its ray to a hit.
fn reached(ray: Ray, layer: u32, x: u32, y: u32, t: f32) -> f32 {
    return t * length(ray.d);
}

fn segment_length(layer: u32, x: u32, y: u32) -> f32 {
    return 0.0;
}
