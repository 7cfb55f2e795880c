// Rays of a ray field: a ray per pixel, six numbers P and D, in a table one column and one row larger than the band so
// that every pixel has a right and a lower neighbour. D = 0: no ray.

#import shared/params.wgsl

var<storage, read> rays_hi: array<f32>;

fn field_at(x: u32, y: u32) -> u32 {
    return 6u * (y * (params.width + 1u) + x);
}

fn field_origin(at: u32) -> vec3<f32> {
    return vec3<f32>(rays_hi[at], rays_hi[at + 1u], rays_hi[at + 2u]);
}

fn field_direction(at: u32) -> vec3<f32> {
    return vec3<f32>(rays_hi[at + 3u], rays_hi[at + 4u], rays_hi[at + 5u]);
}
