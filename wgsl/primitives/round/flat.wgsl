// The surfaces of triangles, spheres and capsules. The normal of a round surface changes from place to place: it is that of this thread's hit.

#import primitives/round/capsule.wgsl
#import rays/outward
#import rays/pixel
#import shading/surface.wgsl
#import vertices/vertex

// Outwards, unit.
var<private> surface_direction: vec3<f32>;

// A hit of this thread at t.
fn take_surface(triangle: vec4<u32>, layer: u32, x: u32, y: u32, t: f32) {
    if is_round(triangle) {
        surface_direction = normalize(vec3<f32>(outward(ray_bundle(layer, x, y, t), capsule_of(triangle), t)));
    }
}

fn has_corners(triangle: vec4<u32>) -> bool {
    return !is_round(triangle);
}

// The unit normal, on the side opposite a direction.
fn flat_normal(triangle: vec4<u32>, direction: vec3<f32>) -> vec3<f32> {
    var flat = surface_direction;
    if !is_round(triangle) {
        let v0 = vertex(triangle.x);
        let e1 = vertex(triangle.y) - v0;
        let e2 = vertex(triangle.z) - v0;
        let inverse = 1.0 / max(largest(e1), largest(e2));
        flat = normalize(cross(inverse * e1, inverse * e2));
    }
    return select(flat, -flat, dot(flat, direction) > 0.0);
}
