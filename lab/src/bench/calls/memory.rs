//! The largest resident memory of this process, as Linux counts it.

/// Begins to count anew from the present memory; elsewhere than on Linux nothing happens.
pub fn forget_peak() {
    // where it cannot be written the peak is that of the whole process
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// The peak, bytes; `None` elsewhere than on Linux.
pub fn peak_bytes() -> Option<u64> {
    peak_in(&std::fs::read_to_string("/proc/self/status").ok()?)
}

/// The peak in a process's status.
fn peak_in(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kibibytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_read_in_bytes() {
        assert_eq!(peak_in("Name:\tx\nVmPeak:\t  900 kB\nVmHWM:\t     516 kB\n"), Some(516 * 1024));
        assert_eq!(peak_in("Name:\tx\n"), None);
    }
}
