//! What tests need of this machine. Without it a test says so and ends; without an adapter it fails where one is to be there.

// every test binary uses a part of it
#![allow(dead_code)]

use anamorph::gpu::device::NO_ADAPTER;
use anamorph::gpu::{Gpu, GpuOptions};
use std::io::Write;
use std::sync::{Mutex, PoisonError};

/// Where one of these is set, there is to be an adapter.
const NEEDED: [&str; 2] = ["CI", "ANAMORPH_NEED_GPU"];

/// The adapter; `None`, as [`no_adapter`] says, on a machine without any.
pub fn adapter() -> Option<Gpu> {
    let gpu = Gpu::open(&GpuOptions::default()).unwrap();
    if gpu.is_none() {
        no_adapter();
    }
    gpu
}

/// There is no adapter: fails where one is to be there, and says elsewhere that the test is skipped.
pub fn no_adapter() {
    let is_set = |name: &str| std::env::var(name).is_ok_and(|value| !["", "0", "false"].contains(&value.as_str()));
    if let Some(name) = NEEDED.iter().find(|name| is_set(name)) {
        panic!("{NO_ADAPTER}; {name} is set, so that tests do not go without one");
    }
    skip(NO_ADAPTER);
}

/// Says that the test that calls it is skipped, once, with the number of those in this program. The harness counts the test as passed,
/// since it cannot ignore one that runs, and keeps to itself what tests print; so this writes to the standard error stream directly.
pub fn skip(why: &str) {
    static SKIPPED: Mutex<Vec<String>> = Mutex::new(Vec::new());
    let thread = std::thread::current();
    // the test's name, but where all tests run on the main thread
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
