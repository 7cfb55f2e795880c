//! Ctrl-C and `kill`: temporary files are removed, then the program ends as it would have.

use crate::output::remove_unfinished;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;
use std::ffi::c_int;

/// From now on these signals leave no temporary file behind. Those that the program was started to ignore, as `nohup` does, stay ignored.
pub fn clear_up_when_ended() {
    let ignored = ignored();
    let caught = [SIGHUP, SIGINT, SIGTERM].into_iter().filter(|signal| ignored & bit(*signal) == 0);
    // without them all else still works
    let Ok(mut signals) = Signals::new(caught) else { return };
    let wait = move || {
        for signal in signals.forever() {
            let _none_is_made = remove_unfinished();
            // ends the program, so that whoever waits for it sees the signal
            let _ = emulate_default_handler(signal);
        }
    };
    let _ = std::thread::Builder::new().name("signals".into()).spawn(wait);
}

/// A bit for each signal that is ignored; 0 where the system does not say.
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

fn bit(signal: c_int) -> u64 {
    1 << (signal - 1)
}
