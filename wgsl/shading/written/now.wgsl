// Nothing changes the light of a pixel after shade: its 8-bit sRGB is written there.

#import shading/tone.wgsl

var<storage, read_write> srgb8: array<u32>;

const WRITES: bool = true;

fn write_srgb(pixel: u32, light: vec3<f32>) {
    srgb8[pixel] = packed_srgb(light);
}
