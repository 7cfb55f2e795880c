// A straight ray is one leg in each layer.

#import arithmetic
#import rays/pixel
#import shared/params.wgsl
#import volume.wgsl

// A straight part of a pixel's path: start + t along for t in [first, last], grid coordinates.
struct Leg {
    start: real3,
    along: real3,
    first: f32,
    last: f32,
    speed: f32,             // length of a step of 1 in t, world units
    direction: vec3<f32>,   // unit vector, in the world
}

struct Legs {
    leg: Leg,
    count: u32,
}

fn legs_of(layer: u32, x: u32, y: u32, t_end: f32) -> Legs {
    let b = ray_bundle(layer, x, y, 0.0);
    let d = b.d / b.h;
    let speed = length(vec3<f32>(d));
    let leg = Leg(grid_place(b.p / b.h), grid_direction(d), params.t_min.x, t_end, speed, normalize(vec3<f32>(d)));
    return Legs(leg, 1u);
}

fn leg_at(legs: Legs, k: u32) -> Leg {
    return legs.leg;
}
