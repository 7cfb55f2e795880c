// Curved rays pixel by pixel: at a hit a curve is its tangent.

#import arithmetic
#import nodes/cells.wgsl
#import nodes/tables.wgsl
#import rays/affine_bundle.wgsl
#import rays/curves/curve.wgsl
#import rays/ray.wgsl
#import shared/params.wgsl

fn pixel_curve(layer: u32, x: u32, y: u32) -> Curve {
    return curve_stored(curve_place(layer, x, y));
}

fn has_ray(layer: u32, x: u32, y: u32) -> bool {
    return pixel_cell(layer, x, y) != NONE;
}

// The point at t and the tangent there; where the derivative is 0, the direction to the end.
fn ray_bundle(layer: u32, x: u32, y: u32, t: f32) -> Bundle {
    let c = pixel_curve(layer, x, y);
    let z = real3(0.0);
    var d = curve_tangent(c, real(t));
    if size3(d) == 0.0 {
        d = curve_point(c, real(1.0)) - c.c0;
    }
    return Bundle(curve_point(c, real(t)), z, z, d, z, z, real(1.0), real(0.0), real(0.0));
}

fn pixel_ray(layer: u32, x: u32, y: u32, t: f32) -> Ray {
    let b = ray_bundle(layer, x, y, t);
    return Ray(vec3<f32>(b.p), vec3<f32>(b.d));
}

fn ray_differential(layer: u32, x: u32, y: u32, t: f32) -> RayDifferential {
    let own = vec3<f32>(curve_point(pixel_curve(layer, x, y), real(t)));
    let right = curve_step(own, layer, x + 1u, y, t);
    let left = -curve_step(own, layer, x - 1u, y, t);
    let below = curve_step(own, layer, x, y + 1u, t);
    let above = -curve_step(own, layer, x, y - 1u, t);
    return RayDifferential(both_sides(right, left), both_sides(below, above));
}

// Vector from a point to that at t of another pixel's curve; 0 if the pixel has none.
fn curve_step(own: vec3<f32>, layer: u32, x: u32, y: u32, t: f32) -> vec3<f32> {
    if x >= params.width || y >= params.height || !has_ray(layer, x, y) {
        return vec3<f32>(0.0);
    }
    return vec3<f32>(curve_point(pixel_curve(layer, x, y), real(t))) - own;
}

// Point at t of a pixel's curve, where the tangent starts.
fn point_at(ray: Ray, t: f32) -> vec3<f32> {
    return ray.p;
}

// The index of the piece that owns the pixel, through all layers.
fn piece_number(layer: u32, x: u32, y: u32) -> u32 {
    return cells[pixel_cell(layer, x, y)].piece;
}

// Number of equal parts of t; the length of each is integrated by the five-point Gauss-Legendre rule: of degree 9, so
// that for a curve that bends by less than a right angle per part its error is under f32's rounding.
const LENGTH_PARTS: u32 = 8u;

// The length of the curve from 0 to t.
fn curve_length(c: Curve, t: f32) -> f32 {
    let leg0 = vec3<f32>(c.c1 - c.c0);
    let leg1 = vec3<f32>(c.c2 - c.c1);
    let leg2 = vec3<f32>(c.c3 - c.c2);
    let half = 0.5 * t / f32(LENGTH_PARTS);
    var sum = 0.0;
    for (var k = 0u; k < LENGTH_PARTS; k++) {
        let middle = (2.0 * f32(k) + 1.0) * half;
        sum += 0.5688889 * speed(leg0, leg1, leg2, middle);
        sum += 0.47862867 * (speed(leg0, leg1, leg2, middle - 0.5384693 * half) + speed(leg0, leg1, leg2, middle + 0.5384693 * half));
        sum += 0.23692689 * (speed(leg0, leg1, leg2, middle - 0.9061798 * half) + speed(leg0, leg1, leg2, middle + 0.9061798 * half));
    }
    return half * sum;
}

// |X'(t)| from the legs of the control net.
fn speed(leg0: vec3<f32>, leg1: vec3<f32>, leg2: vec3<f32>, t: f32) -> f32 {
    if DEGREE == 1u {
        return length(leg0);
    }
    if DEGREE == 2u {
        return 2.0 * length(mix(leg0, leg1, t));
    }
    return 3.0 * length(mix(mix(leg0, leg1, t), mix(leg1, leg2, t), t));
}

// Arc length from the start of its curve to a hit, in its layer.
fn reached(ray: Ray, layer: u32, x: u32, y: u32, t: f32) -> f32 {
    return curve_length(pixel_curve(layer, x, y), t);
}

// The length of a pixel's curve in a layer; where it has none, the table holds one point.
fn segment_length(layer: u32, x: u32, y: u32) -> f32 {
    return curve_length(pixel_curve(layer, x, y), 1.0);
}
