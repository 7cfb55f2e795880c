// Rays of the samples of a ray field: differences from the pixel's own ray, six numbers P and D, sample by sample.
// Provides: sample_bundle, sample_differential, sample_ray
// Needs: Bundle, Cell, Ray, RayDifferential, SAMPLES, field_at, field_bundle, field_differential, field_direction, field_origin, real3,
//   tile_corner
// Binds: params, sample_ray_deltas

fn field_sample(x: u32, y: u32, sample: u32) -> u32 {
    return 6u * ((y * params.width + x) * SAMPLES + sample);
}

fn sample_delta_p(at: u32) -> vec3<f32> {
    return vec3<f32>(sample_ray_deltas[at], sample_ray_deltas[at + 1u], sample_ray_deltas[at + 2u]);
}

fn sample_delta_d(at: u32) -> vec3<f32> {
    return vec3<f32>(sample_ray_deltas[at + 3u], sample_ray_deltas[at + 4u], sample_ray_deltas[at + 5u]);
}

fn sample_bundle(whole: Bundle, cell: Cell, x: u32, y: u32, sample: u32) -> Bundle {
    let corner = tile_corner(cell.tile);
    let at = field_sample(corner.x + x, corner.y + y, sample);
    var b = field_bundle(corner.x + x, corner.y + y);
    b.p += real3(sample_delta_p(at));
    b.d += real3(sample_delta_d(at));
    return b;
}

fn sample_ray(layer: u32, x: u32, y: u32, sample: u32) -> Ray {
    let own = field_at(x, y);
    let at = field_sample(x, y, sample);
    return Ray(field_origin(own) + sample_delta_p(at), field_direction(own) + sample_delta_d(at));
}

fn sample_differential(layer: u32, x: u32, y: u32, sample: u32, t: f32) -> RayDifferential {
    return field_differential(x, y, t);
}
