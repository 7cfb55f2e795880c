// How a straight ray arrives at a surface.

#import arithmetic
#import rays/pixel

// A line p + s d along which a ray meets a surface, and the length of the ray before p.
struct Arrival {
    p: real3,
    d: real3,
    length: f32,
}

fn arrival_at(surface: u32, layer: u32, x: u32, y: u32, t: f32) -> Arrival {
    let b = ray_bundle(layer, x, y, 0.0);
    return Arrival(b.p / b.h, b.d / b.h, 0.0);
}
