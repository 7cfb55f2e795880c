//! write in f64: linear colour to 8-bit sRGB.

use anamorph::internals::image::tone::Tone;

/// The sRGB curve of IEC 61966-2-1 in steps of a byte, 0 to 255, not yet rounded; values outside [0, 1] are clamped.
pub fn srgb(linear: f64) -> f64 {
    let c = linear.clamp(0.0, 1.0);
    255.0 * if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}

/// A pixel's word: red lowest, alpha 255 on top.
pub fn write(colour: [f32; 3], tone: Tone) -> u32 {
    let byte = |c: f32| (srgb(tone.shown(f64::from(c))) + 0.5) as u32;
    byte(colour[0]) | byte(colour[1]) << 8 | byte(colour[2]) << 16 | 0xff00_0000
}
