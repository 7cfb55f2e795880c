//! Whether an image fits this machine's memory: found out before the work, not by falling over in it.

use crate::error::{Error, Result};
use std::path::Path;

/// Bytes a pixel that do not depend on the channels: visibility, picture, tables of tiles and pieces.
const FIXED_BYTES: u64 = 32;
/// Copies of a channel's four bytes alive at once: on the device, in a read-back buffer, joined, and being encoded.
const COPIES: u64 = 4;

/// Refuses an image of `width x height` pixels with `channels` planes, and `more` bytes a pixel, that is larger than the free memory.
///
/// # Errors
/// [`Error::Work`] that names the limit.
pub fn check(width: u32, height: u32, channels: usize, more: u64) -> Result<()> {
    match free() {
        Some(free) => fits((width, height), channels, more, free),
        None => Ok(()),
    }
}

/// Bytes that such an image takes.
pub fn need((width, height): (u32, u32), channels: usize, more: u64) -> u64 {
    u64::from(width) * u64::from(height) * (FIXED_BYTES + 4 * COPIES * channels as u64 + more)
}

fn fits((width, height): (u32, u32), channels: usize, more: u64, free: u64) -> Result<()> {
    let need = need((width, height), channels, more);
    if need <= free {
        return Ok(());
    }
    let gib = |bytes: u64| bytes as f64 / f64::from(1u32 << 30);
    let (need, free) = (gib(need), gib(free));
    let (and, fewer) = if more > 0 { (" and its samples", " or --samples") } else { ("", "") };
    Err(Error::work(format!(
        "an image of {width} x {height} with {channels} channels{and} takes about {need:.1} GiB of memory and {free:.1} GiB \
         are free; make it smaller or ask for fewer --channels{fewer}"
    )))
}

/// Free memory in bytes, the process group's own limit included; `None` where the system does not say.
pub fn free() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix("MemAvailable:"))?;
    let machine = 1024 * line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?;
    let number = |name: &str| {
        let text = std::fs::read_to_string(Path::new("/sys/fs/cgroup").join(name)).ok()?;
        text.trim().parse::<u64>().ok()
    };
    let group = number("memory.max").zip(number("memory.current")).map(|(most, now)| most.saturating_sub(now));
    Some(group.map_or(machine, |g| g.min(machine)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_image_larger_than_the_memory_is_refused_with_the_limit() {
        let free = 4 << 30;
        assert!(fits((800, 600), 10, 0, free).is_ok());
        let error = fits((65_536, 16_384), 10, 0, free).unwrap_err();
        assert!(error.exit_code() == 1 && error.to_string().contains("4.0 GiB are free"), "{error}");
        assert!(fits((4096, 4096), 10, 24, free).is_ok());
        let error = fits((4096, 4096), 10, 24 * 32, free).unwrap_err();
        assert!(error.to_string().contains("or --samples"), "{error}");
    }
}
