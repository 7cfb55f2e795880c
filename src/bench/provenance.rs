//! Where results come from.

use crate::engine::Engine;
use serde::{Deserialize, Serialize};
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

/// What a row cannot be understood without.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Year, month, day, UTC.
    pub date: String,
    pub adapter: String,
    pub driver: String,
    /// The adapter is no hardware.
    pub is_software: bool,
    pub cores: usize,
    pub version: String,
    /// Of the source in the working folder, where it is some.
    pub commit: Option<String>,
    pub command: String,
    pub quick: bool,
}

impl Provenance {
    pub fn now(engine: &Engine, quick: bool) -> Provenance {
        let info = &engine.gpu.info;
        let arguments = std::env::args().skip(1).map(|a| format!(" {a}"));
        Provenance {
            date: today(),
            adapter: info.name.clone(),
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            is_software: info.device_type == wgpu::DeviceType::Cpu,
            cores: std::thread::available_parallelism().map_or(1, |n| n.get()),
            version: env!("CARGO_PKG_VERSION").into(),
            commit: commit(),
            command: format!("anamorph{}", arguments.collect::<String>()),
            quick,
        }
    }

    /// What must be said beside figures of such an adapter.
    pub fn fairness(&self) -> &'static str {
        if self.is_software {
            "A software adapter: rasterization and compute kernels both run on the CPU's cores, on a machine that others may use. \
             Ratios of one run mean something, times little; no figure of a GPU compares."
        } else if ["H100", "H200", "A100", "B200", "GH200"].iter().any(|chip| self.adapter.contains(chip)) {
            "This chip has almost no raster units: compute kernels are far faster on it than fragment work, so that a win over the \
             raster pipeline that was measured only here is unfair to that."
        } else {
            "Rasterization is the adapter's own hardware; compute kernels are this program's."
        }
    }
}

/// The commit that is checked out, `-dirty` where more than results differs from it.
fn commit() -> Option<String> {
    let git = |args: &[&str]| {
        let output = Command::new("git").args(args).output().ok().filter(|o| o.status.success())?;
        Some(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let changed = git(&["status", "--porcelain", "--", ":/", ":(top,exclude)bench_results"])?;
    let dirty = if changed.is_empty() { "" } else { "-dirty" };
    Some(git(&["describe", "--always"])? + dirty)
}

fn today() -> String {
    const DAY_S: u64 = 86_400;
    let days = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs() / DAY_S);
    let (year, month, day) = civil(days);
    format!("{year:04}-{month:02}-{day:02}")
}

/// Year, month and day of a number of days after 1970-01-01, by the Gregorian calendar.
fn civil(days: u64) -> (u64, u64, u64) {
    let is_leap = |y: u64| (y.is_multiple_of(4) && !y.is_multiple_of(100)) || y.is_multiple_of(400);
    let (mut year, mut left) = (1970, days);
    while left >= 365 + u64::from(is_leap(year)) {
        left -= 365 + u64::from(is_leap(year));
        year += 1;
    }
    let february = 28 + u64::from(is_leap(year));
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31] {
        if left < length {
            break;
        }
        left -= length;
        month += 1;
    }
    (year, month, left + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_dates() {
        for (days, date) in [(0, (1970, 1, 1)), (59, (1970, 3, 1)), (11_016, (2000, 2, 29)), (20_779, (2026, 11, 22))] {
            assert_eq!(civil(days), date);
        }
    }
}
