//! `anamorph completions`, `anamorph man` and `anamorph schema`: what shells, `man` and editors know of the command line and of scene files.

use super::args::Cli;
use super::say::print;
use crate::input::{Error, Result};
use crate::tools::schema;
use clap::CommandFactory;
use clap_complete::Shell;
use std::path::Path;

const NAME: &str = "anamorph";

pub fn completions(shell: Shell) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), NAME, &mut script);
    print(&String::from_utf8_lossy(&script))
}

pub fn pages(folder: &Path) -> Result<()> {
    let broken = |e: std::io::Error| Error::work(format!("{}: {e}", folder.display()));
    std::fs::create_dir_all(folder).map_err(broken)?;
    clap_mangen::generate_to(Cli::command(), folder).map_err(broken)?;
    print(&format!("{}\n", folder.join(format!("{NAME}.1")).display()))
}

pub fn schema() -> Result<()> {
    let text =
        serde_json::to_string_pretty(&schema::schema()).map_err(|e| Error::work(format!("schema as JSON: {e}")))?;
    print(&(text + "\n"))
}
