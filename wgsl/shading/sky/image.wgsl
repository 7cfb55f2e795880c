// Environment light from an equirectangular image: longitude from left to right with -z in the middle, +y on top.

#import nodes/slabs.wgsl
#import rays/pixel
#import rays/ray.wgsl
#import shading/materials/rows.wgsl
#import shading/numbers.wgsl
#import shading/textures/filter.wgsl
#import shading/textures/mapped.wgsl
#import shared/params.wgsl

const SKY: bool = true;

// The environment light reflected towards v: the matte share by the irradiance, the rest by the mean over a lobe about the
// mirrored view, times the share of it that microfacets reflect (Karis 2014).
fn from_around(base: vec3<f32>, f0: vec3<f32>, alpha: f32, n: vec3<f32>, v: vec3<f32>) -> vec3<f32> {
    let nv = max(dot(n, v), 1e-4);
    let r = 2.0 * dot(n, v) * n - v;
    let helper_axis = select(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0), abs(r.x) > 0.7);
    let across = normalize(cross(r, helper_axis));
    let width = lobe_width(alpha);
    let lobe = sky_mean(r, width * across, width * cross(r, across));
    let rough = sqrt(alpha) * vec4<f32>(-1.0, -0.0275, -0.572, 0.022) + vec4<f32>(1.0, 0.0425, 1.04, -0.04);
    let falloff = min(rough.x * rough.x, exp2(-9.28 * nv)) * rough.x + rough.y;
    let share = vec2<f32>(-1.04, 1.04) * falloff + rough.zw;
    let grazing = min(50.0 * max(f0.x, max(f0.y, f0.z)), 1.0);
    return base * irradiance(n) + lobe * (f0 * share.x + grazing * share.y);
}

// The box, radians a side, that is as wide as what facets of this alpha make of one direction: normals deviate by alpha / sqrt(2),
// mirrored directions by twice that, and a box has a deviation of 1 / sqrt(12) of its width.
fn lobe_width(alpha: f32) -> f32 {
    return min(4.8989795 * alpha, 3.14159265);
}

// Irradiance over pi: spherical harmonics of order 2 (Ramamoorthi and Hanrahan 2001).
fn irradiance(n: vec3<f32>) -> vec3<f32> {
    let first = shading.irradiance[0].xyz + shading.irradiance[1].xyz * n.y + shading.irradiance[2].xyz * n.z + shading.irradiance[3].xyz * n.x;
    let second = shading.irradiance[4].xyz * (n.x * n.y) + shading.irradiance[5].xyz * (n.y * n.z)
        + shading.irradiance[6].xyz * (3.0 * n.z * n.z - 1.0) + shading.irradiance[7].xyz * (n.x * n.z)
        + shading.irradiance[8].xyz * (n.x * n.x - n.y * n.y);
    return max(first + second, vec3<f32>(0.0));
}

// Mean radiance about a unit direction, over the parallelogram of two vectors across it.
fn sky_mean(d: vec3<f32>, right: vec3<f32>, down: vec3<f32>) -> vec3<f32> {
    let level = max(d.x * d.x + d.z * d.z, 1e-6);
    // about a pole once around is all that there is
    let around = max(level, max(dot(right, right), dot(down, down)) / 39.478418);
    let longitude = vec3<f32>(-d.z, 0.0, d.x) * inverseSqrt(level * around) / 6.2831853;
    let latitude = vec3<f32>(0.0, -1.0, 0.0) / (sqrt(level) * 3.14159265);
    var f: Footprint;
    f.uv = vec2<f32>(
        0.5 + atan2(d.x, -d.z) / 6.2831853 + shading.sky_rotation,
        0.5 - asin(clamp(d.y, -1.0, 1.0)) / 3.14159265,
    );
    f.right = vec2<f32>(dot(right, longitude), dot(right, latitude));
    f.down = vec2<f32>(dot(down, longitude), dot(down, latitude));
    return shading.sky_strength * image_mean(material_at(shading.sky), f);
}

// Colour of a pixel that hits nothing: the sky in its ray's last direction.
fn beyond(x: u32, y: u32) -> vec3<f32> {
    var layer = 0u;
    if SLABBED {
        layer = params.tiles_y / (params.spans * params.slab_rows) - 1u;
        while layer > 0u && !has_ray(layer, x, y) {
            layer--;
        }
    }
    let d = end_direction(layer, x, y);
    if shading.sky_is_seen == 0u || all(d == vec3<f32>(0.0)) {
        return shading.background;
    }
    let right = both_sides(direction_step(d, layer, x + 1u, y), -direction_step(d, layer, x - 1u, y));
    let down = both_sides(direction_step(d, layer, x, y + 1u), -direction_step(d, layer, x, y - 1u));
    return sky_mean(d, shading.filter_width * right, shading.filter_width * down);
}

fn direction_step(own: vec3<f32>, layer: u32, x: u32, y: u32) -> vec3<f32> {
    let d = end_direction(layer, x, y);
    return select(d - own, vec3<f32>(0.0), all(d == vec3<f32>(0.0)));
}

// The unit direction of a pixel's ray at its end; 0: no ray.
fn end_direction(layer: u32, x: u32, y: u32) -> vec3<f32> {
    if x >= params.width || y >= params.height || !has_ray(layer, x, y) {
        return vec3<f32>(0.0);
    }
    return normalize(pixel_ray(layer, x, y, 1.0).d);
}
