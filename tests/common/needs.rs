//! What tests need of this machine. A test whose need is missing is skipped and says so. Where an adapter is required, a missing one is a
//! failure.

// each test binary uses a part of it
#![allow(dead_code)]

use anamorph::gpu::device::NO_ADAPTER;
use anamorph::gpu::{Gpu, GpuOptions};
use std::io::Write;
use std::sync::{Mutex, PoisonError};

/// If one of these is set, an adapter is required.
const NEEDED: [&str; 2] = ["CI", "ANAMORPH_NEED_GPU"];

/// The adapter; `None`, as [`no_adapter`] says, on a machine without any.
pub fn adapter() -> Option<Gpu> {
    let gpu = Gpu::open(&GpuOptions::default()).unwrap();
    if gpu.is_none() {
        no_adapter();
    }
    gpu
}

/// Reports a missing adapter: panics if one is required, and else says that the test is skipped.
pub fn no_adapter() {
    let is_set = |name: &str| std::env::var(name).is_ok_and(|value| !["", "0", "false"].contains(&value.as_str()));
    if let Some(name) = NEEDED.iter().find(|name| is_set(name)) {
        panic!("{NO_ADAPTER}; {name} is set, so tests require one");
    }
    skip(NO_ADAPTER);
}

/// Says once that the calling test is skipped, and counts skipped tests. The harness reports the test as passed and captures what it
/// prints, so this writes to the standard error stream directly.
pub fn skip(why: &str) {
    static SKIPPED: Mutex<Vec<String>> = Mutex::new(Vec::new());
    let thread = std::thread::current();
    // the test's name, unless all tests run on the main thread
    let name = thread.name().unwrap_or_default();
    let said = format!("{name}: {why}");
    let mut skipped = SKIPPED.lock().unwrap_or_else(PoisonError::into_inner);
    if name == "main" || !skipped.contains(&said) {
        let line = format!("skipped {}: {said}\n", skipped.len() + 1);
        // a closed stream is no reason to fail
        let _ = std::io::stderr().write_all(line.as_bytes());
        skipped.push(said);
    }
}
