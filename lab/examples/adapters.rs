//! `make test-adapters`: the built program renders every example on every software adapter of this machine and compares it with the
//! reference. No safe pixel may be wrong, every other pixel must show a near candidate, and lavapipe's pictures are the same bytes at
//! every width of its vectors. Arguments: the program, and a folder for pictures and reports. After these may come the names of the
//! examples that are rendered. It prints a line for each picture.
//!
//! Adapters: Mesa's lavapipe with vectors of 256, 128 and 512 bits; another Mesa, unpacked from its Debian packages
//! (`mesa-vulkan-drivers` and the libraries it needs) into the folder `NEWER_MESA`; and SwiftShader as Debian's package `chromium` has it.

use anamorph::internals::input::{Error, Result};
use anamorph::internals::tools::example::EXAMPLES;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// SwiftShader's driver file, where Debian's chromium is installed.
const SWIFTSHADER: &str = "/usr/lib/chromium/vk_swiftshader_icd.json";

/// Where a Debian package has its drivers' files and its libraries.
const DRIVER_FILES: &str = "usr/share/vulkan/icd.d";
const LIBRARIES: &str = "usr/lib/x86_64-linux-gnu";

/// Examples whose size is their camera's.
const SIZED: [&str; 1] = ["fisheye"];

struct Adapter {
    name: String,
    /// A part of the name that the adapter tells.
    told: &'static str,
    environment: Vec<(&'static str, String)>,
    /// The adapter whose pictures are to be the same.
    same_as: Option<&'static str>,
    /// The adapter whose driver is to be another.
    other_than: Option<&'static str>,
}

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let use_it = || Error::input("use: adapters PROGRAM FOLDER [EXAMPLE ...]");
    let program = PathBuf::from(arguments.next().ok_or_else(use_it)?);
    let folder = PathBuf::from(arguments.next().ok_or_else(use_it)?);
    let asked: Vec<String> = arguments.collect();
    let examples = || EXAMPLES.iter().filter(|e| asked.is_empty() || asked.iter().any(|name| name == e.name));
    std::fs::create_dir_all(&folder).map_err(|e| Error::work(format!("{}: {e}", folder.display())))?;
    let mut faults = 0;
    for adapter in adapters()? {
        let started = Instant::now();
        let (mut right, mut own_faults) = (0, 0);
        for example in examples() {
            example.write(&folder)?;
            let start = Instant::now();
            let result = render(&program, &folder, example.name, &adapter);
            let text = match &result {
                Ok(()) => "right",
                Err(text) => text,
            };
            println!("{}, {}: {text}, {:.0} s", adapter.name, example.name, start.elapsed().as_secs_f64());
            *(if result.is_ok() { &mut right } else { &mut own_faults }) += 1;
        }
        let seconds = started.elapsed().as_secs();
        println!("{}: {right} examples right, {own_faults} not, {seconds} s", adapter.name);
        faults += own_faults;
    }
    if faults > 0 {
        return Err(Error::work(format!("{faults} pictures are wrong or missing")));
    }
    Ok(())
}

fn adapters() -> Result<Vec<Adapter>> {
    let lavapipe = |bits: &str| Adapter {
        name: format!("lavapipe-{bits}"),
        told: "llvmpipe",
        environment: vec![("LP_NATIVE_VECTOR_WIDTH", bits.into())],
        same_as: (bits != "256").then_some("lavapipe-256"),
        other_than: None,
    };
    let mut list: Vec<Adapter> = ["256", "128", "512"].map(lavapipe).into();
    if let Some(mesa) = std::env::var_os("NEWER_MESA").map(PathBuf::from) {
        list.push(Adapter {
            name: "newer-mesa".into(),
            told: "llvmpipe",
            environment: vec![
                ("VK_DRIVER_FILES", lavapipe_file(&mesa.join(DRIVER_FILES))?.display().to_string()),
                ("LD_LIBRARY_PATH", mesa.join(LIBRARIES).display().to_string()),
            ],
            same_as: None,
            other_than: Some("lavapipe-256"),
        });
    }
    if Path::new(SWIFTSHADER).exists() {
        list.push(Adapter {
            name: "swiftshader".into(),
            told: "SwiftShader",
            environment: vec![("VK_DRIVER_FILES", SWIFTSHADER.into())],
            same_as: None,
            other_than: None,
        });
    }
    Ok(list)
}

/// Lavapipe's driver file in a folder: its name is `lvp_icd.json`, or has the architecture in it.
fn lavapipe_file(folder: &Path) -> Result<PathBuf> {
    let missing = |why: &dyn std::fmt::Display| Error::work(format!("NEWER_MESA: {}: {why}", folder.display()));
    let mut files = std::fs::read_dir(folder).map_err(|e| missing(&e))?.filter_map(|entry| Some(entry.ok()?.path()));
    let is_lavapipe =
        |file: &PathBuf| file.file_name().is_some_and(|name| name.to_string_lossy().starts_with("lvp_icd"));
    files.find(is_lavapipe).ok_or_else(|| missing(&"no lvp_icd*.json"))
}

/// Renders an example; the error says what is wrong with its picture.
fn render(program: &Path, folder: &Path, example: &str, adapter: &Adapter) -> std::result::Result<(), String> {
    let file = |adapter: &str, ending: &str| folder.join(format!("{example}-{adapter}.{ending}"));
    let (picture, report) = (file(&adapter.name, "exr"), file(&adapter.name, "json"));
    let mut command = Command::new(program);
    command.arg("render").arg(folder.join(format!("{example}.toml"))).arg("--check");
    command.args(["--adapter", adapter.told]).arg("--exr").arg(&picture).arg("--report").arg(&report);
    if !SIZED.contains(&example) {
        command.args(["--size", "64x48"]);
    }
    let out = command.envs(adapter.environment.iter().cloned()).output().map_err(|e| e.to_string())?;
    if !out.status.success() {
        let text = String::from_utf8_lossy(&out.stderr);
        return Err(text.lines().last().unwrap_or("no word of what went wrong").to_owned());
    }
    let read = |path: &Path| std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()));
    let told = |report: &Path| serde_json::from_slice::<Value>(&read(report)?).map_err(|e| e.to_string());
    let own = told(&report)?;
    if own["engine"] != "compute" {
        return Err(format!("the adapter did not render, but {}", own["engine"]));
    }
    let other = adapter.other_than.map(|other| told(&file(other, "json"))).transpose()?;
    if other.is_some_and(|other| other["driver"] == own["driver"]) {
        return Err(format!("the same driver as before: {}", own["driver"]));
    }
    for (key, what) in [("wrong_safe", "safe pixels are wrong"), ("not_near", "pixels show no near candidate")] {
        match own["error"][key].as_u64() {
            Some(0) => {}
            Some(count) => return Err(format!("{count} {what}")),
            None => return Err(format!("the report does not tell {key}")),
        }
    }
    match adapter.same_as {
        Some(other) if read(&picture)? != read(&file(other, "exr"))? => Err(format!("not the bytes of {other}")),
        _ => Ok(()),
    }
}
