//! Provenance of results.

use anamorph::internals::engine::Engine;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::process::Command;
use std::time::SystemTime;

/// Context of a row: date, machine, adapter, commit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Year, month, day, UTC.
    pub date: String,
    pub adapter: String,
    pub driver: String,
    /// Whether the adapter is a software one.
    pub is_software: bool,
    pub cores: usize,
    pub version: String,
    /// Commit of the source in the working folder, if it is a checkout.
    pub commit: Option<String>,
    /// Without `--case`, `--resume` and `--out`: a run may be made case by case, and anywhere. Programs are named without their folder.
    pub command: String,
    pub quick: bool,
}

impl Provenance {
    pub fn now(engine: &Engine, quick: bool) -> Provenance {
        let info = &engine.gpu.info;
        Provenance {
            date: today(),
            adapter: info.name.clone(),
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            is_software: info.device_type == wgpu::DeviceType::Cpu,
            cores: std::thread::available_parallelism().map_or(1, |n| n.get()),
            version: env!("CARGO_PKG_VERSION").into(),
            commit: commit(),
            command: command(std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned())),
            quick,
        }
    }

    /// The adapter as a part of a file's name.
    pub fn short_adapter(&self) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
        self.adapter.split(['(', ',']).next().unwrap_or("").trim().chars().map(plain).collect()
    }

    /// Whether both are by one version of the program on one adapter and driver.
    pub fn is_by_the_same(&self, other: &Provenance) -> bool {
        (&self.version, &self.adapter, &self.driver) == (&other.version, &other.adapter, &other.driver)
    }

    /// A caveat for figures of such an adapter.
    pub fn fairness(&self) -> &'static str {
        if self.is_software {
            "A software adapter: rasterization and compute kernels both run on the CPU's cores, on a machine that others may use. \
             Ratios of one run mean something, times little; no figure of a GPU compares."
        } else if ["H100", "H200", "A100", "B200", "GH200"].iter().any(|chip| self.adapter.contains(chip)) {
            "This chip is made for computing and has few raster units: compute kernels are far faster on it than fragment work. Ratios to rivals \
             that draw are larger here than on a chip for graphics."
        } else {
            "Rasterization is the adapter's own hardware; compute kernels are this program's."
        }
    }
}

fn command(mut arguments: impl Iterator<Item = String>) -> String {
    let mut text = "anamorph".to_owned();
    while let Some(argument) = arguments.next() {
        let (name, own) = argument.split_once('=').map_or((&*argument, None), |(name, value)| (name, Some(value)));
        let mut value = || own.map(str::to_owned).or_else(|| arguments.next()).unwrap_or_default();
        match name {
            "--case" | "--out" => drop(value()),
            "--resume" => {}
            "--yardstick" => {
                let program = PathBuf::from(value());
                text += &format!(" --yardstick {}", program.file_name().unwrap_or_default().to_string_lossy());
            }
            _ => text += &format!(" {argument}"),
        }
    }
    text
}

/// The commit that is checked out, `-dirty` where more than results differs from it. Elsewhere what `ANAMORPH_COMMIT` said when this program
/// was built: it may run where it was carried alone.
fn commit() -> Option<String> {
    checked_out().or_else(|| option_env!("ANAMORPH_COMMIT").map(str::to_owned))
}

fn checked_out() -> Option<String> {
    let git = |args: &[&str]| {
        let output = Command::new("git").args(args).output().ok().filter(|o| o.status.success())?;
        Some(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let changed = git(&["status", "--porcelain", "--", ":/", ":(top,exclude)bench_results"])?;
    let dirty = if changed.is_empty() { "" } else { "-dirty" };
    Some(git(&["describe", "--always"])? + dirty)
}

fn today() -> String {
    // the date before the time of day
    humantime::format_rfc3339_seconds(SystemTime::now()).to_string().chars().take_while(|c| *c != 'T').collect()
}

#[cfg(test)]
mod tests {
    use super::command;

    #[test]
    fn a_command_is_that_of_the_whole_run() {
        let of = |line: &str| command(line.split(' ').map(str::to_owned));
        assert_eq!(
            of("bench papers --case Yu --yardstick /opt/peer --out=runs --runs 9"),
            "anamorph bench papers --yardstick peer --runs 9"
        );
    }
}
