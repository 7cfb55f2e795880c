// A straight ray is one leg in each layer.
// Provides: Leg, leg_at, leg_count
// Needs: ray_bundle, real3
// Binds: params

// A straight part of a pixel's path: p + t d for t in [first, last].
struct Leg {
    p: real3,
    d: real3,
    first: f32,
    last: f32,
    speed: f32,             // length of a step of 1 in t, world units
}

fn leg_count(layer: u32, x: u32, y: u32, t_end: f32) -> u32 {
    return 1u;
}

fn leg_at(layer: u32, x: u32, y: u32, t_end: f32, k: u32, count: u32) -> Leg {
    let b = ray_bundle(layer, x, y, 0.0);
    let d = b.d / b.h;
    return Leg(b.p / b.h, d, params.t_min.x, t_end, length(vec3<f32>(d)));
}
