//! The command line: parse, run, exit code.
//!
//! 0: done; 1: the work failed; 2: the command line or an input file is wrong. An error is one line on stderr.

mod args;
mod batch;
mod camera;
mod compare;
mod diagram;
mod doctor;
mod example;
mod export;
mod info;
mod keep;
mod lab;
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
use args::{Cli, Command};
use clap::Parser;
use clap::error::{ContextKind, ErrorKind};
use say::complain;

#[cfg(feature = "internals")]
pub use info::lines as adapter_lines;
pub use say::print;
use std::ffi::OsString;
use std::panic::AssertUnwindSafe;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Runs the program on these arguments, its own name first; the exit code.
pub fn main(arguments: Vec<OsString>) -> u8 {
    let started = Instant::now();
    guarded(|| run(arguments, started))
}

/// Runs a program's work; the exit code. Errors and panics are printed to stderr, a line each.
pub fn guarded(work: impl FnOnce() -> Result<()>) -> u8 {
    say_panics_on_one_line();
    super::process::fit_arenas_to_address_space();
    #[cfg(unix)]
    signals::handle();
    match std::panic::catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => 0,
        Ok(Err(error)) => {
            complain(&error);
            error.exit_code()
        }
        // the hook has said what happened
        Err(_) => 1,
    }
}

/// Reads the command line of a program; `None` if only a text is printed: for `--help`, `--version`, or no command at all.
///
/// # Errors
/// [`Error::Input`] if the arguments are wrong.
pub fn parsed<P: Parser>(arguments: Vec<OsString>) -> Result<Option<P>> {
    match P::try_parse_from(arguments) {
        Ok(parsed) => Ok(Some(parsed)),
        Err(e) if matches!(e.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) => {
            print(&e.render().to_string()).map(|()| None)
        }
        // no command at all
        Err(e) if e.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            print(&P::command().render_help().to_string()).map(|()| None)
        }
        Err(e) => Err(Error::input(refusal::<P>(&e))),
    }
}

fn run(arguments: Vec<OsString>, started: Instant) -> Result<()> {
    lab::start_if_needed(&arguments)?;
    let Some(cli) = parsed::<Cli>(arguments)? else { return Ok(()) };
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
        Command::Bench(_) | Command::GpuReport(_) => Err(lab::missing()),
    }
}

/// What clap has to say, on one line and without the usage.
fn refusal<P: Parser>(e: &clap::Error) -> String {
    let text = e.render().to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    let said = text.split("\n\n").filter(|p| !p.starts_with("Usage:") && !p.starts_with("For more information"));
    let mut said: Vec<String> = said.map(one_line).filter(|p| !p.is_empty()).collect();
    if e.kind() == ErrorKind::InvalidSubcommand && e.get(ContextKind::SuggestedSubcommand).is_none() {
        let program = P::command();
        let known: Vec<&str> = program.get_subcommands().map(clap::Command::get_name).collect();
        said.push(format!("use one of {}; see {} --help", known.join(", "), program.get_name()));
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
