//! Colours of frames, and how pictures differ.

#![allow(dead_code)]

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::plan::samples::sample_offsets;
use anamorph::internals::image::frame::{Channel, Frame};
use anamorph::internals::image::srgb8;
use anamorph::internals::reference::image::image;
use anamorph::internals::scene::Scene;
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool};

pub const COLOUR: [Channel; 3] = [Channel::R, Channel::G, Channel::B];

/// Linear RGB, pixel by pixel.
pub type Colours = Vec<[f64; 3]>;

pub fn colours(frame: &Frame) -> Colours {
    let [r, g, b] = COLOUR.map(|c| frame.f32(c).unwrap());
    (0..r.len()).map(|k| [r[k].into(), g[k].into(), b[k].into()]).collect()
}

/// The mean of the reference's frames at so many places of each pixel.
pub fn box_filtered(scene: &Scene, camera: &Camera, samples: u32) -> Colours {
    let mut sum = vec![[0.0; 3]; (camera.width * camera.height) as usize];
    for place in sample_offsets(samples) {
        let frame = colours(&image(scene, &camera.with_sample_offset(place.x, place.y), &COLOUR));
        sum.iter_mut().zip(frame).for_each(|(s, c)| (0..3).for_each(|k| s[k] += c[k] / f64::from(samples)));
    }
    sum
}

pub fn psnr(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let square = a.iter().zip(b).flat_map(|(a, b)| (0..3).map(move |k| (a[k] - b[k]).powi(2))).sum::<f64>();
    -10.0 * (square / (3 * a.len()) as f64).log10()
}

/// The mean difference that a person sees between two pictures (Andersson et al. 2020), 0 to 1.
pub fn flip(truth: &[[f64; 3]], seen: &[[f64; 3]], (width, height): (u32, u32)) -> f64 {
    let image = |colours: &[[f64; 3]]| {
        let bytes: Vec<u8> = colours.iter().flatten().map(|v| srgb8(*v as f32)).collect();
        FlipImageRgb8::with_data(width, height, &bytes)
    };
    let errors = nv_flip::flip(image(truth), image(seen), DEFAULT_PIXELS_PER_DEGREE);
    f64::from(FlipPool::from_image(&errors).mean())
}
