//! `anamorph gpu-report`: what this program does on somebody's GPU, as a folder to send back.

use crate::gpu_report;
use anamorph::internals::gpu::device::GpuOptions;
use anamorph::internals::input::{Error, Result};
use anamorph::internals::tools::cli::{adapter_lines, print};
use std::path::PathBuf;
use std::time::{Duration, Instant};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Minutes after which nothing new is started; a later run with the same --out goes on
    #[arg(long, value_name = "N", allow_hyphen_values = true, default_value_t = 8.0, value_parser = minutes)]
    pub minutes: f64,
    /// Folder for the results: a subfolder for the report, and one for each suite
    #[arg(long, value_name = "DIR", default_value = "bench_results")]
    pub out: PathBuf,
    /// Adapter to use: a part of its name
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

pub fn run(args: &Args, started: Instant) -> Result<()> {
    let options = GpuOptions { adapter: args.adapter.clone(), ..Default::default() };
    let until = started + Duration::from_secs_f64(60.0 * args.minutes);
    let done = gpu_report::run(&options, &args.out, until, adapter_lines, print)?;
    let (page, out) = (done.page.display(), args.out.display());
    if !done.not_run.is_empty() {
        print(&format!("not run: {}\nrun the same command again to go on\n", done.not_run.join("; ")))?;
    }
    print(&format!("{page}\nplease send the folder {out}\n"))?;
    match done.wrong_frames {
        0 => Ok(()),
        n => Err(Error::work(format!(
            "the self-test failed: {n} wrong frames; do not trust pictures of this adapter; see {page}"
        ))),
    }
}

/// A day.
const MINUTES_MAX: f64 = 1440.0;

fn minutes(text: &str) -> std::result::Result<f64, String> {
    let minutes = text.parse().ok().filter(|n: &f64| (0.0..=MINUTES_MAX).contains(n));
    minutes.ok_or_else(|| format!("write a number of minutes from 0 to {MINUTES_MAX}, for example 8"))
}
