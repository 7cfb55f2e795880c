//! Frames that combine features, against the reference.

use crate::SIZE;
use crate::common::combined::{Case, Compared, SMALL, Verdict, compared};
use crate::common::gpu::limit_bindings;
use crate::common::rng::Rng;
use anamorph::internals::camera::Camera;
use anamorph::internals::camera::exposure::Sample;
use anamorph::internals::engine::Engine;
use anamorph::internals::engine::combinations::Feature;
use anamorph::internals::engine::plan::samples::sample_offsets;
use anamorph::internals::gpu::{Gpu, GpuOptions};
use anamorph::internals::image::frame::NO_ID;
use anamorph::internals::reference::image::explain;
use std::ops::Range;

/// Scenes with the same features: each set of features takes kernels of its own.
const SCENES_PER_SET: u64 = 50;

/// Scenes after which the counts are printed.
const SCENES_PER_LINE: u64 = 1000;

/// Pixels and samples of these frames.
#[derive(Debug, Default)]
struct Seen {
    sets: u64,
    frames: u64,
    pixels: u64,
    safe: u64,
    proven: u64,
    samples: u64,
    /// Frames of some rows, and those that are not, to the byte, the rows of the whole image.
    strips: u64,
    strips_differ: u64,
    wrong_safe: u64,
    not_near: u64,
    wrongly_proven: u64,
    /// Frames that were not rendered: their kernels or lists need more than the adapter binds, or for another reason.
    not_bound: u64,
    failed: u64,
}

/// Compares the scenes of these numbers, with all features of their sets or those of `only`. Returns whether all is right.
pub fn run(numbers: Range<u64>, only: Option<&str>, options: &GpuOptions) -> bool {
    let mut all = Seen::default();
    let mut own: Option<(u64, Engine)> = None;
    for number in numbers.clone() {
        let set = number / SCENES_PER_SET;
        let is_kept =
            |feature: &Feature| only.is_none_or(|only| only.split(',').any(|name| format!("{feature:?}") == name));
        let features: Vec<Feature> = Case::any_features(&mut Rng(set)).into_iter().filter(is_kept).collect();
        let case = Case::any(&mut Rng(number), &features, SIZE);
        if own.as_ref().is_none_or(|(of, _)| *of != set) {
            // an engine keeps its kernels
            drop(own.take());
            all.sets += 1;
        }
        let (_, engine) = own.get_or_insert_with(|| (set, engine(&features, options)));
        let compared = match compared(&case, engine) {
            Ok(compared) => compared,
            Err(e) => {
                let text = e.to_string();
                if NOT_BOUND.iter().any(|part| text.contains(part)) {
                    all.not_bound += 1;
                } else {
                    println!("scene {number}, {features:?}, {}: {text}", case.camera.kind);
                    all.failed += 1;
                }
                continue;
            }
        };
        if numbers.end - numbers.start == 1 {
            tell_wrong(&case, &compared);
        }
        all.take(&case, &compared, &format!("scene {number}, {features:?}, {}", case.camera.kind));
        if number % SCENES_PER_LINE == SCENES_PER_LINE - 1 {
            println!("{} scenes from {}: {all:?}", number + 1 - numbers.start, numbers.start);
        }
    }
    println!("{} scenes from {}: {all:?}", numbers.end - numbers.start, numbers.start);
    all.wrong_safe + all.not_near + all.wrongly_proven + all.failed == 0
}

/// Parts of errors that name a limit of the adapter.
const NOT_BOUND: [&str; 3] = ["storage buffers", "lists between the stages overflow", "the adapter binds"];

/// An engine for frames of these features.
fn engine(features: &[Feature], options: &GpuOptions) -> Engine {
    let mut gpu = Gpu::open(options).ok().flatten().expect("the adapter of the start");
    if features.iter().any(|feature| matches!(feature, Feature::Bands | Feature::Chunks)) {
        limit_bindings(&mut gpu, SMALL);
    }
    Engine::new(gpu)
}

impl Seen {
    fn take(&mut self, case: &Case, compared: &Compared, name: &str) {
        self.frames += 1;
        self.strips += u64::from(case.wanted.rows.is_some());
        self.strips_differ += u64::from(compared.rows_differ);
        let of_samples = compared.samples.iter().map(|(_, verdict)| verdict);
        for verdict in compared.centres.iter().chain(of_samples.clone()) {
            let Verdict { wrong_safe, not_near, wrongly_proven, proven, safe, .. } = verdict;
            if verdict.wrong() > 0 {
                println!("{name}: {wrong_safe} safe pixels wrong, {not_near} not near, {wrongly_proven} proven wrong");
            }
            self.safe += safe.iter().filter(|safe| **safe).count() as u64;
            self.proven += proven;
            self.wrong_safe += wrong_safe;
            self.not_near += not_near;
            self.wrongly_proven += wrongly_proven;
        }
        let pixels = |verdict: &Verdict| verdict.safe.len() as u64;
        self.pixels += compared.centres.iter().map(pixels).sum::<u64>();
        self.samples += of_samples.map(pixels).sum::<u64>();
    }
}

/// Prints what the reference knows of the first wrong pixel of the centres, and of each sample.
fn tell_wrong(case: &Case, compared: &Compared) {
    let tell = |what: &str, camera: &Camera, verdict: &Verdict| {
        let Some((at, shown)) = verdict.first else { return };
        let (x, y) = (at as u32 % SIZE.0, at as u32 / SIZE.0);
        let primitive = (shown != NO_ID).then(|| case.scene.primitive_at(shown, case.scene.moment(camera, (x, y))));
        println!("{what}, pixel {x},{y} shows {shown}, {primitive:?}\n{}", explain(&case.scene, camera, x, y).text);
    };
    compared.centres.iter().for_each(|verdict| tell("centres", &case.camera, verdict));
    let offsets = sample_offsets(compared.wanted.samples);
    for (number, verdict) in &compared.samples {
        let sample = Sample { number: *number, count: compared.wanted.samples };
        let camera = case.camera.of_sample(offsets[*number as usize].into(), sample).expect("as it was rendered");
        tell(&format!("sample {number}"), &camera, verdict);
    }
}
