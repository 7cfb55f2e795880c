//! The program `anamorph-lab`: the commands `bench` and `gpu-report`, and every command of `anamorph`, whose `--engine` and viewer offer
//! the laboratory's techniques.

use anamorph::internals::engine::rival;
use anamorph::internals::tools::cli::{guarded, parsed};
use anamorph::{ExitWhenFull, Result};
use anamorph_lab::{bench, gpu_report, rivals};
use clap::{Parser, Subcommand};
use std::ffi::OsString;
use std::process::ExitCode;
use std::time::Instant;

#[global_allocator]
static ALLOCATOR: ExitWhenFull = ExitWhenFull;

/// Compares anamorph with other techniques, and measures it. Runs every command of anamorph too: see anamorph --help.
#[derive(Debug, Parser)]
#[command(name = "anamorph-lab", version, disable_help_subcommand = true)]
struct Lab {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Measure error against run time, of this engine and of its rivals
    Bench(bench::Args),
    /// Test and measure this machine's GPU for some minutes, into a folder to send to the developers
    GpuReport(gpu_report::Args),
}

/// The arguments that this program reads itself; all others are commands of `anamorph`.
const OWN: [&str; 6] = ["bench", "gpu-report", "--help", "-h", "--version", "-V"];

fn main() -> ExitCode {
    let started = Instant::now();
    anamorph::keep_window_system_quiet();
    rival::register(rivals::TECHNIQUES);
    let arguments: Vec<OsString> = std::env::args_os().collect();
    let is_own = arguments.get(1).is_none_or(|first| OWN.iter().any(|own| first == own));
    let code = if is_own { guarded(|| run(arguments, started)) } else { anamorph::program(arguments) };
    ExitCode::from(code)
}

fn run(arguments: Vec<OsString>, started: Instant) -> Result<()> {
    match parsed::<Lab>(arguments)?.map(|lab| lab.command) {
        Some(Command::Bench(args)) => bench::command::run(&args),
        Some(Command::GpuReport(args)) => gpu_report::command::run(&args, started),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_flags_fit_together() {
        Lab::command().debug_assert();
    }
}
