//! meet: the kernel against its twin, from the same bytes.

use crate::bounced::{bounces, cases, delicate, variant};
use crate::stages::{Bench, Case, POISON, SPARE, assert_poisoned, read, run, upload};
use anamorph::internals::engine::stage;
use anamorph::internals::engine::stage::raster::raster_steps;
use anamorph::internals::gpu::kernels::{Kernel, OpticsKind, OpticsModel};
use anamorph_lab::twin::meet::{meet, meetings};
use anamorph_lab::twin::quadric::HEIGHT_UNITS;
use anamorph_lab::twin::raster::Visibility;
use anamorph_lab::twin::{KernelInputs, Real, along, torus, wave};

/// Share of pixels that may be excused because the twin's own bound leaves them undecided: rays that pass a rim or touch
/// a surface within rounding.
const EXCUSED_MAX_F64: f64 = 0.0;
const EXCUSED_MAX_F32: f64 = 0.002;

/// Merges into a buffer that holds `before`, as the engine does: every word of a key in a step of its own.
fn run_kernel(
    bench: &mut Bench,
    case: &Case,
    (real, atomics64): (Real, bool),
    input: &KernelInputs,
    before: &[[u32; 2]],
) -> Vec<[u32; 2]> {
    let (gpu, stages) = bench.stages(variant(case, input, real, atomics64), &[]);
    let mut buffers = upload(gpu, input);
    let mut words = before.to_vec();
    words.resize(before.len() + SPARE, [POISON; 2]);
    buffers.upload(gpu, "visibility", &words).unwrap();
    for step in 0..raster_steps(stages.variant) {
        run(gpu, |pass| stages.encode(gpu, pass, &[&buffers], &[stage::meet::meet(step)], &mut Default::default()));
    }
    let words = read(gpu, &buffers, "visibility");
    assert_poisoned(&words, 2 * before.len(), &format!("{}, visibility", case.name));
    words.chunks_exact(2).take(before.len()).map(|w| [w[0], w[1]]).collect()
}

/// How a visibility buffer stands against the twin's.
#[derive(Debug, Default)]
struct Compared {
    wrong: Vec<String>,
    met: usize,
    excused: usize,
    /// Largest share of what t may be off.
    share: f64,
}

fn compare(input: &KernelInputs, real: Real, kernel: &[[u32; 2]], twin: &Visibility) -> Compared {
    let mut seen = Compared::default();
    let keys = input.keys(real);
    let kernel_keys = Visibility { words: kernel.to_vec(), ..twin.clone() };
    for pixel in 0..kernel.len() {
        let (a, b) = (kernel_keys.key(pixel), twin.key(pixel));
        seen.met += usize::from(b.is_some());
        let near = |key: u64| meetings(input, pixel as u32, real).into_iter().find(|m| m.0 == keys.id(key));
        let right = match (a, b) {
            (Some(a), Some(b)) if a != b => {
                // the same surface or another one as near, at a t within both errors and what keys tell apart
                let error = |key: u64| near(key).and_then(|m| m.1.t).map_or(0.0, |t| t.e);
                let may = error(a) + error(b) + 2.0 * keys.step() * keys.t(b).abs();
                let off = (keys.t(a) - keys.t(b)).abs();
                seen.share = seen.share.max(off / may);
                off <= may && near(a).is_some()
            }
            _ => a == b,
        };
        if !right && twin.uncertain[pixel] {
            seen.excused += 1;
        } else if !right {
            seen.wrong.push(format!("pixel {pixel}: {a:x?} for {b:x?}"));
        }
    }
    seen
}

/// A buffer to merge into, in which every third pixel shows something nearer, and one farther; and what the twin makes of
/// it. An empty one where words go one after the other: the first step of all that merge is before the second of any.
fn buffers(input: &KernelInputs, real: Real, atomics64: bool) -> (Visibility, Visibility) {
    let pixels = (input.params.width * input.params.height) as usize;
    let keys = input.keys(real);
    let mut met = Visibility::new(pixels);
    meet(input, real, &mut met);
    let mut before = Visibility::new(pixels);
    for pixel in (0..pixels).filter(|p| atomics64 && p % 3 > 0) {
        if let Some(key) = met.key(pixel) {
            let factor = if pixel % 3 == 1 { 0.5 } else { 2.0 };
            before.merge(pixel, !keys.key(0, factor * keys.t(key), 0));
        }
    }
    let mut after = before.clone();
    meet(input, real, &mut after);
    (before, after)
}

fn smooth() -> impl Iterator<Item = Case> {
    cases().into_iter().filter(|c| c.camera.optics.as_ref().unwrap().smooth_count() > 0)
}

#[test]
fn the_kernel_meets_what_its_twin_meets() {
    let Some(mut bench) = Bench::open() else { return };
    let variants = bench.variants();
    let f64_alone = |case| (case, variants.iter().copied().filter(|v| v.0 == Real::F64).collect());
    let all = smooth().map(|case| (case, variants.clone())).chain(delicate().into_iter().map(f64_alone));
    for (case, variants) in all.collect::<Vec<(Case, Vec<_>)>>() {
        let tables = case.tables();
        let mut met = 0;
        for &(real, atomics64) in &variants {
            tables.follow(&case.camera, 0, real, |inputs, _| {
                let input = &inputs[0];
                let (before, after) = buffers(input, real, atomics64);
                let kernel = run_kernel(&mut bench, &case, (real, atomics64), input, &before.words);
                let seen = compare(input, real, &kernel, &after);
                let name = format!("{}, after {}, {real:?}, 64-bit atomics {atomics64}", case.name, bounces(input));
                println!("{name}: {} met, {} excused, t {:.3} of its bound", seen.met, seen.excused, seen.share);
                assert!(seen.wrong.is_empty(), "{name}: {} differ, the first: {}", seen.wrong.len(), seen.wrong[0]);
                let most = if real == Real::F64 { EXCUSED_MAX_F64 } else { EXCUSED_MAX_F32 };
                assert!(seen.excused as f64 <= most * kernel.len() as f64, "{name}: {} excused", seen.excused);
                met += seen.met;
            });
        }
        assert!(met > 75 * variants.len(), "{}: {met} pixels meet something", case.name);
    }
}

#[test]
fn the_twin_s_rules_have_the_kernels_constants() {
    let of = |optics| {
        let plain = cases().remove(0).variant(Real::F64, false);
        let optics = Some(OpticsModel { kind: optics, bounced: false });
        Kernel::new("meet.wgsl", plain.with(|v| v.rays.optics = optics), &[]).source()
    };
    let holds = |optics, line: &str| assert!(of(optics).contains(line), "{line}");
    holds(OpticsKind::Quadrics, &format!("const HEIGHT_UNITS: real = {HEIGHT_UNITS:?};"));
    for optics in [OpticsKind::Torus, OpticsKind::Wave] {
        holds(optics, &format!("const STEP: real = {:?};", along::STEP));
    }
    holds(OpticsKind::Torus, &format!("const MARGIN: real = {:?};", torus::MARGIN));
    holds(OpticsKind::Torus, &format!("const STEPS: u32 = {}u;", torus::STEPS));
    holds(OpticsKind::Wave, &format!("const MARGIN: real = {:?};", wave::MARGIN));
    holds(OpticsKind::Wave, &format!("const STEPS: u32 = {}u;", wave::STEPS));
    holds(OpticsKind::Wave, &format!("const WAVE_STEPS: f32 = {:?};", wave::WAVE_STEPS));
}

#[test]
fn the_comparison_sees_planted_errors() {
    let case = smooth().next().unwrap();
    let tables = case.tables();
    tables.follow(&case.camera, 0, Real::F64, |inputs, _| {
        let input = &inputs[0];
        let (_, after) = buffers(input, Real::F64, true);
        let right = after.words.clone();
        assert!(compare(input, Real::F64, &right, &after).wrong.is_empty());
        if bounces(input) > 0 {
            // a mirror of one ball is not seen in itself
            assert!(right.iter().all(|w| *w == [0; 2]));
            return;
        }
        // a pixel whose word is not that of `before`
        let hit = (0..right.len()).position(|k| k % 3 == 0 && right[k] != [0; 2]).unwrap();
        let miss = right.iter().position(|w| *w == [0; 2]).unwrap();
        let step = 1 << (input.params.id_bits + 9);
        for (pixel, word) in [
            (hit, [0; 2]),
            (miss, right[hit]),
            // t off by 512 steps of its last kept bit, some 1e-10 of itself
            (hit, [right[hit][0] ^ step, right[hit][1]]),
            (hit, [right[hit][0] ^ 1, right[hit][1]]),
        ] {
            let mut words = right.clone();
            words[pixel] = word;
            assert_eq!(compare(input, Real::F64, &words, &after).wrong.len(), 1, "pixel {pixel} as {word:x?}");
        }
    });
}
