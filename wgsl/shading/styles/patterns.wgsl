// Solid (3-D) patterns: src/geometry/pattern.rs has them at a point, here are their means over what a pixel covers.

#import primitives/flat
#import rays/ray.wgsl
#import shading/materials/rows.wgsl
#import shading/numbers.wgsl
#import shading/styles/shaded_hit.wgsl
#import shading/textures
#import vertices/vertex

const STYLED: bool = true;

const PATTERN_CHECKER: u32 = 1u;
const PATTERN_STONE: u32 = 2u;
const PATTERN_WOOD: u32 = 3u;

// How a hit moves on the plane of its triangle for one pixel to the right, and downwards.
fn tangents(hit: ShadedHit) -> RayDifferential {
    let n = flat_normal(triangle_at(hit.slot), hit.d);
    let along = hit.d / dot(n, hit.d);
    return RayDifferential(hit.differential.right - along * dot(n, hit.differential.right), hit.differential.down - along * dot(n, hit.differential.down));
}

// What the material's colour is multiplied by.
fn pattern_at(hit: ShadedHit) -> vec3<f32> {
    let material = material_at(triangle_surface(hit.slot).w);
    if material.pattern == 0u {
        return vec3<f32>(1.0);
    }
    let on = tangents(hit);
    let p = (hit.p + shading.anchor) / material.pattern_size;
    let right = on.right * (hit.share / material.pattern_size);
    let down = on.down * (hit.share / material.pattern_size);
    var share = 0.0;
    if material.pattern == PATTERN_CHECKER {
        // a box as wide along each axis as the parallelogram has deviation there
        let width = sqrt(right * right + down * down);
        let q = p + CHECKER_OFFSET;
        share = 0.5 + 0.5 * squares(q.x, width.x) * squares(q.y, width.y) * squares(q.z, width.z);
    } else if material.pattern == PATTERN_STONE {
        share = stone_mean(p, right, down);
    } else {
        let dx = rings(p + 0.5 * right) - rings(p - 0.5 * right);
        let dy = rings(p + 0.5 * down) - rings(p - 0.5 * down);
        share = 0.5 + 0.5 * cos(6.2831853 * fract(rings(p))) * left_of_wave(dx) * left_of_wave(dy);
    }
    return mix(material.pattern_dark, material.pattern_light, share);
}

// So that faces at round places are not between cells.
const CHECKER_OFFSET: f32 = 0.3717;

const STONE_OCTAVES: u32 = 5u;

// Of noises that hardly ever add up to more than one half over this.
const STONE_CONTRAST: f32 = 0.5;

// The mean of stone over a parallelogram: places along its longer axis, each as wide as the shorter one.
fn stone_mean(p: vec3<f32>, right: vec3<f32>, down: vec3<f32>) -> f32 {
    let half = 0.5 * (dot(right, right) - dot(down, down));
    let both = dot(right, down);
    let root = sqrt(half * half + both * both);
    let square = 0.5 * (dot(right, right) + dot(down, down));
    let major = sqrt(square + root);
    let minor = sqrt(max(square - root, 0.0));
    let vector = select(vec2<f32>(half + root, both), vec2<f32>(both, root - half), half < 0.0);
    let axis = select(vec2<f32>(0.0), normalize(vector), root > 0.0);
    let taps = clamp(ceil(major / max(minor, 1e-20)), 1.0, STONE_TAPS);
    let step = (axis.x * right + axis.y * down) / taps;
    let width = max(minor, major / taps);
    var mean = 0.0;
    for (var n = 0.0; n < taps; n += 1.0) {
        let q = p + (n - 0.5 * (taps - 1.0)) * step;
        var sum = 0.0;
        for (var k = 0u; k < STONE_OCTAVES; k++) {
            let times = f32(1u << k);
            sum += noise(times * q + 17.0 * f32(k)) / times * left_of_noise(times * width);
        }
        mean += clamp(0.5 + STONE_CONTRAST * sum, 0.0, 1.0) / taps;
    }
    return mean;
}

const STONE_TAPS: f32 = 16.0;

// The mean over a width of what is 1 in every other cell, and -1 in those between.
fn squares(x: f32, width: f32) -> f32 {
    let at = 2.0 * fract(0.5 * x);
    let w = max(width, 1e-4);
    return (tent(at + 0.5 * w) - tent(at - 0.5 * w)) / w;
}

// Its integral.
fn tent(x: f32) -> f32 {
    return 1.0 - abs(2.0 * fract(0.5 * x) - 1.0);
}

// What a mean over a width leaves of a wave of length 1.
fn left_of_wave(width: f32) -> f32 {
    let x = 3.14159265 * width;
    return select(select(sin(x) / x, 0.0, abs(width) > 1.0), 1.0, abs(width) < 1e-3);
}

// And of noise, about.
fn left_of_noise(width: f32) -> f32 {
    return exp2(-0.6 * width * width);
}

// How many rings of wood about the y axis a place is away from it.
fn rings(p: vec3<f32>) -> f32 {
    return length(p.xz) + 0.4 * noise(vec3<f32>(0.7, 0.15, 0.7) * p);
}

// Values at whole places, cubic between them, within [-1, 1].
fn noise(p: vec3<f32>) -> f32 {
    let whole = vec3<i32>(floor(p));
    let f = p - floor(p);
    let s = f * f * (3.0 - 2.0 * f);
    let a = mix(value(whole), value(whole + vec3<i32>(1, 0, 0)), s.x);
    let b = mix(value(whole + vec3<i32>(0, 1, 0)), value(whole + vec3<i32>(1, 1, 0)), s.x);
    let c = mix(value(whole + vec3<i32>(0, 0, 1)), value(whole + vec3<i32>(1, 0, 1)), s.x);
    let d = mix(value(whole + vec3<i32>(0, 1, 1)), value(whole + vec3<i32>(1, 1, 1)), s.x);
    return mix(mix(a, b, s.y), mix(c, d, s.y), s.z);
}

fn value(at: vec3<i32>) -> f32 {
    let v = vec3<u32>(at) * vec3<u32>(0x8da6b343u, 0xd8163841u, 0xcb1ab31fu);
    var h = v.x ^ v.y ^ v.z;
    h = (h ^ (h >> 16u)) * 0x7feb352du;
    h = (h ^ (h >> 15u)) * 0x846ca68bu;
    h ^= h >> 16u;
    return f32(h >> 8u) / 8388608.0 - 1.0;
}
