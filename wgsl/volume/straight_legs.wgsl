// A straight ray is one leg in each layer.
// Provides: Leg, leg_at, legs_of
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

struct Legs {
    leg: Leg,
    count: u32,
}

fn legs_of(layer: u32, x: u32, y: u32, t_end: f32) -> Legs {
    let b = ray_bundle(layer, x, y, 0.0);
    let d = b.d / b.h;
    return Legs(Leg(b.p / b.h, d, params.t_min.x, t_end, length(vec3<f32>(d))), 1u);
}

fn leg_at(legs: Legs, k: u32) -> Leg {
    return legs.leg;
}
