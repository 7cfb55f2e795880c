//! What tests need of this machine. A test whose need is missing is skipped and says so, and its program says how many were. Where an
//! adapter is required, a missing one is a failure.

// each test binary uses a part of it
#![allow(dead_code)]

use anamorph::internals::gpu::device::NO_ADAPTER;
use anamorph::internals::gpu::{Gpu, GpuOptions};
use std::collections::BTreeSet;
use std::io::Write;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// If one of these is set, an adapter is required.
const REQUIRE: [&str; 2] = ["CI", "ANAMORPH_REQUIRE_ADAPTER"];

/// The adapter; `None`, as [`no_adapter`] says, on a machine without any. All tests of a program share its device, so that no kernel is
/// compiled twice.
pub fn adapter() -> Option<Gpu> {
    static SHARED: OnceLock<Option<Gpu>> = OnceLock::new();
    let shared = SHARED.get_or_init(|| Gpu::open(&GpuOptions::default()).unwrap());
    if shared.is_none() {
        no_adapter();
    }
    shared.as_ref().map(Gpu::shared)
}

/// The same with a device of its own, for tests in which it fails.
pub fn own_adapter() -> Option<Gpu> {
    let gpu = Gpu::open(&GpuOptions::default()).unwrap();
    if gpu.is_none() {
        no_adapter();
    }
    gpu
}

/// Reports a missing adapter: panics if one is required, and else says that the test is skipped.
pub fn no_adapter() {
    let is_set = |name: &str| std::env::var(name).is_ok_and(|value| !["", "0", "false"].contains(&value.as_str()));
    if let Some(name) = REQUIRE.iter().find(|name| is_set(name)) {
        panic!("{NO_ADAPTER}; {name} is set, so tests require one");
    }
    skip(NO_ADAPTER);
}

/// What each skipped test said.
static SKIPPED: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());

fn skipped() -> MutexGuard<'static, BTreeSet<String>> {
    SKIPPED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Says that the calling test is skipped; how many are is said once more at the end. The harness reports the test as passed and captures
/// what it prints, so this writes to the standard error stream directly.
pub fn skip(why: &str) {
    let thread = std::thread::current();
    // the test's name, unless all tests run on the main thread
    let name = thread.name().unwrap_or_default();
    let mut skipped = skipped();
    if skipped.is_empty() {
        // SAFETY: the function is there until the program ends
        unsafe { libc::atexit(sum_up) };
    }
    let count = if name == "main" { format!(" {}", skipped.len() + 1) } else { String::new() };
    let said = format!("skipped: {name}{count}: {why}");
    if skipped.insert(said.clone()) {
        say(&said);
    }
}

/// The summary, after the harness's own.
extern "C" fn sum_up() {
    let skipped = skipped();
    let without = skipped.iter().filter(|s| s.ends_with(NO_ADAPTER)).count();
    if without > 0 {
        say(&format!("tests skipped for lack of an adapter: {without}"));
    }
    if skipped.len() > without {
        say(&format!("tests skipped for other reasons: {}", skipped.len() - without));
    }
}

fn say(line: &str) {
    // a closed stream is no reason to fail
    let _ = std::io::stderr().write_all(format!("{line}\n").as_bytes());
}
