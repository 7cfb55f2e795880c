// Where surfaces with alpha masks and blended ones are there. A blended triangle is there for a sample if its opacity reaches the sample's
// threshold; rays through pixel centers have the threshold 1/2. src/geometry/opacity.rs has the same thresholds.

#import shading/materials/material.wgsl
#import shared/params.wgsl

// The image's pixel that rays belong to.
var<private> mask_pixel: vec2<u32>;

// Says which pixel of the band the rays that follow belong to.
fn take_place(pixel: vec2<u32>) {
    mask_pixel = pixel + vec2<u32>(0u, params.band_row);
}

// Whether a triangle is there, where its image has this opacity.
fn is_opaque(material: Material, alpha: f32, id: u32) -> bool {
    if material.is_blended == 1u {
        return reaches_threshold(material.opacity * alpha, id);
    }
    return alpha >= material.cutoff;
}

// Whether an opacity reaches the threshold of a triangle: the middle of the part of [0, 1] that this sample of the pixel has.
fn reaches_threshold(opacity: f32, id: u32) -> bool {
    if params.sample == 0u {
        return opacity >= 0.5;
    }
    let count = params.sample & 0xffffu;
    let part = permuted(params.sample >> 16u, count, mixed(mixed(mixed(mask_pixel.x) + mask_pixel.y) + id));
    return opacity * f32(count) >= f32(part) + 0.5;
}

// A number without a pattern (the 32-bit finalizer of MurmurHash3).
fn mixed(number: u32) -> u32 {
    var h = number + 0x9e3779b9u;
    h = (h ^ (h >> 16u)) * 0x85ebca6bu;
    h = (h ^ (h >> 16u)) * 0xc2b2ae35u;
    return h ^ (h >> 16u);
}

// The place of an index in a permutation of so many; each seed has another one (Kensler 2013).
fn permuted(index: u32, count: u32, seed: u32) -> u32 {
    let mask = 0xffffffffu >> countLeadingZeros((count - 1u) | 1u);
    var k = index;
    loop {
        k = (k ^ seed) * 0xe170893du;
        k ^= seed >> 16u;
        k ^= (k & mask) >> 4u;
        k ^= seed >> 8u;
        k *= 0x0929eb3fu;
        k ^= seed >> 23u;
        k ^= (k & mask) >> 1u;
        k *= 1u | (seed >> 27u);
        k *= 0x6935fa69u;
        k ^= (k & mask) >> 11u;
        k *= 0x74dcb303u;
        k ^= (k & mask) >> 2u;
        k *= 0x9e501cc3u;
        k ^= (k & mask) >> 2u;
        k *= 0xc860a3dfu;
        k &= mask;
        k ^= k >> 5u;
        if k < count {
            break;
        }
    }
    return (k + seed % count) % count;
}
