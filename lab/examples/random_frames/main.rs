//! Random small scenes against the reference: `cargo run --release -p anamorph-lab --example random_frames -- COUNT [FIRST] [OPTION ...]`. Each is
//! one scene of 32 x 32 pixels, by its number; what is wrong is printed with it, and counted at the end. Options, of which scenes:
//!
//! * `moving`: everything moves while the frame is taken.
//! * `spheres`: there are spheres between the triangles.
//! * `on-the-mesh`: the camera lies on the triangles, and all are on a lattice.
//! * `placed`: the mesh stands in several places, and is traced there.
//! * `kept`: each scene is rendered from a few poses, on one device that keeps what it can, and some triangles move between the poses.
//! * `combined`: frames have features from the whole table of what goes together, other ones for every fifty scenes; with `combined=A,B` only
//!   those of these.
//!
//! And of adapters: `no-int64` without 64-bit atomics, where raster bounds t in f32 as it does on GPUs without f64; `no-f64`.

mod combined;
#[path = "../../../tests/common/mod.rs"]
mod common;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::combinations::at_once;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::plan::samples::sample_offsets;
use anamorph::internals::engine::planned::Planned;
use anamorph::internals::engine::sequence::Sequence;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::gpu::kernels::Method;
use anamorph::internals::gpu::{Gpu, GpuOptions};
use anamorph::internals::image::compare::compare;
use anamorph::internals::image::frame::{Channel, Frame, Plane};
use anamorph::internals::input::Result;
use anamorph::internals::reference::image::{explain, judge};
use anamorph::internals::scene::Scene;
use std::process::ExitCode;

const SIZE: (u32, u32) = (32, 32);

/// Pixels of all frames, by what is known of them.
#[derive(Debug, Default)]
struct Seen {
    pixels: u64,
    unsafe_pixels: u64,
    wrong_safe: u64,
    not_near: u64,
    by_f32: u64,
    by_recheck: u64,
    certified_wrong: u64,
    /// Pixels whose t or triangle is another one by raster with `small` (proofs take all pairs), or by trace.
    by_other_ways: u64,
    /// Samples of pixels, and those wrong or not near.
    samples: u64,
    samples_wrong: u64,
}

const OPTIONS: [&str; 8] = ["no-int64", "no-f64", "moving", "spheres", "on-the-mesh", "placed", "kept", "combined"];

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let less = |what: &str| words.iter().any(|word| word == what);
    let options = GpuOptions { no_int64: less("no-int64"), no_f64: less("no-f64"), ..GpuOptions::default() };
    let is_option = |word: &&String| OPTIONS.contains(&word.split('=').next().unwrap_or_default());
    let mut numbers = words.iter().filter(|word| !is_option(word)).map(|n| n.parse::<u64>());
    let (Some(Ok(count)), first) = (numbers.next(), numbers.next().transpose().unwrap_or(None).unwrap_or(0)) else {
        eprintln!("error: give how many scenes, and the first one's number; as in random_frames 1000 0");
        return ExitCode::from(2);
    };
    if let Some(word) = words.iter().find(|word| word.starts_with("combined")) {
        let only = word.split_once('=').map(|(_, names)| names);
        return ExitCode::from(u8::from(!combined::run(first..first + count, only, &options)));
    }
    let Ok(Some(gpu)) = Gpu::open(&options) else {
        eprintln!("error: no adapter");
        return ExitCode::from(1);
    };
    let mut engine = Engine::new(gpu);
    // what moves is not certified, nor are spheres and meshes in several places
    let is_traced = less("moving") || less("spheres") || less("placed");
    let method = if less("placed") { Method::Trace } else { Method::Auto };
    let run = RunOptions { method, ..RunOptions::default() };
    let certified = if is_traced { None } else { Some(Channel::Certified) };
    let channels: Vec<Channel> = [Channel::T, Channel::TriangleId].into_iter().chain(certified).collect();
    let wanted = Wanted::of(channels);
    let mut all = Seen::default();
    let (mut sequence, mut last) = Default::default();
    for number in first..first + count {
        let rng = &mut common::rng::Rng(number);
        if less("kept") {
            let mut path = match less("placed") {
                true => common::any::Path::placed(rng, SIZE),
                false => common::any::Path::new(rng, SIZE),
            };
            let is_traced = path.is_reflected() || less("placed");
            let certified = if is_traced { None } else { certified };
            let wanted = Wanted::of([Channel::T, Channel::TriangleId].into_iter().chain(certified).collect());
            for _ in 0..POSES {
                let camera = path.step(rng);
                let frame = kept_frame(&mut engine, &path.scene, &camera, &wanted, &run, (&mut sequence, &mut last));
                check(&mut engine, (number, count), (&path.scene, &camera), is_traced, frame, &mut all);
            }
            continue;
        }
        let (scene, camera) = match (less("moving"), less("spheres")) {
            (true, _) => common::any::any_moving(rng, SIZE),
            (false, true) => common::any::any_with_spheres(rng, SIZE),
            (false, false) if less("placed") => common::any::any_placed(rng, SIZE),
            (false, false) if less("on-the-mesh") => common::any::any_on_the_mesh(rng, SIZE),
            (false, false) => common::any::any(rng, SIZE),
        };
        let frame = engine.render(&scene, &camera, &wanted, &run).map(|rendered| rendered.frame);
        check(&mut engine, (number, count), (&scene, &camera), is_traced, frame, &mut all);
    }
    println!("{count} scenes from {first}: {all:?}");
    ExitCode::from(u8::from(
        all.wrong_safe + all.not_near + all.certified_wrong + all.by_other_ways + all.samples_wrong > 0,
    ))
}

/// Poses of a path.
const POSES: u32 = 4;

/// Renders a frame in a sequence, so that the device uses what it holds of earlier frames.
fn kept_frame(
    engine: &mut Engine,
    scene: &Scene,
    camera: &Camera,
    wanted: &Wanted,
    run: &RunOptions,
    (sequence, last): (&mut Sequence, &mut Option<Planned>),
) -> Result<Frame> {
    let planned = engine.planner().plan(scene, camera, wanted, run, last.as_ref())?;
    *last = Some(planned.clone());
    Ok(sequence.render(engine, planned, run)?.rendered().frame)
}

/// Compares a frame with the reference and with frames by other methods; `is_traced`: not with raster.
fn check(
    engine: &mut Engine,
    (number, count): (u64, u64),
    (scene, camera): (&Scene, &Camera),
    is_traced: bool,
    frame: Result<Frame>,
    all: &mut Seen,
) {
    let frame = match frame {
        Ok(frame) => frame,
        Err(e) => {
            println!("scene {number}: {e}");
            all.not_near += 1;
            return;
        }
    };
    let judged = judge(scene, camera, &frame);
    let seen = match compare(&frame, &judged.truth, Some(&judged.safe), Some(&judged.scales)) {
        Ok(seen) => seen,
        Err(e) => {
            println!("scene {number}: {e}");
            return;
        }
    };
    let ids = |f: &anamorph::internals::image::frame::Frame| f.u32(Channel::TriangleId).unwrap_or_default().to_vec();
    let proven = frame.u32(Channel::Certified).unwrap_or_default();
    let same: Vec<bool> = ids(&frame).iter().zip(ids(&judged.truth)).map(|(a, b)| *a == b).collect();
    let certified_wrong = proven.iter().zip(&same).filter(|(p, same)| **p > 0 && !**same).count() as u64;
    let wrong_safe = seen.wrong_safe.unwrap_or(0);
    if wrong_safe + judged.not_near + certified_wrong > 0 {
        let faults =
            format!("{wrong_safe} safe pixels wrong, {} not near, {certified_wrong} proven wrong", judged.not_near);
        println!("scene {number}, {}: {faults}", camera.kind);
        // of one scene alone, why
        let matters = |k: &usize| judged.safe[*k] || judged.not_near > 0 || proven.get(*k).is_some_and(|p| *p > 0);
        let wrong = (0..same.len()).filter(|k| count == 1 && !same[*k] && matters(k));
        for k in wrong.take(3) {
            let (x, y) = (k as u32 % SIZE.0, k as u32 / SIZE.0);
            println!("pixel {x},{y} shows {:?}, proven {:?}", ids(&frame)[k], proven.get(k));
            println!("{}", explain(scene, camera, x, y).text);
        }
    }
    let has = engine.gpu.has;
    // where raster finds t in f64, by a formula of its own, it may take another of two triangles that are level to within rounding, and
    // t may be rounded to the f32 beside
    let own_t = has.f64 && (!has.by_tile() || has.software && has.atomics64);
    let counts = (0..judged.safe.len()).map(|k| judged.safe[k] || !own_t).collect();
    let rounding = judged.scales.iter().map(|scale| T_ROUNDING * f64::from(*scale)).collect();
    let allowed = Allowed { counts, gap: u32::from(own_t), rounding };
    let ways: &[Method] = if is_traced { &[Method::Trace] } else { &[Method::Raster, Method::Trace] };
    let differ: u64 = ways.iter().map(|m| differing(engine, scene, camera, *m, &frame, &allowed)).sum();
    if differ > 0 {
        println!("scene {number}, {}: {differ} pixels differ by raster with small, or by trace", camera.kind);
    }
    all.by_other_ways += differ;
    let wrong = wrong_samples(engine, scene, camera);
    if let Some(Err(e)) = &wrong {
        println!("scene {number}, {}: {e}", camera.kind);
    }
    if let Some(wrong) = wrong {
        let wrong = wrong.unwrap_or(1);
        if wrong > 0 {
            println!("scene {number}, {}: {wrong} samples wrong", camera.kind);
        }
        all.samples += u64::from(SAMPLES) * seen.pixels;
        all.samples_wrong += wrong;
    }
    all.pixels += seen.pixels;
    all.unsafe_pixels += seen.unsafe_pixels.unwrap_or(0);
    all.wrong_safe += wrong_safe;
    all.not_near += judged.not_near;
    all.by_f32 += proven.iter().filter(|p| **p == 2).count() as u64;
    all.by_recheck += proven.iter().filter(|p| **p == 1).count() as u64;
    all.certified_wrong += certified_wrong;
}

/// Share of a pixel's scale of t that two ways to compute t may differ by where t is near 0: 16 roundings of a stored number (2^-48).
const T_ROUNDING: f64 = 16.0 / (1_u64 << 48) as f64;

/// Differences that two ways to compute a frame may have.
struct Allowed {
    /// The pixels that are compared.
    counts: Vec<bool>,
    /// So many f32 numbers lie between two t.
    gap: u32,
    /// So far apart are two t of a pixel, near 0.
    rounding: Vec<f64>,
}

/// How many pixels show another triangle by a method than in `frame`, or a t that differs by more than is allowed.
fn differing(
    engine: &mut Engine,
    scene: &Scene,
    camera: &Camera,
    method: Method,
    frame: &Frame,
    allowed: &Allowed,
) -> u64 {
    let wanted = Wanted::of(vec![Channel::T, Channel::TriangleId]);
    let words = |f: &Frame| {
        let t = f.f32(Channel::T).into_iter().flatten().map(|t| t.to_bits());
        let ids = f.u32(Channel::TriangleId).into_iter().flatten().copied();
        t.zip(ids).collect::<Vec<_>>()
    };
    match engine.render(scene, camera, &wanted, &RunOptions { method, ..RunOptions::default() }) {
        Ok(rendered) => {
            let (by, of_frame) = (words(&rendered.frame), words(frame));
            let differs = |k: &usize| {
                let ((t, id), (own_t, own_id)) = (by[*k], of_frame[*k]);
                let off = f64::from((f32::from_bits(t) - f32::from_bits(own_t)).abs());
                allowed.counts[*k] && (id != own_id || t.abs_diff(own_t) > allowed.gap && off > allowed.rounding[*k])
            };
            let tell = |k: &usize| {
                let [own, other] = [of_frame[*k], by[*k]].map(|(t, id)| (f32::from_bits(t), id));
                println!(
                    "pixel {},{}: t and triangle {own:?}, by {method:?} {other:?}",
                    *k as u32 % SIZE.0,
                    *k as u32 / SIZE.0
                );
            };
            let differ = (0..of_frame.len()).filter(differs);
            differ.inspect(tell).count() as u64
        }
        Err(e) => {
            println!("{method:?}: {e}");
            1
        }
    }
}

/// Samples of a pixel.
const SAMPLES: u32 = 4;

/// How many samples of the pixels of a frame see what they do not, of cameras whose samples are found in one frame.
fn wrong_samples(engine: &mut Engine, scene: &Scene, camera: &Camera) -> Option<Result<u64>> {
    at_once(scene, camera, SAMPLES).then(|| {
        let wanted = Wanted { samples: SAMPLES, sample_ids: true, ..Wanted::of(vec![Channel::TriangleId]) };
        let rendered = engine.render(scene, camera, &wanted, &RunOptions::default())?;
        let mut wrong = 0;
        for (place, ids) in sample_offsets(SAMPLES).into_iter().zip(rendered.sample_ids) {
            let planes = vec![(Channel::TriangleId, Plane::U32(ids))];
            let own = Frame { width: SIZE.0, height: SIZE.1, planes };
            let judged = judge(scene, &camera.with_sample_offset(place.x, place.y), &own);
            let seen = compare(&own, &judged.truth, Some(&judged.safe), None)?;
            wrong += seen.wrong_safe.unwrap_or(0) + judged.not_near;
        }
        Ok(wrong)
    })
}
