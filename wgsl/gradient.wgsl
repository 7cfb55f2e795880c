// gradient: one thread per pixel.
// Reads the pixel's ray, how it changes along a direction, and the corners of its triangle; writes to `changes`, for each direction, the
// changes of t, Z, the position (3) and the weights (3), 0 where nothing is hit. The hit stays in the triangle's plane, so that all
// follow from the change of t.

#choose arithmetic f64
#import arithmetic
#import gradients/layout.wgsl
#import gradients/rays.wgsl
#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read> slots: array<vec2<u32>>;
var<storage, read_write> changes: array<f32>;

const HIT_NUMBERS: u32 = 8u;

@compute @workgroup_size(64)
fn gradient(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel
    let index = item_index(group, groups, lane);
    if index >= gradient_params.pixels {
        return;
    }
    let pixel = gradient_params.first + index;
    let slot = slots[pixel].x;
    let directions = gradient_params.directions;
    let out = HIT_NUMBERS * directions * index;
    if slot == NONE {
        for (var n = 0u; n < HIT_NUMBERS * directions; n++) {
            changes[out + n] = 0.0;
        }
        return;
    }

    // its hit
    let p = ray_vector(pixel, 0u);
    let d = ray_vector(pixel, 1u);
    let v0 = corner(slot, 0u);
    let v1 = corner(slot, 1u);
    let v2 = corner(slot, 2u);
    let normal = cross(v1 - v0, v2 - v0);
    let across = dot(normal, d);
    let t = dot(normal, v0 - p) / across;
    let weight = real3(side(p, d, v1, v2), side(p, d, v2, v0), side(p, d, v0, v1)) / real3(across, across, across);
    let d_length = sqrt(dot(d, d));
    let square = dot(normal, normal);

    // its changes: the ray's point at t moves by `moved`, that of the triangle by `carried`; t then takes the first into the plane
    for (var k = 0u; k < directions; k++) {
        let dd = ray_rate(pixel, 1u);
        let moved = ray_rate(pixel, 0u) + dd * t;
        let carried = corner_rate(k, 0u) * weight.x + corner_rate(k, 1u) * weight.y + corner_rate(k, 2u) * weight.z;
        let dt = dot(normal, carried - moved) / across;
        let change = moved + d * dt;
        let within = cross(change - carried, normal);
        let at = out + HIT_NUMBERS * k;
        changes[at] = f32(dt);
        changes[at + 1u] = f32(d_length * dt + t * dot(d, dd) / d_length);
        changes[at + 2u] = f32(change.x);
        changes[at + 3u] = f32(change.y);
        changes[at + 4u] = f32(change.z);
        changes[at + 5u] = f32(dot(within, v2 - v1) / square);
        changes[at + 6u] = f32(dot(within, v0 - v2) / square);
        changes[at + 7u] = f32(dot(within, v1 - v0) / square);
    }
}
