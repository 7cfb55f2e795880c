// 8-bit sRGB of the tones of linear light, four bytes a word, with alpha 255.

#import shading/numbers.wgsl

const CURVE_REINHARD: u32 = 1u;
const CURVE_ACES: u32 = 2u;

// Light beyond this is white under every curve, and its square is finite.
const WHITE: f32 = 1.0e15;

// What is shown of linear light: src/image/tone.rs.
fn shown(linear: f32) -> f32 {
    let x = clamp(linear * shading.gain, 0.0, WHITE);
    let reinhard = x / (1.0 + x);
    let aces = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
    return select(select(x, reinhard, shading.curve == CURVE_REINHARD), aces, shading.curve == CURVE_ACES);
}

// The sRGB curve of IEC 61966-2-1.
fn srgb(linear: f32) -> u32 {
    let c = clamp(linear, 0.0, 1.0);
    let encoded = select(1.055 * pow(c, 1.0 / 2.4) - 0.055, 12.92 * c, c <= 0.0031308);
    return u32(encoded * 255.0 + 0.5);
}

fn packed_srgb(light: vec3<f32>) -> u32 {
    return srgb(shown(light.x)) | (srgb(shown(light.y)) << 8u) | (srgb(shown(light.z)) << 16u) | 0xff000000u;
}
