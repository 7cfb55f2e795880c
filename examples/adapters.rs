//! `make test-adapters`: the built program renders every example on every software adapter of this machine and compares it with the
//! reference. No safe pixel may be wrong, and lavapipe's pictures are the same bytes at every width of its vectors. Arguments: the
//! program, and a folder for pictures and reports. After these may come the names of the examples that are rendered.
//!
//! Adapters: Mesa's lavapipe with vectors of 256, 128 and 512 bits; another Mesa, unpacked from its Debian package into the folder
//! `NEWER_MESA`; and SwiftShader as Debian's package `chromium` has it.

use anamorph::internals::input::{Error, Result};
use anamorph::internals::tools::example::EXAMPLES;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// SwiftShader's driver file, where Debian's chromium is installed.
const SWIFTSHADER: &str = "/usr/lib/chromium/vk_swiftshader_icd.json";

/// Examples whose size is their camera's.
const SIZED: [&str; 1] = ["fisheye"];

struct Adapter {
    name: String,
    environment: Vec<(&'static str, String)>,
    /// The adapter whose pictures are to be the same.
    same_as: Option<&'static str>,
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
    for adapter in adapters() {
        let started = Instant::now();
        let (mut right, mut own_faults) = (0, 0);
        for example in examples() {
            example.write(&folder)?;
            match render(&program, &folder, example.name, &adapter) {
                Ok(()) => right += 1,
                Err(text) => {
                    println!("{}, {}: {text}", adapter.name, example.name);
                    own_faults += 1;
                }
            }
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

fn adapters() -> Vec<Adapter> {
    let lavapipe = |bits: &str| Adapter {
        name: format!("lavapipe-{bits}"),
        environment: vec![("LP_NATIVE_VECTOR_WIDTH", bits.into())],
        same_as: (bits != "256").then_some("lavapipe-256"),
    };
    let mut list: Vec<Adapter> = ["256", "128", "512"].map(lavapipe).into();
    if let Some(mesa) = std::env::var_os("NEWER_MESA").map(PathBuf::from) {
        let within = |path: &str| mesa.join(path).display().to_string();
        list.push(Adapter {
            name: "newer-mesa".into(),
            environment: vec![
                ("VK_DRIVER_FILES", within("usr/share/vulkan/icd.d/lvp_icd.x86_64.json")),
                ("LD_LIBRARY_PATH", within("usr/lib/x86_64-linux-gnu")),
            ],
            same_as: None,
        });
    }
    if Path::new(SWIFTSHADER).exists() {
        list.push(Adapter {
            name: "swiftshader".into(),
            environment: vec![("VK_DRIVER_FILES", SWIFTSHADER.into())],
            same_as: None,
        });
    }
    list
}

/// Renders an example; the error says what is wrong with its picture.
fn render(program: &Path, folder: &Path, example: &str, adapter: &Adapter) -> std::result::Result<(), String> {
    let file = |adapter: &str, ending: &str| folder.join(format!("{example}-{adapter}.{ending}"));
    let (picture, report) = (file(&adapter.name, "exr"), file(&adapter.name, "json"));
    let mut command = Command::new(program);
    command.arg("render").arg(folder.join(format!("{example}.toml"))).arg("--check");
    command.arg("--exr").arg(&picture).arg("--report").arg(&report);
    if !SIZED.contains(&example) {
        command.args(["--size", "64x48"]);
    }
    let out = command.envs(adapter.environment.iter().cloned()).output().map_err(|e| e.to_string())?;
    if !out.status.success() {
        let text = String::from_utf8_lossy(&out.stderr);
        return Err(text.lines().last().unwrap_or("no word of what went wrong").to_owned());
    }
    let read = |path: &Path| std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()));
    let told: serde_json::Value = serde_json::from_slice(&read(&report)?).map_err(|e| e.to_string())?;
    match told["error"]["wrong_safe"].as_u64() {
        Some(0) => {}
        Some(wrong) => return Err(format!("{wrong} safe pixels are wrong")),
        None => return Err("the report does not say how many pixels are wrong".into()),
    }
    match adapter.same_as {
        Some(other) if read(&picture)? != read(&file(other, "exr"))? => Err(format!("not the bytes of {other}")),
        _ => Ok(()),
    }
}
