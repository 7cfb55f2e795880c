//! `anamorph doctor`: what works on this machine, and what to install for what does not.

use super::say::print;
use crate::gpu::GpuOptions;
use crate::gpu::device::{AdapterFeatures, adapters};
use crate::gpu::needs::lacks;
use crate::input::Limits;
use crate::input::{Error, Result};
use crate::tools::self_test::{Tester, views};
use std::fmt;
use std::path::Path;
use std::time::Instant;

/// One thing that was looked at.
#[derive(Debug, PartialEq)]
struct Finding {
    mark: Mark,
    says: String,
    /// What to do about it.
    advice: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mark {
    Good,
    /// Pictures are right, but take longer.
    Slow,
    Wrong,
}

fn good(says: impl Into<String>) -> Finding {
    Finding { mark: Mark::Good, says: says.into(), advice: None }
}

fn slow(says: impl Into<String>, advice: impl Into<String>) -> Finding {
    Finding { mark: Mark::Slow, says: says.into(), advice: Some(advice.into()) }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let mark = match self.mark {
            Mark::Good => "good",
            Mark::Slow => "slow",
            Mark::Wrong => "WRONG",
        };
        writeln!(f, "{mark:<6}{}", self.says)?;
        self.advice.iter().try_for_each(|advice| writeln!(f, "      -> {advice}"))
    }
}

pub fn run() -> Result<()> {
    let mut findings = vec![program(), free_memory()];
    let adapters: Vec<Seen> = adapters().iter().map(Seen::of).collect();
    findings.extend(of_adapters(&adapters, &Machine::this()));
    findings.push(first_picture(adapters.first().is_some_and(|a| a.lack.is_none())));
    print(&findings.iter().map(Finding::to_string).collect::<String>())?;
    match findings.iter().filter(|f| f.mark == Mark::Wrong).count() {
        0 => Ok(()),
        n => Err(Error::work(format!("{n} of {} things do not work; see above", findings.len()))),
    }
}

fn program() -> Finding {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let (os, arch, version) = (std::env::consts::OS, std::env::consts::ARCH, env!("CARGO_PKG_VERSION"));
    good(format!("anamorph {version} on {os}, {arch}, {cores} cores"))
}

fn free_memory() -> Finding {
    let Some(free) = Limits::default().free_memory() else { return good("free memory: the system does not say") };
    let says = format!("{:.1} GB of memory free", free as f64 / 1e9);
    if free >= LITTLE {
        good(says)
    } else {
        slow(says, "large scenes will be refused; close other programs, or use --memory")
    }
}

/// Bytes that a scene of some million triangles takes.
const LITTLE: u64 = 2_000_000_000;

/// An adapter that a driver offers.
struct Seen {
    name: String,
    is_software: bool,
    f64: bool,
    atomics64: bool,
    /// Why the kernels cannot run.
    lack: Option<String>,
}

impl Seen {
    fn of(adapter: &wgpu::Adapter) -> Seen {
        let (info, limits) = (adapter.get_info(), adapter.limits());
        let has = AdapterFeatures::of(adapter.features(), &info, &limits);
        Seen {
            name: format!("{} ({})", info.name, info.backend),
            is_software: has.software,
            f64: has.f64,
            atomics64: has.atomics64,
            lack: lacks(&limits).map(|lack| lack.to_string()),
        }
    }
}

/// What the system shows of its devices and drivers.
#[derive(Debug, Default)]
struct Machine {
    /// Linux: an NVIDIA device, and any other GPU's device.
    nvidia: bool,
    render_node: bool,
    /// It is there, but this user may not open it.
    render_node_closed: bool,
    /// Of VK_DRIVER_FILES or VK_ICD_FILENAMES: files that are not there.
    missing_drivers: Vec<String>,
    /// ID and ID_LIKE of /etc/os-release.
    distribution: String,
}

impl Machine {
    fn this() -> Machine {
        let nodes = || std::fs::read_dir("/dev/dri").into_iter().flatten().flatten().map(|entry| entry.path());
        let render = |path: &Path| path.file_name().is_some_and(|n| n.to_string_lossy().starts_with("renderD"));
        let open = |path: &Path| std::fs::OpenOptions::new().read(true).write(true).open(path).is_ok();
        let named = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].into_iter().find_map(|name| std::env::var(name).ok());
        let release = std::fs::read_to_string("/etc/os-release").unwrap_or_default();
        let ids = release.lines().filter_map(|l| l.strip_prefix("ID=").or(l.strip_prefix("ID_LIKE=")));
        Machine {
            nvidia: Path::new("/dev/nvidiactl").exists(),
            render_node: nodes().any(|path| render(&path)),
            render_node_closed: nodes().any(|path| render(&path) && !open(&path)),
            missing_drivers: named
                .iter()
                .flat_map(|files| files.split(':'))
                .filter(|file| !file.is_empty() && !Path::new(file).exists())
                .map(str::to_owned)
                .collect(),
            distribution: ids.map(|id| id.replace('"', " ")).collect::<Vec<_>>().join(" "),
        }
    }

    /// How Mesa's drivers are installed, the software one too.
    fn install_mesa(&self) -> &'static str {
        let is = |names: &[&str]| self.distribution.split_whitespace().any(|id| names.contains(&id));
        match () {
            () if cfg!(target_vendor = "apple") => "Metal comes with macOS: update it",
            () if cfg!(windows) => "install the driver of the GPU's maker",
            () if is(&["debian", "ubuntu"]) => "apt-get install mesa-vulkan-drivers libvulkan1",
            () if is(&["fedora", "rhel"]) => "dnf install mesa-vulkan-drivers vulkan-loader",
            () if is(&["arch"]) => "pacman -S vulkan-icd-loader vulkan-swrast, and vulkan-radeon or vulkan-intel",
            () if is(&["suse", "opensuse"]) => {
                "zypper install libvulkan1 libvulkan_lvp, and libvulkan_radeon or libvulkan_intel"
            }
            () if is(&["alpine"]) => {
                "apk add vulkan-loader mesa-vulkan-swrast, and mesa-vulkan-ati or mesa-vulkan-intel"
            }
            () => "install the Vulkan loader and Mesa's Vulkan drivers",
        }
    }

    /// Why no GPU is among the adapters, as far as it can be seen.
    fn advice(&self) -> String {
        if !self.missing_drivers.is_empty() {
            let files = self.missing_drivers.join(", ");
            return format!(
                "VK_DRIVER_FILES or VK_ICD_FILENAMES names {files}, which is not there: correct or unset it"
            );
        }
        if self.nvidia {
            return "the NVIDIA GPU has no Vulkan driver here: install the driver's graphics part (Debian, Ubuntu: libnvidia-gl of \
                    the driver's version); in a container, run it with NVIDIA_DRIVER_CAPABILITIES=all and install libvulkan1"
                .into();
        }
        if self.render_node_closed {
            return "a GPU is there, but this user may not use it: usermod -aG render,video USER, and log in again; in a \
                    container: --device /dev/dri"
                .into();
        }
        if self.render_node {
            format!("a GPU is there, its driver is not: {}", self.install_mesa())
        } else {
            self.install_mesa().into()
        }
    }
}

fn of_adapters(adapters: &[Seen], machine: &Machine) -> Vec<Finding> {
    let Some(first) = adapters.first() else {
        return vec![slow("no adapter: pictures come from the CPU, by the reference", machine.advice())];
    };
    let mut findings = Vec::new();
    for (k, Seen { name, is_software, f64, atomics64, lack }) in adapters.iter().enumerate() {
        let chosen = if k == 0 { ", chosen by default" } else { "" };
        findings.push(match lack {
            Some(lack) => {
                slow(format!("{name}: cannot run the kernels: {lack}"), "use another adapter or --engine reference")
            }
            None if *is_software => good(format!("{name}: a CPU that does as a GPU would{chosen}")),
            None if *f64 && *atomics64 => good(format!("{name}{chosen}")),
            None => good(format!("{name}{chosen}; what it lacks ({}) is emulated", lacking(*f64, *atomics64))),
        });
    }
    let is_there = machine.nvidia || machine.render_node;
    if first.is_software && is_there {
        findings.push(slow("a GPU is there, but no driver offers it", machine.advice()));
    } else if first.is_software {
        findings.push(slow(
            "no GPU: pictures are the same, and take longer",
            "a GPU with a Vulkan driver, if there is one",
        ));
    }
    findings
}

fn lacking(f64: bool, atomics64: bool) -> String {
    [(f64, "f64"), (atomics64, "64-bit atomics")].iter().filter(|w| !w.0).map(|w| w.1).collect::<Vec<_>>().join(", ")
}

/// A picture by the default adapter against the reference.
fn first_picture(has_adapter: bool) -> Finding {
    if !has_adapter {
        return good("the CPU needs nothing: anamorph render works");
    }
    let started = Instant::now();
    let tested = Tester::new(&GpuOptions::default()).test(&views()[0]);
    let (wrong, failed) = (tested.wrong, tested.failed.as_ref());
    let bad = |says: String| Finding {
        mark: Mark::Wrong,
        says,
        advice: Some(
            "update the driver, or render with --engine reference; anamorph gpu-report makes a folder to send to us"
                .into(),
        ),
    };
    match (failed, wrong) {
        (Some(reason), _) => bad(format!("a first picture failed: {reason}")),
        (None, 0) => {
            let [width, height] = tested.size;
            good(format!(
                "a first picture, {width} x {height}: right at every pixel, in {:.1} s",
                started.elapsed().as_secs_f64()
            ))
        }
        (None, wrong) => bad(format!("a first picture has {wrong} wrong pixels")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(name: &str, is_software: bool) -> Seen {
        Seen { name: name.into(), is_software, f64: true, atomics64: true, lack: None }
    }

    fn said(adapters: &[Seen], machine: &Machine) -> String {
        of_adapters(adapters, machine).iter().map(Finding::to_string).collect()
    }

    #[test]
    fn what_is_missing_is_told_with_what_to_install() {
        let debian = || Machine { distribution: "debian".into(), ..Default::default() };
        let cpu = seen("llvmpipe", true);
        if cfg!(target_os = "linux") {
            assert!(said(&[], &debian()).contains("-> apt-get install mesa-vulkan-drivers"));
            let fedora = Machine { distribution: "nobara fedora".into(), render_node: true, ..Default::default() };
            assert!(said(std::slice::from_ref(&cpu), &fedora).contains("its driver is not: dnf install"));
        }
        let nvidia = Machine { nvidia: true, ..debian() };
        assert!(said(std::slice::from_ref(&cpu), &nvidia).contains("NVIDIA_DRIVER_CAPABILITIES=all"));
        let closed = Machine { render_node: true, render_node_closed: true, ..debian() };
        assert!(said(std::slice::from_ref(&cpu), &closed).contains("usermod -aG render"));
        let misnamed = Machine { missing_drivers: vec!["/no/icd.json".into()], nvidia: true, ..debian() };
        assert!(said(&[], &misnamed).contains("/no/icd.json, which is not there"));
        assert!(said(&[cpu], &debian()).contains("slow  no GPU"));
    }

    #[test]
    fn a_gpu_is_good_and_what_it_lacks_is_told() {
        let machine = Machine { nvidia: true, ..Default::default() };
        assert_eq!(said(&[seen("A GPU", false)], &machine), "good  A GPU, chosen by default\n");
        let less = Seen { f64: false, ..seen("A GPU", false) };
        assert!(said(&[less], &machine).contains("(f64) is emulated"));
        let small = Seen { lack: Some("too few buffers".into()), ..seen("A GPU", false) };
        assert!(said(&[small], &machine).contains("cannot run the kernels: too few buffers"));
    }
}
