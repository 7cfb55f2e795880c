// Colours of surfaces with images on them.

const TEXTURED: bool = true;

fn surface_albedo(slot: u32, triangle: vec4<u32>, ray: Ray, spread: Spread) -> vec3<f32> {
    let material = materials[surface_row(slot).w];
    if material.texture == NONE || !has_uv(slot) {
        return material.diffuse;
    }
    return material.diffuse * image_mean(material, footprint(slot, triangle, ray, spread, material.texture));
}

// The texture coordinates of a hit, 0 without any.
fn surface_uv(slot: u32, triangle: vec4<u32>, ray: Ray) -> vec2<f32> {
    if !has_uv(slot) {
        return vec2<f32>(0.0);
    }
    let uv = corner_uv(slot, triangle);
    let w = hit_weights(triangle, ray);
    let u = w.x * real(uv[0].x) + w.y * real(uv[1].x) + w.z * real(uv[2].x);
    let v = w.x * real(uv[0].y) + w.y * real(uv[1].y) + w.z * real(uv[2].y);
    return vec2<f32>(f32(u), f32(1.0 - v));
}

// Weights of a row's corners in recheck arithmetic: an image may lie on a triangle a thousand times.
fn hit_weights(triangle: vec4<u32>, ray: Ray) -> real3 {
    let p = real3(ray.p);
    let d = real3(ray.d);
    let v0 = real3(vertex(triangle.x));
    let v1 = real3(vertex(triangle.y));
    let v2 = real3(vertex(triangle.z));
    let g0 = cross(d, v0 - p);
    return on_triangle(real3(dot(v2 - v1, cross(d, v1 - p)), dot(v0 - v2, g0), dot(v1 - v0, g0)));
}

// What a pixel covers of an image, to first order: repeats of it to the right and downwards.
struct Footprint {
    uv: vec2<f32>,
    right: vec2<f32>,   // for one pixel to the right, one downwards
    down: vec2<f32>,
}

fn footprint(slot: u32, triangle: vec4<u32>, ray: Ray, spread: Spread, wraps: u32) -> Footprint {
    let uv = corner_uv(slot, triangle);
    var f: Footprint;
    f.uv = image_place(uv, hit_weights(triangle, ray), wraps);

    // the point moves with the ray, and along it so that it stays in the plane
    let v0 = vertex(triangle.x);
    var e1 = vertex(triangle.y) - v0;
    var e2 = vertex(triangle.z) - v0;
    let most = max(abs(e1), abs(e2));
    let size = max(most.x, max(most.y, most.z));
    e1 /= size;
    e2 /= size;
    let n = cross(e1, e2);
    let along = ray.d / dot(n, ray.d);
    let right = (spread.right - along * dot(n, spread.right)) / size;
    let down = (spread.down - along * dot(n, spread.down)) / size;
    let g1 = cross(e2, n) / dot(n, n);
    let g2 = cross(n, e1) / dot(n, n);
    let t1 = uv[1] - uv[0];
    let t2 = uv[2] - uv[0];
    f.right = shading.spread * (dot(right, g1) * t1 + dot(right, g2) * t2);
    f.down = shading.spread * (dot(down, g1) * t1 + dot(down, g2) * t2);
    return f;
}
