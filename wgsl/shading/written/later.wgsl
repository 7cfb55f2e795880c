// The 8-bit sRGB of a pixel is not wanted, or the stage write writes it.

const WRITES: bool = false;

fn write_srgb(pixel: u32, light: vec3<f32>) {}
