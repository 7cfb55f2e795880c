//! `anamorph gpu-report`: what this program does on somebody's GPU, as a folder to send back.

use super::args::GpuReportArgs;
use super::info;
use super::say::print;
use crate::gpu::device::GpuOptions;
use crate::input::{Error, Result};
use crate::tools::gpu_report;
use std::time::{Duration, Instant};

pub fn run(args: &GpuReportArgs, started: Instant) -> Result<()> {
    let options = GpuOptions { adapter: args.adapter.clone(), ..Default::default() };
    let until = started + Duration::from_secs_f64(60.0 * args.minutes);
    let done = gpu_report::run(&options, &args.out, until, info::lines, print)?;
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
