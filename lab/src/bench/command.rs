//! `anamorph bench`: suites of measurements, and the page that shows all of them.

use crate::bench;
use crate::bench::race::{Engines, Rules};
use crate::bench::suites::{SUITES, Suite};
use crate::bench::{INDEX, Selection, write_index};
use anamorph::internals::gpu::device::GpuOptions;
use anamorph::internals::input::files::Inputs;
use anamorph::internals::input::{Error, Result};
use anamorph::internals::jobs::outputs;
use anamorph::internals::tools::cli::print;
use std::path::PathBuf;

/// In place of a suite: a case is run again.
const REPRODUCE: &str = "reproduce";
/// In place of a suite: all other files are written anew from the results that are there.
const PAGE: &str = "page";

#[derive(Debug, clap::Args)]
pub struct Args {
    /// papers, pareto, glc, samples, stages, dynamic, stiff, beyond or calls [default: all]; or reproduce; or page: raw.csv, tables, plots and pages anew from each results.json in --out
    pub suite: Option<String>,
    /// With reproduce: the case to run again and to compare with what a run in --out says, for example 'papers/Yu 1'
    #[arg(value_name = "SUITE/CASE", requires = "suite")]
    pub row: Option<String>,
    /// Small cases, under a minute each
    #[arg(long)]
    pub quick: bool,
    /// Only cases whose name contains this; a run of the same day keeps its other rows
    #[arg(long, value_name = "TEXT", requires = "suite")]
    pub case: Option<String>,
    /// Leave out the cases that a run of the same day, program and adapter has
    #[arg(long, requires = "suite")]
    pub resume: bool,
    /// Folder for the results: one subfolder per run, and index.html
    #[arg(long, value_name = "DIR", default_value = "bench_results")]
    pub out: PathBuf,
    /// Program to time as well in the GLC cases, called as `PATH MESH.tri W H pieces FILE`
    #[arg(long, value_name = "PATH")]
    pub yardstick: Option<PathBuf>,
    /// Timed frames of each technique in each case [default: 9 on a GPU and 7 on a CPU, and more until the 95 % interval is within 5 %, 50 at most; 3 with --quick]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub runs: Option<u32>,
    /// Adapter to use: a part of its name
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

pub fn run(args: &Args) -> Result<()> {
    match (args.suite.as_deref(), &args.row) {
        (Some(REPRODUCE), Some(row)) => reproduce(args, row),
        (Some(REPRODUCE), None) => {
            Err(Error::input("bench reproduce needs the case to run again, for example 'papers/Yu 1'"))
        }
        (_, Some(row)) => Err(Error::input(format!("bench: {row} is one name too many; quote names with spaces"))),
        (Some(PAGE), None) => {
            bench::draw_again(&args.out)?;
            print(&format!("{}\n", write_index(&args.out)?.display()))
        }
        (_, None) => suites(args),
    }
}

fn reproduce(args: &Args, row: &str) -> Result<()> {
    let (mut engines, rules) = engines(args)?;
    let mut printed = Ok(());
    let differ = bench::reproduce(&mut engines, row, &rules, &args.out, |line| {
        printed = std::mem::replace(&mut printed, Ok(())).and_then(|()| print(line));
    })?;
    printed?;
    match differ {
        0 => Ok(()),
        1 => Err(Error::work("1 row does not agree")),
        _ => Err(Error::work(format!("{differ} rows do not agree"))),
    }
}

/// On the adapter that is asked for, and how cases are run there.
fn engines(args: &Args) -> Result<(Engines, Rules)> {
    let options = GpuOptions { adapter: args.adapter.clone(), ..Default::default() };
    let engines = Engines::open(&options)?;
    let is_software = engines.computing.gpu.info.device_type == wgpu::DeviceType::Cpu;
    let mut rules = Rules { yardstick: args.yardstick.clone(), ..Rules::new(args.quick, is_software) };
    rules.runs = args.runs.map_or(rules.runs, |runs| [runs, runs]);
    Ok((engines, rules))
}

fn suites(args: &Args) -> Result<()> {
    let asked: Vec<&Suite> = SUITES.iter().filter(|s| args.suite.as_ref().is_none_or(|name| name == s.name)).collect();
    if asked.is_empty() {
        let names: Vec<&str> = SUITES.iter().map(|s| s.name).collect();
        return Err(Error::input(format!("there is no suite of this name; use {}, or none for all", names.join(", "))));
    }
    if let Some(program) = &args.yardstick {
        // its output without arguments does not matter
        let started = std::process::Command::new(program).output();
        started.map_err(|e| Error::input(format!("--yardstick {}: cannot start it: {e}", program.display())))?;
    }
    std::fs::create_dir_all(&args.out).map_err(|e| Error::work(format!("{}: {e}", args.out.display())))?;
    outputs::check(&Inputs::default(), std::iter::once((args.out.join(INDEX).as_path(), outputs::PAGE)))?;
    let (mut engines, rules) = engines(args)?;
    let selection = Selection { quick: args.quick, only: args.case.clone(), resume: args.resume };
    for suite in asked {
        print(&format!("{}: {}\n", suite.name, suite.asks))?;
        let mut printed = Ok(());
        let folder = bench::run(&mut engines, suite, &selection, &rules, &args.out, |lines| {
            printed = std::mem::replace(&mut printed, Ok(())).and_then(|()| print(lines));
        })?;
        printed?;
        print(&format!("  -> {}\n", folder.display()))?;
    }
    print(&format!("{}\n", write_index(&args.out)?.display()))
}
