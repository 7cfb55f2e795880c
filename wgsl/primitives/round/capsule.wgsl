// Packed spheres and capsules: the vertex of an end, the radius as two f32, and a last word that says so where a triangle's says its order.
// The vertex of a capsule's other end is the next one.

#import arithmetic
#import primitives/round/kinds.wgsl
#import vertices/real
#import vertices/triangle.wgsl

const CAPSULE_ORDER: u32 = 6u;
const SPHERE_ORDER: u32 = 7u;

// All points within a radius of a segment. A sphere is a capsule of length 0.
struct Capsule {
    end: real3,
    radius: real,
    axis: real3,            // unit, towards the other end
    length: real,
}

// Whether a packed primitive is a sphere or capsule.
fn is_round(triangle: vec4<u32>) -> bool {
    return triangle_order(triangle) >= CAPSULE_ORDER;
}

fn is_capsule(triangle: vec4<u32>) -> bool {
    return CAPSULES && triangle_order(triangle) == CAPSULE_ORDER;
}

fn capsule_of(triangle: vec4<u32>) -> Capsule {
    let radius = bitcast<vec2<f32>>(triangle.yz);
    let end = vertex_real(triangle.x);
    var axis = real3(0.0);
    var length = real(0.0);
    if is_capsule(triangle) {
        axis = vertex_real(triangle.x + 1u) - end;
        length = sqrt(dot(axis, axis));
        axis /= max(length, LEAST_LENGTH);
    }
    return Capsule(end, real(radius.x) + real(radius.y), axis, length);
}

// Shorter axes are 0.
const LEAST_LENGTH: real = 1.0e-30;

// The point of the segment that is nearest to one, both from its end.
fn nearest_of_segment(s: Capsule, place: real3) -> real3 {
    if !CAPSULES {
        return real3(0.0);
    }
    return min(max(dot(place, s.axis), 0.0), s.length) * s.axis;
}
