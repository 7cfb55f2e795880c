// Packed spheres: the vertex in the centre, the radius as two f32, and a last word that says so where a triangle's says its order.

#import vertices/triangle.wgsl

const SPHERE_ORDER: u32 = 7u;

fn is_sphere(triangle: vec4<u32>) -> bool {
    return triangle_order(triangle) == SPHERE_ORDER;
}
