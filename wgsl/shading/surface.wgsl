// Surface normals, and the light that arrives at a surface.

#import primitives/flat
#import rays/ray.wgsl
#import shading/lights/arriving
#import shading/lights/openness
#import shading/numbers.wgsl
#import shading/textures
#import shared/params.wgsl
#import vertices/normal
#import vertices/triangle.wgsl
#import vertices/vertex

// Whether the scene has vertex normals.
override NORMALS: bool = true;

// Weights of stored corners as the file orders them.
fn in_file_order(w: vec3<f32>, triangle: vec4<u32>) -> vec3<f32> {
    let order = corner_order(triangle_order(triangle));
    return clamp(vec3<f32>(w[order.x], w[order.y], w[order.z]), vec3<f32>(0.0), vec3<f32>(1.0));
}

fn largest(v: vec3<f32>) -> f32 {
    return max(abs(v.x), max(abs(v.y), abs(v.z)));
}

// The unit normal on the viewer's side: from the file, or else the triangle's.
fn surface_normal(slot: u32, triangle: vec4<u32>, ray: Ray) -> vec3<f32> {
    let surface = triangle_surface(slot);
    let n = flat_normal(triangle, ray.d);
    if NORMALS && surface.x != NONE && surface.y != NONE && surface.z != NONE {
        let far = vertex(triangle.x) - ray.p;
        let inverse = 1.0 / largest(far);
        let v0 = inverse * far;
        let v1 = inverse * (vertex(triangle.y) - ray.p);
        let v2 = inverse * (vertex(triangle.z) - ray.p);
        let g0 = cross(ray.d, v0);
        let w = vec3<f32>(dot(v2 - v1, cross(ray.d, v1)), dot(v0 - v2, g0), dot(v1 - v0, g0));
        let weights = in_file_order(w / (w.x + w.y + w.z), triangle);
        let smooth_normal = weights.x * stored_normal(surface.x) + weights.y * stored_normal(surface.y)
            + weights.z * stored_normal(surface.z);
        if dot(smooth_normal, smooth_normal) > 0.0 {
            let smooth_unit = normalize(smooth_normal);
            return smooth_unit * select(1.0, -1.0, dot(smooth_unit, n) < 0.0);
        }
    }
    return n;
}

// A hit to be lit.
struct Lit {
    slot: u32,
    p: vec3<f32>,           // relative to the anchor
    reach: f32,             // the largest number that its place comes from
    n: vec3<f32>,           // unit, on the viewer's side
    view: vec3<f32>,        // unit, away from the viewer
}

// The hit at t of a ray.
fn reach_of(ray: Ray, t: f32) -> f32 {
    return max(largest(ray.p), largest(t * ray.d));
}

// Light at a hit: the unit direction to the light, and its irradiance over pi.
struct Arriving {
    l: vec3<f32>,
    strength: vec3<f32>,
}

// A uniform number, with a number of the thread in it that is never NONE. Lavapipe compiles a kernel anew, every frame, for the values of
// uniform numbers that alone decide a branch. (It crashes where the two are conditions joined by `&`.)
fn by_thread(value: u32, number: u32) -> u32 {
    return select(value, 0u, number == NONE);
}

// Lambert from every light, or one headlight along the ray, and a small ambient term.
fn received(lit: Lit) -> vec3<f32> {
    let open = openness(lit);
    let light_count = by_thread(shading.light_count, lit.slot);
    var sum = vec3<f32>(shading.ambient * open);
    if light_count == 0u {
        sum += (1.0 - shading.ambient) * open * max(0.0, -dot(lit.n, lit.view));
    }
    for (var k = 0u; k < light_count; k++) {
        let light = arriving(k, lit);
        sum += (1.0 - shading.ambient) * max(0.0, dot(lit.n, light.l)) * light.strength;
    }
    return sum;
}
