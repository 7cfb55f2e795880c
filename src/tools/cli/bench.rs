//! `anamorph bench`: suites of measurements, and the page that shows all of them.

use super::args::BenchArgs;
use super::say::print;
use crate::gpu::device::GpuOptions;
use crate::input::files::Inputs;
use crate::input::{Error, Result};
use crate::jobs::outputs;
use crate::tools::bench;
use crate::tools::bench::race::{Engines, Rules};
use crate::tools::bench::suites::{SUITES, Suite};
use crate::tools::bench::{INDEX, Selection, write_index};

/// In place of a suite: a case is run again.
const REPRODUCE: &str = "reproduce";
/// In place of a suite: pages and plots are written anew from the results that are there.
const PAGE: &str = "page";

pub fn run(args: &BenchArgs) -> Result<()> {
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

fn reproduce(args: &BenchArgs, row: &str) -> Result<()> {
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
fn engines(args: &BenchArgs) -> Result<(Engines, Rules)> {
    let options = GpuOptions { adapter: args.adapter.clone(), ..Default::default() };
    let engines = Engines::open(&options)?;
    let is_software = engines.computing.gpu.info.device_type == wgpu::DeviceType::Cpu;
    let mut rules = Rules { yardstick: args.yardstick.clone(), ..Rules::new(args.quick, is_software) };
    rules.runs = args.runs.map_or(rules.runs, |runs| [runs, runs]);
    Ok((engines, rules))
}

fn suites(args: &BenchArgs) -> Result<()> {
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
    let selection = Selection { quick: args.quick, only: args.case.clone() };
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
