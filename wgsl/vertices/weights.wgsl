// Weights of a triangle's corners at a hit, and how they change from pixel to pixel.

#import rays/ray.wgsl
#import shading/surface.wgsl
#import vertices/vertex

// Weights of a triangle's corners where its plane is met, and how they change for one pixel to the right, and downwards.
struct Weights {
    at: vec3<f32>,
    right: vec3<f32>,
    down: vec3<f32>,
}

// For a ray's direction d, whose point p moves with its pixel, and along it so that it stays in the plane.
fn weights_at(triangle: vec4<u32>, p: vec3<f32>, d: vec3<f32>, differential: RayDifferential) -> Weights {
    let v0 = vertex(triangle.x);
    var e1 = vertex(triangle.y) - v0;
    var e2 = vertex(triangle.z) - v0;
    let size = max(largest(e1), largest(e2));
    e1 /= size;
    e2 /= size;
    let n = cross(e1, e2);
    let along = d / dot(n, d);
    let g1 = cross(e2, n) / dot(n, n);
    let g2 = cross(n, e1) / dot(n, n);
    let at = (p - v0) / size;
    let right = (differential.right - along * dot(n, differential.right)) / size;
    let down = (differential.down - along * dot(n, differential.down)) / size;
    return Weights(
        with_first(vec2<f32>(dot(at, g1), dot(at, g2)), 1.0),
        with_first(vec2<f32>(dot(right, g1), dot(right, g2)), 0.0),
        with_first(vec2<f32>(dot(down, g1), dot(down, g2)), 0.0),
    );
}

// The first corner's from the others', by what all come to.
fn with_first(others: vec2<f32>, sum: f32) -> vec3<f32> {
    return vec3<f32>(sum - others.x - others.y, others);
}
