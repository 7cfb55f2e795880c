// Colours of surfaces with images on them, or with colours at their corners.

#import arithmetic
#import primitives/flat
#import rays/ray.wgsl
#import shading/colors
#import shading/materials/rows.wgsl
#import shading/numbers.wgsl
#import shading/surface.wgsl
#import shading/textures
#import shading/textures/filter.wgsl
#import shading/textures/layout.wgsl
#import shared/params.wgsl
#import vertices/normal
#import vertices/triangle.wgsl
#import vertices/vertex
#import vertices/weights.wgsl

const TEXTURED: bool = true;

fn surface_albedo(slot: u32, triangle: vec4<u32>, ray: Ray, differential: RayDifferential) -> vec3<f32> {
    let material = material_at(triangle_surface(slot).w);
    var albedo = material.diffuse;
    if COLORED {
        let colors = corner_colors(slot);
        var w = vec3<f32>(1.0, 0.0, 0.0);
        if has_corners(triangle) {
            w = in_file_order(vec3<f32>(hit_weights(triangle, ray)), triangle);
        }
        albedo *= w.x * colors[0] + w.y * colors[1] + w.z * colors[2];
    }
    if material.texture == NONE || !has_uv(slot) {
        return albedo;
    }
    return albedo * image_mean(material, footprint(slot, triangle, ray, differential, material.texture));
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

// Weights of stored corners in recheck arithmetic: an image may lie on a triangle a thousand times.
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
    bend: vec2<f32>,    // change of the surface's cosine to the ray, relative to the triangle's own cosine: 0 on flat surfaces
}

fn footprint(slot: u32, triangle: vec4<u32>, ray: Ray, differential: RayDifferential, wraps: u32) -> Footprint {
    let uv = corner_uv(slot, triangle);
    var f: Footprint;
    f.uv = image_place(uv, hit_weights(triangle, ray), wraps);

    let w = weights_at(triangle, ray.p, ray.d, differential);
    let t1 = uv[1] - uv[0];
    let t2 = uv[2] - uv[0];
    f.right = shading.filter_width * (w.right.y * t1 + w.right.z * t2);
    f.down = shading.filter_width * (w.down.y * t1 + w.down.z * t2);

    let change = cosine_change(slot, triangle, normalize(ray.d));
    f.bend = shading.filter_width * vec2<f32>(dot(w.right.yz, change), dot(w.down.yz, change));
    return f;
}

// How the cosine between the corners' normals and a ray of unit direction changes from the first stored corner to the second and third,
// relative to the cosine of the triangle itself.
fn cosine_change(slot: u32, triangle: vec4<u32>, d: vec3<f32>) -> vec2<f32> {
    let surface = triangle_surface(slot);
    if !NORMALS || surface.x == NONE || surface.y == NONE || surface.z == NONE {
        return vec2<f32>(0.0);
    }
    let order = corner_order(triangle_order(triangle));
    var n: array<vec3<f32>, 3>;
    n[order.x] = stored_normal(surface.x);
    n[order.y] = stored_normal(surface.y);
    n[order.z] = stored_normal(surface.z);
    let flat = flat_normal(triangle, d);
    let is_away = dot(n[0] + n[1] + n[2], flat) < 0.0;
    return vec2<f32>(dot(n[1] - n[0], d), dot(n[2] - n[0], d)) / dot(select(flat, -flat, is_away), d);
}
