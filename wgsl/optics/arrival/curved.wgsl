// How a curve arrives at a facet: along its tangent there (Brosz et al. 2007, section 6.1).

#import arithmetic
#import optics/facets/bounce.wgsl
#import rays/curves/curve.wgsl
#import rays/curves/pixel.wgsl

// A line p + s d along which a curve meets a facet, and the length of the curve before p.
struct Arrival {
    p: real3,
    d: real3,
    length: f32,
}

// `t` is rounded to f32. The tangent there meets the facet's plane where the curve does, but for the square of that rounding.
fn arrival_at(surface: u32, layer: u32, x: u32, y: u32, t: f32) -> Arrival {
    let c = pixel_curve(layer, x, y);
    let p = curve_point(c, real(t));
    let d = curve_tangent(c, real(t));
    let met = facet_place(surface, facet_weights(surface, p, d)) - p;
    let exact = real(t) + dot(met, d) / dot(d, d);
    return Arrival(curve_point(c, exact), curve_tangent(c, exact), curve_length(c, t));
}
