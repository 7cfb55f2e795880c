//! Signals. Ctrl-C and `kill`: temporary files are removed before the signal ends the program. A limit on file sizes: writing fails.

use crate::image::remove_unfinished;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

/// From now on, SIGHUP, SIGINT and SIGTERM remove temporary files before they end the program. A signal that was ignored when the program
/// started, as SIGHUP under `nohup`, stays ignored. SIGXFSZ, which says that a file reached the size of `ulimit -f`, no longer ends the program:
/// the write returns an error, as on a full disk.
pub fn handle() {
    let ignored = ignored();
    let caught = [SIGHUP, SIGINT, SIGTERM, SIGXFSZ].into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0);
    // if the system refuses, signals end the program as usual
    let Ok(mut signals) = Signals::new(caught) else { return };
    let wait = move || {
        for signal in signals.forever().filter(|signal| *signal != SIGXFSZ) {
            let _no_more_are_created = remove_unfinished();
            // so that the parent process sees which signal ended the program
            let _ = emulate_default_handler(signal);
        }
    };
    let _ = std::thread::Builder::new().name("signals".into()).spawn(wait);
}

/// The ignored signals, one bit each; 0 if the system does not say.
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}
