//! The laboratory's program `anamorph-lab`: it runs `anamorph bench` and `gpu-report`, and renders by its techniques (`--engine NAME`).

use crate::engine::rival;
use crate::input::{Error, Result};
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;
use std::process::Command;

/// The program's name, without the ending of executables.
const PROGRAM: &str = "anamorph-lab";

const COMMANDS: [&str; 2] = ["bench", "gpu-report"];

/// Hands a command line that only the laboratory can run on to its program, and ends with that program's exit code. Returns when this
/// is the laboratory's program, or when it is not installed.
///
/// # Errors
/// [`Error::Work`] if the program is there and does not start.
pub fn start_if_needed(arguments: &[OsString]) -> Result<()> {
    if !rival::techniques().is_empty() || !is_needed(arguments) {
        return Ok(());
    }
    match program() {
        Some(path) => start(Command::new(&path).args(&arguments[1..]))
            .map_err(|e| Error::work(format!("cannot start {}: {e}", path.display()))),
        None => Ok(()),
    }
}

/// The error for a command of the laboratory where its program is not installed.
pub fn missing() -> Error {
    Error::input(format!(
        "this command is run by {PROGRAM}, which is neither beside anamorph nor on the path; {INSTALL}"
    ))
}

/// How to install the laboratory.
const INSTALL: &str = "install it from a clone of anamorph: cargo install --path lab --locked";

/// Whether a command line is the laboratory's: one of its commands, or a render by an engine that this program does not know.
fn is_needed(arguments: &[OsString]) -> bool {
    let Some(command) = arguments.get(1) else { return false };
    let engine = |pair: &[OsString]| {
        let value = pair[0].to_str().and_then(|flag| flag.strip_prefix("--engine="));
        let value = value.map(OsStr::new).or((pair[0] == "--engine").then_some(pair.get(1)?.as_os_str()));
        value.map(|name| name != "compute" && name != "reference")
    };
    let names_another = || (2..arguments.len()).any(|k| engine(&arguments[k..]).unwrap_or(false));
    COMMANDS.iter().any(|own| command == own) || (command == "render" && names_another())
}

/// The path of the program: beside this one, else on the path.
fn program() -> Option<PathBuf> {
    let name = format!("{PROGRAM}{}", std::env::consts::EXE_SUFFIX);
    let beside = std::env::current_exe().ok().map(|own| own.with_file_name(&name));
    let on_path = std::env::var_os("PATH").unwrap_or_default();
    let on_path = std::env::split_paths(&on_path).map(|folder| folder.join(&name)).collect::<Vec<_>>();
    beside.into_iter().chain(on_path).find(|path| path.is_file())
}

/// Replaces this process by the command; returns only if that fails.
#[cfg(unix)]
fn start(command: &mut Command) -> std::io::Result<()> {
    use std::os::unix::process::CommandExt;
    Err(command.exec())
}

/// Runs the command and ends with its exit code; returns only if it does not start.
#[cfg(not(unix))]
fn start(command: &mut Command) -> std::io::Result<()> {
    let status = command.status()?;
    std::process::exit(status.code().unwrap_or(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_laboratory_runs_its_commands_and_unknown_engines_alone() {
        let needed = |line: &str| is_needed(&line.split(' ').map(OsString::from).collect::<Vec<_>>());
        for line in [
            "anamorph bench papers --quick",
            "anamorph gpu-report",
            "anamorph render a.toml --engine raytrace",
            "anamorph render --engine=raytrace a.toml",
        ] {
            assert!(needed(line), "{line}");
        }
        for line in [
            "anamorph",
            "anamorph render bench",
            "anamorph render a.toml --engine reference",
            "anamorph render a.toml --engine=compute",
            "anamorph render a.toml --engine",
            "anamorph project a.toml --engine raytrace",
        ] {
            assert!(!needed(line), "{line}");
        }
    }
}
