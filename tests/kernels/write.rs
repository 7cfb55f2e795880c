//! write: the kernel against its twin, from the same bytes.

use crate::common::rng::Rng;
use crate::stages::{Bench, Case, POISON, SPARE, assert_poisoned, cases, read, run, upload};
use anamorph::internals::engine::stage;
use anamorph::internals::image::frame::Channel;
use anamorph::internals::image::tone::{Curve, Tone};
use anamorph_lab::twin::write::{srgb, write};
use anamorph_lab::twin::{KernelInputs, LARGE, Real};

/// How near to a rounding border the exact value lies where the byte may be the next one, in steps of a byte. WGSL's
/// pow is exp2(y log2 x): log2 is right to 2^-21 near 1 and to 3 ulp elsewhere, exp2 to 3 + 2 |x| ulp, in all some
/// 3e-7 of the value; 255 times that is 8e-5.
const BORDER: f64 = 1e-4;

/// The same behind a gain and a curve: five roundings, three products and a division (2.5 ulp) more before the power of 1/2.4, some
/// 5e-7 of the value, 255 / 2.4 times.
const TONED_BORDER: f64 = BORDER + 6e-5;

const TONES: [Tone; 4] = [
    Tone { exposure: 0.0, curve: Curve::Clip },
    Tone { exposure: -1.3, curve: Curve::Clip },
    Tone { exposure: 0.7, curve: Curve::Reinhard },
    Tone { exposure: 2.0, curve: Curve::Aces },
];

/// Colours of which many lie near a border, a kink or an end of the curve.
fn colours(rng: &mut Rng, pixels: usize) -> Vec<f32> {
    let special = [0.0, -0.0, 1.0, 0.003_130_8, f32::MIN_POSITIVE, 1e-30, -1.0, 2.0, f32::INFINITY, f32::NEG_INFINITY];
    (0..3 * pixels)
        .map(|k| match k % 4 {
            0 => special[rng.below(special.len())],
            1 => rng.unit() as f32,
            2 => (0.006 * rng.unit()) as f32,
            // the linear value of a border between two bytes, a few roundings off
            _ => {
                let encoded = (rng.below(255) as f64 + 0.5) / 255.0;
                let linear = if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) };
                f32::from_bits((linear as f32).to_bits() + rng.below(9) as u32 - 4)
            }
        })
        .collect()
}

#[derive(Debug, Default)]
struct Compared {
    wrong: Vec<String>,
    excused: usize,
}

/// Compares every pixel's word with the colours of its planes, red first.
fn compare(words: &[u32], planes: [&[f32]; 3], tone: Tone) -> Compared {
    let border = if tone == Tone::default() { BORDER } else { TONED_BORDER };
    let mut seen = Compared::default();
    for (pixel, word) in words.iter().enumerate() {
        let colour = planes.map(|p| p[pixel]);
        let want = write(colour, tone);
        for (k, linear) in colour.into_iter().enumerate() {
            let (got, byte) = (word >> (8 * k) & 255, want >> (8 * k) & 255);
            let exact = srgb(tone.shown(f64::from(linear)));
            let near = (exact - (f64::from(got.min(byte)) + 0.5)).abs() <= border && got.abs_diff(byte) == 1;
            match (got == byte, near) {
                (true, _) => {}
                (false, true) => seen.excused += 1,
                (false, false) => seen.wrong.push(format!("pixel {pixel}, {linear}: {got} for {exact}")),
            }
        }
        if word >> 24 != 255 {
            seen.wrong.push(format!("pixel {pixel}: alpha {}", word >> 24));
        }
    }
    seen
}

#[test]
fn the_kernel_writes_what_its_twin_writes() {
    let Some(mut bench) = Bench::open() else { return };
    let mut case = cases().into_iter().find(|c| c.name == "bands and chunks").expect("a case of that name");
    let mut rng = Rng(5);
    // colour among other planes, and alone
    for planes in
        [&Channel::ALL[..], &[Channel::R, Channel::G, Channel::B], &[Channel::R, Channel::G, Channel::B, Channel::Z]]
    {
        for tone in TONES {
            case.scene.tone = tone;
            let tables = case.tables();
            for input in case.inputs(&tables, LARGE) {
                check(&mut bench, &mut rng, &case, &input, planes);
            }
        }
    }
}

fn check(bench: &mut Bench, rng: &mut Rng, case: &Case, input: &KernelInputs, planes: &[Channel]) {
    let pixels = (input.params.width * input.params.height) as usize;
    let colours = colours(rng, pixels);
    let plane = |k: usize| &colours[k * pixels..(k + 1) * pixels];
    let (gpu, stages) = bench.stages(case.variant(Real::F32, false), planes);
    let mut words = vec![POISON; planes.len() * pixels];
    for (k, channel) in [Channel::R, Channel::G, Channel::B].into_iter().enumerate() {
        let at = planes.iter().position(|c| *c == channel).unwrap() * pixels;
        words[at..at + pixels].iter_mut().zip(plane(k)).for_each(|(w, c)| *w = c.to_bits());
    }
    let mut buffers = upload(gpu, input);
    buffers.upload(gpu, "planes", &words).unwrap();
    buffers.upload(gpu, "srgb8", &vec![POISON; pixels + SPARE]).unwrap();
    run(gpu, |pass| {
        stages.encode(gpu, pass, &[&buffers], &[stage::write::write(pixels as u32)], &mut Default::default())
    });
    let out = read(gpu, &buffers, "srgb8");
    assert_poisoned(&out, pixels, "srgb8");
    assert_eq!(read(gpu, &buffers, "planes")[..words.len()], words, "write has changed what it reads");
    let seen = compare(&out[..pixels], [plane(0), plane(1), plane(2)], case.scene.tone);
    println!("{pixels} pixels, {} near a border", seen.excused);
    assert!(seen.wrong.is_empty(), "{} bytes differ, the first: {}", seen.wrong.len(), seen.wrong[0]);
}

#[test]
fn the_comparison_sees_planted_errors() {
    let mut rng = Rng(6);
    let colours = colours(&mut rng, 400);
    let planes = [&colours[..400], &colours[400..800], &colours[800..]];
    let right: Vec<u32> = (0..400).map(|k| write(planes.map(|p| p[k]), Tone::default())).collect();
    let seen = compare(&right, planes, Tone::default());
    assert!(seen.wrong.is_empty() && seen.excused == 0);
    for flip in [1 << 1, 1 << 9, 1 << 17, 1 << 30] {
        let mut words = right.clone();
        words[123] ^= flip;
        assert_eq!(compare(&words, planes, Tone::default()).wrong.len(), 1, "{flip:x}");
    }
    // one step off where the value is in the middle of its byte
    let middle = (0..400).find(|&k| (srgb(f64::from(planes[0][k])).fract() - 0.5).abs() > 0.4 && right[k] & 255 < 255);
    let mut words = right.clone();
    words[middle.unwrap()] += 1;
    assert_eq!(compare(&words, planes, Tone::default()).wrong.len(), 1);
}
