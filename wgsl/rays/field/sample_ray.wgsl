// Rays of the samples of a ray field in f32, and how their points move from pixel to pixel.

#import rays/field/bundle.wgsl
#import rays/field/sample.wgsl
#import rays/field/table.wgsl
#import rays/ray.wgsl

fn sample_ray(layer: u32, x: u32, y: u32, sample: u32) -> Ray {
    let own = field_at(x, y);
    let at = field_sample(x, y, sample);
    return Ray(field_origin(own) + sample_delta_p(at), field_direction(own) + sample_delta_d(at));
}

fn sample_differential(layer: u32, x: u32, y: u32, sample: u32, t: f32) -> RayDifferential {
    return field_differential(x, y, t);
}
