//! What none of the papers has, beside the same frame without it.

use crate::bench::case::{Arm, Case, Samples, Source};
use anamorph::internals::tools::example::EXAMPLES;

/// Small: with shadows and ambient occlusion a frame takes long on a CPU.
const SIZE: [&str; 2] = ["image.width=240", "image.height=160"];

/// Name, example and changes.
#[rustfmt::skip] // a table
const CASES: [(&str, &str, &[&str]); 10] = [
    ("things that move: all rows at once", "rolling-shutter", &["camera.line_time=0"]),
    ("things that move: row by row", "rolling-shutter", &[]),
    ("things and camera move: row by row", "rolling-shutter",
        &["camera.eye=[{ frame = 0, value = [0, 3.2, 17] }, { frame = 1, value = [2, 3.2, 17] }]"]),
    ("regions: by one camera", "composite", &["camera={kind='pinhole',eye=[0,9,34],target=[0,3,0],vfov=45}"]),
    ("regions: of three cameras", "composite", &[]),
    ("mirror: seen along straight rays", "hidden-mirror", &["camera.eye={kind='pinhole',eye=[0,0.5,9],target=[0,0,0],vfov=30}"]),
    ("mirror: seen along curves", "hidden-mirror", &[]),
    ("volume: lit, along straight rays", "smoke", &[STRAIGHT]),
    ("volume: maximum, along straight rays", "smoke", &[STRAIGHT, "volume.mode='maximum'", "volume.lit=false"]),
    ("volume: lit, along curves", "smoke", &[]),
];

/// Of the example `smoke`.
const STRAIGHT: &str = "camera={kind='pinhole',eye=[0,4.2,15],target=[0,4.2,0],vfov=40}";

/// The example `smoke` without its volume.
fn without_volume() -> Source {
    let scene = EXAMPLES.iter().find(|e| e.name == "smoke").map_or("", |e| e.scene);
    let (before, after) = scene.split_once("[volume]").unwrap_or((scene, ""));
    let (_, after) = after.split_once("[[light]]").unwrap_or_default();
    Source::Text(format!("{before}[[light]]{after}"))
}

/// Samples of a pixel, a frame each.
const BLURRED: u32 = 4;

pub fn cases() -> Vec<Case> {
    let case =
        |(name, example, set): (&str, _, &[&str])| Case::of(name, example, vec![Arm::ours()]).set(&SIZE).set(set);
    let blurred = Case::of(
        "things that move: with an open shutter",
        "rolling-shutter",
        vec![Arm::ours().samples(Samples::Separate(BLURRED))],
    );
    let blurred = blurred.set(&SIZE).set(&["camera.line_time=0", "image.shutter=0.04"]).filtered(FILTERED);
    let plain = Case::new("volume: none, along straight rays", without_volume(), vec![Arm::ours()]);
    CASES.map(case).into_iter().chain([plain.set(&SIZE).set(&[STRAIGHT]), blurred]).collect()
}

/// Samples of a pixel of the reference.
const FILTERED: u32 = 16;

pub fn quick() -> Vec<Case> {
    cases().into_iter().take(2).collect()
}
