// The surfaces of triangles.

#import shading/surface.wgsl
#import vertices/vertex

// A hit of this thread on a triangle, whose normal is the same everywhere.
fn take_surface(triangle: vec4<u32>, layer: u32, x: u32, y: u32, t: f32) {}

fn has_corners(triangle: vec4<u32>) -> bool {
    return true;
}

// The unit normal of a triangle of any size, on the side opposite a direction.
fn flat_normal(triangle: vec4<u32>, direction: vec3<f32>) -> vec3<f32> {
    let v0 = vertex(triangle.x);
    let e1 = vertex(triangle.y) - v0;
    let e2 = vertex(triangle.z) - v0;
    let inverse = 1.0 / max(largest(e1), largest(e2));
    let flat = normalize(cross(inverse * e1, inverse * e2));
    return select(flat, -flat, dot(flat, direction) > 0.0);
}
