//! `anamorph gpu-report`: a self-test, control kernels and the suites on one adapter, until the time is up.
//!
//! All that was done is in report.json and in the runs of the suites, so that a later run goes on from there.

mod bandwidth;
pub mod command;
mod page;

use crate::bench::race::{Engines, Rules};
use crate::bench::suites::SUITES;
use crate::bench::{Ongoing, Provenance};
use crate::control::subgroup_widths;
use anamorph::internals::gpu::{Gpu, GpuOptions};
use anamorph::internals::image::write_text;
use anamorph::internals::input::{Error, Result};
use anamorph::internals::tools::self_test::{self, Tested, Tester};
use bandwidth::Bandwidth;
pub use command::Args;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The suites in the order of their worth to developers without such an adapter.
const ORDER: [&str; 9] = ["stages", "calls", "glc", "dynamic", "pareto", "samples", "papers", "stiff", "beyond"];

const REPORT: &str = "report.json";

/// What was found so far, beside the suites.
#[derive(Serialize, Deserialize)]
struct Report {
    provenance: Provenance,
    /// What `info` says of the adapter.
    adapter: String,
    /// The least and the most threads of a subgroup that ran; `None` where kernels may not ask.
    subgroup_widths: Option<[u32; 2]>,
    /// Or why they could not be measured.
    bandwidths: std::result::Result<Vec<Bandwidth>, String>,
    /// The first of [`self_test::views`].
    frames: Vec<Tested>,
}

/// What a user is told in the end.
pub struct Done {
    pub page: PathBuf,
    pub not_run: Vec<String>,
    /// Frames of the self-test with wrong pixels, or that failed.
    pub wrong_frames: usize,
}

/// Does what is left in the folder `out`; nothing new is started after `until`, but the control kernels and one frame. `tell` is given
/// lines.
///
/// # Errors
/// [`Error`] if there is no such adapter, it cannot be opened again, or a file cannot be written.
pub fn run(
    options: &GpuOptions,
    out: &Path,
    until: Instant,
    adapter_lines: fn(&Gpu) -> String,
    mut tell: impl FnMut(&str) -> Result<()>,
) -> Result<Done> {
    let mut engines = Engines::open(options)?;
    let gpu = engines.computing.gpu.clone();
    // a software adapter would take hours for the full cases
    let is_quick = gpu.info.device_type == wgpu::DeviceType::Cpu;
    let provenance = Provenance::now(&engines.computing, is_quick);
    tell(&format!("{}, {}\n", provenance.adapter, provenance.driver))?;
    std::fs::create_dir_all(out).map_err(|e| Error::work(format!("{}: {e}", out.display())))?;
    let (adapter, subgroup_widths) = (adapter_lines(&gpu), subgroup_widths(&gpu)?);
    let nothing = Report { provenance, adapter, subgroup_widths, bandwidths: Ok(Vec::new()), frames: Vec::new() };
    let mut report = nothing.resumed(out)?;
    let folder = out.join(report.folder_name());
    report.measure(options, &mut tell)?;
    report.test(options, &folder, until, &mut tell)?;
    let named = ORDER.iter().filter_map(|name| SUITES.iter().find(|suite| suite.name == *name));
    let resumed = named.map(|suite| Ongoing::resume(suite, report.provenance.clone(), gpu.has, out));
    let mut suites = resumed.collect::<Result<Vec<Ongoing>>>()?;
    let mut path = page::write(&folder, &report, &suites)?;
    let rules = Rules::new(is_quick, is_quick);
    for at in 0..suites.len() {
        for (k, case) in suites[at].left().into_iter().enumerate() {
            if Instant::now() >= until {
                break;
            }
            if k == 0 {
                tell(&format!("{}: {}\n", suites[at].suite.name, suites[at].suite.asks))?;
            }
            suites[at].race(&mut engines, &case, &rules)?.iter().try_for_each(|row| tell(&row.line()))?;
            // a lost device stays lost
            if [&engines.computing, &engines.drawing].iter().any(|engine| engine.gpu.failure().is_err()) {
                engines = Engines::open(options)?;
            }
        }
        path = page::write(&folder, &report, &suites)?;
    }
    let wrong_frames = report.frames.iter().filter(|f| !f.is_right()).count();
    Ok(Done { page: path, not_run: not_run(&report, &suites), wrong_frames })
}

/// What is left for a later run.
fn not_run(report: &Report, suites: &[Ongoing]) -> Vec<String> {
    let frames = self_test::views().len().saturating_sub(report.frames.len());
    let of_suite = |ongoing: &Ongoing| {
        let (left, all) = (ongoing.left(), ongoing.cases().len());
        let names: Vec<&str> = left.iter().map(|case| case.name.trim()).collect();
        (!left.is_empty()).then(|| match left.len() {
            n if n == all => format!("{}, all {n} cases", ongoing.suite.name),
            n => format!("{}, {n} of {all} cases ({})", ongoing.suite.name, names.join(", ")),
        })
    };
    let own = (frames > 0).then(|| format!("self-test, {frames} frames"));
    own.into_iter().chain(suites.iter().filter_map(of_suite)).collect()
}

impl Report {
    /// The newest that is in `out` and by the same program and adapter; this one if there is none.
    fn resumed(self, out: &Path) -> Result<Report> {
        let failed = |e: std::io::Error| Error::work(format!("{}: {e}", out.display()));
        let mut newest: Option<Report> = None;
        for entry in std::fs::read_dir(out).map_err(failed)? {
            // files of others are left alone
            let text = std::fs::read_to_string(entry.map_err(failed)?.path().join(REPORT)).unwrap_or_default();
            let Ok(report) = serde_json::from_str::<Report>(&text) else { continue };
            let is_newer = newest.as_ref().is_none_or(|n| n.provenance.date < report.provenance.date);
            if is_newer && report.provenance.is_by_the_same(&self.provenance) {
                newest = Some(report);
            }
        }
        let Some(there) = newest else { return Ok(self) };
        let date = there.provenance.date.clone();
        Ok(Report { provenance: Provenance { date, ..self.provenance }, ..there })
    }

    /// Measures bandwidths, if that is left.
    fn measure(&mut self, options: &GpuOptions, mut tell: impl FnMut(&str) -> Result<()>) -> Result<()> {
        if self.bandwidths.as_ref().map_or(true, Vec::is_empty) {
            self.bandwidths = bandwidth::measure(options).map_err(|e| e.to_string());
        }
        match &self.bandwidths {
            Ok(all) => {
                all.iter().try_for_each(|b| tell(&format!("  {:<12} {:>8.1} GB/s\n", b.kernel, b.gb_a_second())))
            }
            Err(e) => tell(&format!("  bandwidth: {e}\n")),
        }
    }

    /// Goes on with the self-test.
    fn test(
        &mut self,
        options: &GpuOptions,
        folder: &Path,
        until: Instant,
        mut tell: impl FnMut(&str) -> Result<()>,
    ) -> Result<()> {
        tell("self-test: frames against the reference\n")?;
        let mut tester = Tester::new(options);
        for view in self_test::views().iter().skip(self.frames.len()) {
            if Instant::now() >= until && !self.frames.is_empty() {
                break;
            }
            let tested = tester.test(view);
            tell(&format!("  {tested}\n"))?;
            self.frames.push(tested);
            self.write(folder)?;
        }
        tell(&format!("  {}\n", self_test::result(&self.frames)))
    }

    fn folder_name(&self) -> String {
        format!("{}-{}-gpu-report", self.provenance.date, self.provenance.short_adapter())
    }

    fn write(&self, folder: &Path) -> Result<()> {
        let failed = |e: &dyn std::fmt::Display| Error::work(format!("{}: {e}", folder.display()));
        std::fs::create_dir_all(folder).map_err(|e| failed(&e))?;
        let json = serde_json::to_string_pretty(self).map_err(|e| failed(&e))?;
        write_text(&folder.join(REPORT), &(json + "\n"))
    }
}
