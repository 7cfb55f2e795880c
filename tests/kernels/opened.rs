//! exact: what an adapter computes when it is opened, and what becomes of one that is wrong.

use crate::common::needs;
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::device::label;
use anamorph::internals::gpu::exact::{check, wrong};
use anamorph::internals::gpu::kernels::{File, Files};
use std::time::Instant;

const REAL: &str = "arithmetic/f64.wgsl";
const OWN: &str = "control/exact.wgsl";

/// A device whose kernels have `from` of a file replaced, after it was opened.
fn planted(name: &'static str, from: &str, to: &str) -> Option<Gpu> {
    let mut gpu = needs::adapter()?;
    let text = Files::own().get(name).expect("a file of the kernel").text;
    assert!(text.contains(from), "{name} has no {from:?}");
    gpu.replaced = vec![Box::leak(Box::new(File::new(name, text.replacen(from, to, 1).leak())))];
    Some(gpu)
}

#[test]
fn this_adapter_is_right_with_its_own_f64_and_with_words() {
    let Some(mut gpu) = needs::adapter() else { return };
    assert!(!gpu.has.f64_is_wrong);
    for f64 in [gpu.has.f64, false] {
        gpu.has.f64 = f64;
        let started = Instant::now();
        assert_eq!(wrong(&gpu).unwrap(), None);
        println!("f64 of its own: {f64}, {:.1} ms", 1e3 * started.elapsed().as_secs_f64());
    }
}

/// As naga's HLSL has it: numbers for bits.
#[test]
fn an_adapter_whose_f64_is_wrong_does_without() {
    for (from, to) in [("bitcast<f64>(", "f64("), ("bitcast<u64>(t)", "u64(abs(t))")] {
        let Some(mut gpu) = planted(REAL, from, to) else { return };
        if !gpu.has.f64 {
            return needs::skip("the adapter has no f64 of its own");
        }
        check(&mut gpu).unwrap();
        assert!(!gpu.has.f64 && gpu.has.f64_is_wrong, "{to}");
    }
}

#[test]
fn an_adapter_that_is_wrong_with_words_too_is_refused() {
    let plants = [
        (OWN, "real(pair.x) + real(pair.y)", "real(pair.x + pair.y)", "the sum of a pair"),
        (OWN, "real(pair.x) * real(pair.y)", "real(pair.x * pair.y)", "the product of a pair"),
        (REAL, "w.x + 0x10000000u", "w.x", "the split into a pair"),
        (REAL, "k < 4u", "k < 3u", "the sign of a difference of products"),
    ];
    for (name, from, to, what) in plants {
        let Some(mut gpu) = planted(name, from, to) else { return };
        let error = check(&mut gpu).unwrap_err().to_string();
        assert_eq!(error, format!("adapter {}: {what} is wrong; use --engine reference", label(&gpu.info)));
    }
}
