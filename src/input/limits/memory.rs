//! The limit on memory: the free memory, or what the user grants. Work that needs more is refused before it allocates.

use super::Limits;
use crate::input::{Error, Result};
use std::path::{Path, PathBuf};

/// The end of each message about memory.
pub(in crate::input) const ADVICE: &str = "or use --memory or --no-limits";

/// Work of fewer bytes is not refused, unless the user grants a number.
const ASKED_FROM: u64 = 1 << 20;

impl Limits {
    /// Bytes that may still be allocated: the rest of what is granted; or else the least of what the machine, the control
    /// group and the process's address space have left. `None` if the system does not say.
    pub(crate) fn free_memory(self) -> Option<u64> {
        match self.memory {
            None => free_here(),
            Some(granted) => Some(granted.saturating_sub(status("VmRSS:").unwrap_or(0))),
        }
    }

    /// Refuses work that takes about `bytes` if fewer are free. `what` is the work, and `advice` how to make it smaller.
    ///
    /// # Errors
    /// [`Error::Work`] with both numbers.
    pub(crate) fn check_memory(self, bytes: u64, what: impl std::fmt::Display, advice: &str) -> Result<()> {
        // asking the system takes longer than using so little
        if bytes < ASKED_FROM && self.memory.is_none() {
            return Ok(());
        }
        match self.free_memory() {
            Some(free) if bytes > free && !self.are_lifted => Err(too_large(bytes, free, what, advice)),
            _ => Ok(()),
        }
    }
}

fn too_large(bytes: u64, free: u64, what: impl std::fmt::Display, advice: &str) -> Error {
    let gib = |bytes: u64| bytes as f64 / f64::from(1u32 << 30);
    let (need, free) = (gib(bytes), gib(free));
    Error::work(format!("{what} takes about {need:.1} GiB of memory and {free:.1} GiB are free; {advice}, {ADVICE}"))
}

fn free_here() -> Option<u64> {
    let machine = field(&std::fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable:")?;
    let groups = std::fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let in_groups =
        control_groups(&groups).iter().filter_map(|(folder, version)| free_in_group(folder, *version)).min();
    Some([in_groups, free_addresses()].into_iter().flatten().fold(machine, u64::min))
}

/// The two kinds of control groups of Linux.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Version {
    V1,
    V2,
}

/// The folders of the control groups that limit a process's memory, by its `/proc/self/cgroup`: the process's own group and all groups
/// around it. A container may show its own group as the outermost one.
fn control_groups(text: &str) -> Vec<(PathBuf, Version)> {
    let mut folders = Vec::new();
    for line in text.lines() {
        let mut fields = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (fields.next(), fields.next()) else { continue };
        let (root, version) = match controllers {
            "" => ("/sys/fs/cgroup", Version::V2),
            list if list.split(',').any(|name| name == "memory") => ("/sys/fs/cgroup/memory", Version::V1),
            _ => continue,
        };
        for group in Path::new(path.trim_start_matches('/')).ancestors() {
            folders.push((Path::new(root).join(group), version));
        }
    }
    folders
}

/// Bytes that a control group may still allocate; `None` without a limit.
fn free_in_group(folder: &Path, version: Version) -> Option<u64> {
    let text = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
    let number = |name: &str| text(name)?.trim().parse::<u64>().ok();
    let [most, used] = match version {
        Version::V1 => ["memory.limit_in_bytes", "memory.usage_in_bytes"],
        Version::V2 => ["memory.max", "memory.current"],
    };
    let most = number(most)?;
    // pages of files that were read or written count as used, and are given back when memory is needed
    let files = text("memory.stat").map_or(0, |stat| file_pages(&stat, version));
    Some(most.saturating_sub(number(used)?.saturating_sub(files)))
}

/// Bytes of the pages of files, by a control group's `memory.stat`. Pages without a file on disk (`shmem`) are not among them.
fn file_pages(stat: &str, version: Version) -> u64 {
    let keys = match version {
        Version::V1 => ["total_active_file", "total_inactive_file"],
        Version::V2 => ["active_file", "inactive_file"],
    };
    let lines = stat.lines().filter_map(|line| line.split_once(' '));
    lines.filter(|(key, _)| keys.contains(key)).filter_map(|(_, n)| n.parse::<u64>().ok()).sum()
}

/// The limit of the process's address space in bytes (`ulimit -v`); `None` without a limit.
pub(crate) fn address_space() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/limits").ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// Bytes that are left of the process's address space; `None` without a limit.
pub(crate) fn free_addresses() -> Option<u64> {
    address_space().zip(status("VmSize:")).map(|(most, now)| most.saturating_sub(now))
}

fn status(key: &str) -> Option<u64> {
    field(&std::fs::read_to_string("/proc/self/status").ok()?, key)
}

/// The value of the line `KEY N kB`, in bytes.
fn field(text: &str, key: &str) -> Option<u64> {
    let line = text.lines().find_map(|l| l.strip_prefix(key))?;
    Some(1024 * line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_that_is_too_large_is_refused_with_both_numbers() {
        let error = too_large(6 << 30, 4 << 30, "a mesh of 7 triangles", "use fewer");
        assert_eq!(
            error.to_string(),
            "a mesh of 7 triangles takes about 6.0 GiB of memory and 4.0 GiB are free; use fewer, or use --memory or \
             --no-limits"
        );
        assert_eq!(error.exit_code(), 1);
    }

    #[test]
    fn a_budget_is_less_what_the_process_uses() {
        let budget = Limits::default().memory(1 << 10);
        let error = budget.check_memory(1 << 11, "work", "do less").unwrap_err();
        let free = if cfg!(target_os = "linux") { Some(0) } else { Some(1 << 10) };
        assert_eq!(budget.free_memory(), free);
        assert!(error.to_string().starts_with("work takes about 0.0 GiB"), "{error}");
        assert!(Limits::none().memory(1 << 10).check_memory(1 << 11, "work", "do less").is_ok());
    }

    #[test]
    fn pages_of_files_are_not_used_up() {
        let stat =
            "anon 1000\nfile 700\nshmem 100\ninactive_anon 5\nactive_anon 6\ninactive_file 400\nactive_file 200\n";
        assert_eq!((file_pages(stat, Version::V2), file_pages("", Version::V2)), (600, 0));
        let with_children = "active_file 200\ninactive_file 400\ntotal_inactive_file 4000\ntotal_active_file 2000\n";
        assert_eq!(file_pages(with_children, Version::V1), 6000);
    }

    #[test]
    fn all_control_groups_around_a_process_count() {
        let path = |text: &str| PathBuf::from(text);
        let inner = control_groups("0::/user.slice/job\n");
        let outer = ["/sys/fs/cgroup/user.slice/job", "/sys/fs/cgroup/user.slice", "/sys/fs/cgroup"];
        assert_eq!(inner, outer.map(|folder| (path(folder), Version::V2)));
        let first = control_groups("5:cpu,cpuacct:/a\n4:memory:/a\n0::/\n");
        let memory = ["/sys/fs/cgroup/memory/a", "/sys/fs/cgroup/memory"].map(|folder| (path(folder), Version::V1));
        assert_eq!(first, [&memory[..], &[(path("/sys/fs/cgroup"), Version::V2)]].concat());
        assert!(control_groups("").is_empty());
    }

    /// Notices a limit that is read wrongly.
    #[test]
    fn a_group_has_left_what_its_files_say() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("memory.current", "700\n");
        write("memory.max", "max\n");
        assert_eq!(free_in_group(folder.path(), Version::V2), None);
        write("memory.max", "1000\n");
        write("memory.stat", "inactive_file 100\n");
        assert_eq!(free_in_group(folder.path(), Version::V2), Some(400));
        write("memory.limit_in_bytes", "900\n");
        write("memory.usage_in_bytes", "950\n");
        assert_eq!(free_in_group(folder.path(), Version::V1), Some(0));
    }

    #[test]
    fn linux_says_how_much_memory_is_free() {
        if cfg!(target_os = "linux") {
            assert!(free_here().is_some_and(|bytes| bytes > 1 << 20));
            assert!(status("VmRSS:").is_some_and(|bytes| bytes > 1 << 20));
        }
    }
}
