//! circle.wgsl: cosines and sines by the adapter against the host's.

use crate::stages::Bench;
use anamorph::internals::gpu::layout::split2;
use anamorph_lab::twin::Real;
use anamorph_lab::twin::bounded::CIRCLE_UNITS;
use std::f64::consts::TAU;

/// Reads revolutions as pairs and writes cosine and sine, each as the exact sum of three f32.
const PROBE: &str = "
@group(0) @binding(0) var<storage, read> revolutions: array<vec2<f32>>;
@group(0) @binding(1) var<storage, read_write> found: array<array<vec2<f32>, 3>>;

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&revolutions) {
        return;
    }
    let at = circle(real(revolutions[id.x].x) + real(revolutions[id.x].y));
    // rounded by integer operations: a driver may optimize away a conversion to f32 and back
    let hi = vec2<real>(round_to_f32(at.x), round_to_f32(at.y));
    let rest = at - hi;
    let mid = vec2<real>(round_to_f32(rest.x), round_to_f32(rest.y));
    found[id.x] = array<vec2<f32>, 3>(vec2<f32>(hi), vec2<f32>(mid), vec2<f32>(rest - mid));
}
";

/// Revolutions of all sizes up to a thousand, quarters and eighths among them and next to them.
fn revolutions() -> Vec<[f32; 2]> {
    let mut list = Vec::new();
    for k in -4096..4096_i32 {
        let quarter = f64::from(k) / 8.0;
        let any = f64::from(k) * 0.123_456_789_012_345;
        let small = any * (-f64::from(k.rem_euclid(41))).exp2();
        list.extend([quarter, quarter * (1.0 + 1e-14), quarter + 1e-7, any, small].map(split2));
    }
    list
}

fn found(bench: &Bench, real: Real, revolutions: &[[f32; 2]]) -> Vec<[f64; 2]> {
    let arithmetic = match real {
        Real::F64 => include_str!("../../wgsl/arithmetic/f64.wgsl"),
        Real::F32 => include_str!("../../wgsl/arithmetic/f32.wgsl"),
    };
    let source = [arithmetic, include_str!("../../wgsl/optics/circle.wgsl"), PROBE].concat();
    let number = |w: &[u32], k: usize| [4, 2, 0].map(|part| f64::from(f32::from_bits(w[k + part]))).iter().sum();
    bench.probe(&source, revolutions, 6).chunks_exact(6).map(|w| [number(w, 0), number(w, 1)]).collect()
}

#[test]
fn cosines_and_sines_are_within_their_roundings() {
    let Some(bench) = Bench::open() else { return };
    let revolutions = revolutions();
    let reals = bench.variants().into_iter().filter(|v| !v.1).map(|v| v.0);
    for real in reals {
        let mut most = 0.0_f64;
        for (revolution, [c, s]) in revolutions.iter().zip(found(&bench, real, &revolutions)) {
            // f32 adds the pair up before
            let revolution = match real {
                Real::F64 => f64::from(revolution[0]) + f64::from(revolution[1]),
                Real::F32 => f64::from(revolution[0] + revolution[1]),
            };
            // whole revolutions go without a rounding
            let (sine, cosine) = (TAU * (revolution - revolution.round())).sin_cos();
            // parts may be flushed to 0, and the host has rounded its own 2 pi, product and result
            let margin = |v: f64| 2.0 * f64::from(f32::MIN_POSITIVE) + f64::EPSILON * v.abs();
            let angle = TAU * (revolution - revolution.round());
            let units = |off: f64, v: f64, slope: f64| {
                (off - margin(v) - f64::EPSILON * (angle * slope).abs()).max(0.0) / real.rounding()
            };
            let (off_c, off_s) = (units((c - cosine).abs(), cosine, sine), units((s - sine).abs(), sine, cosine));
            most = most.max(off_c).max(off_s);
            // a small sine is as near as it is small
            let near = revolution.abs() > 0.125 || off_s <= CIRCLE_UNITS * sine.abs();
            assert!(near, "{real:?}: the sine of {revolution} revolutions is {s}, not {sine}");
        }
        println!("{real:?}: {most:.2} roundings");
        assert!(most <= CIRCLE_UNITS, "{real:?}: off by {most} roundings");
    }
}
