//! The command line: parse, run, exit code.
//!
//! 0: done; 1: the work failed; 2: the command line or an input file is wrong. An error is one line on stderr.

mod args;
mod batch;
mod bench;
mod camera;
mod compare;
mod diagram;
mod doctor;
mod example;
mod export;
mod gpu_report;
mod info;
mod keep;
mod kinds;
mod manual;
mod new;
mod pages;
mod povray;
mod progress;
mod project;
mod render;
mod say;
#[cfg(unix)]
mod signals;
mod splat;
#[cfg(feature = "view")]
mod view;

use crate::gpu::device::one_line;
use crate::input::{Error, Result};
use args::{Caps, Cli, Command};
use clap::CommandFactory;
use clap::Parser;
use clap::error::{ContextKind, ErrorKind};
use say::{complain, print};
use std::ffi::OsString;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Runs the program on these arguments, its own name first; the exit code.
pub fn main(arguments: Vec<OsString>) -> u8 {
    let started = Instant::now();
    say_panics_on_one_line();
    #[cfg(unix)]
    signals::remove_temporary_files_at_end();
    match std::panic::catch_unwind(|| run(arguments, started)) {
        Ok(Ok(())) => 0,
        Ok(Err(error)) => {
            complain(&error);
            error.exit_code()
        }
        // the hook has said what happened
        Err(_) => 1,
    }
}

fn run(arguments: Vec<OsString>, started: Instant) -> Result<()> {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(e) if matches!(e.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) => {
            return print(&e.render().to_string());
        }
        Err(e) => return Err(Error::input(refusal(&e))),
    };
    cli.command.caps().into_iter().for_each(Caps::apply);
    match &cli.command {
        Command::Render(args) => render::run(args, started),
        Command::Compare(args) => compare::run(args),
        Command::Camera(args) => camera::run(args),
        Command::Project(args) => project::run(args),
        Command::Splat(args) => splat::run(args),
        Command::Info(args) => info::run(args),
        #[cfg(feature = "view")]
        Command::View(args) => view::run(args),
        Command::Doctor => doctor::run(),
        Command::Example(args) => example::run(args),
        Command::New(args) => new::run(args),
        Command::Completions { shell } => manual::completions(*shell),
        Command::Schema => manual::schema(),
        Command::Man { out } => manual::pages(out),
        Command::Batch(args) => batch::run(args),
        Command::Bench(args) => bench::run(args),
        Command::GpuReport(args) => gpu_report::run(args, started),
    }
}

/// What clap has to say, on one line and without the usage.
fn refusal(e: &clap::Error) -> String {
    if e.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        return "no command given; see anamorph --help".into();
    }
    let text = e.render().to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    let said = text.split("\n\n").filter(|p| !p.starts_with("Usage:") && !p.starts_with("For more information"));
    let mut said: Vec<String> = said.map(one_line).filter(|p| !p.is_empty()).collect();
    if e.kind() == ErrorKind::InvalidSubcommand && e.get(ContextKind::SuggestedSubcommand).is_none() {
        let cli = Cli::command();
        let known: Vec<&str> = cli.get_subcommands().map(clap::Command::get_name).collect();
        said.push(format!("use one of {}; see anamorph --help", known.join(", ")));
    }
    said.join("; ")
}

/// Any panic is a defect of this program: one line, no backtrace, and only the first where several threads fall.
fn say_panics_on_one_line() {
    static SAID: AtomicBool = AtomicBool::new(false);
    std::panic::set_hook(Box::new(|panic| {
        if SAID.swap(true, Ordering::SeqCst) {
            return;
        }
        let payload = panic.payload();
        let text = payload.downcast_ref::<&str>().copied();
        let what = text.or(payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message");
        let place = panic.location().map(|l| format!(" at {}:{}", l.file(), l.line())).unwrap_or_default();
        complain(&Error::work(format!("internal error: {what}{place}; please report it")));
    }));
}
