//! `anamorph bench`: error against run time for every technique, as files for readers.
//!
//! A [`suites::Suite`] is a list of [`case::Case`]s, each one scene and its arms; a [`race`] of one gives [`row::Row`]s. A
//! run is written as results.json, which holds all data. raw.csv, summary.md, plots and pages follow from it; index.html beside all runs
//! shows them together.

mod bars;
mod call_table;
pub mod calls;
pub mod case;
mod chart;
mod closeups;
pub mod command;
mod marks;
pub mod operations;
pub mod page;
mod plot;
mod provenance;
pub mod race;
mod reproduce;
pub mod row;
mod stiff;
pub mod suites;
mod table;
pub mod times;
mod verdict;
mod whole;
mod yardstick;

use anamorph::internals::gpu::device::AdapterFeatures;
use anamorph::internals::image::write_text;
use anamorph::internals::input::{Error, Result};
use case::Case;
pub use command::Args;
use operations::KernelOperations;
pub use provenance::Provenance;
use race::{Engines, Rules, race};
pub use reproduce::reproduce;
use row::Row;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use suites::{Plot, Suite};

/// A suite that was run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Run {
    pub suite: String,
    pub provenance: Provenance,
    pub rows: Vec<Row>,
    /// Pictures beside each other.
    #[serde(default)]
    pub closeups: Vec<closeups::Drawn>,
    /// Of the kernels that the first case's frames take, where the suite shows stages.
    #[serde(default)]
    pub operations: Vec<KernelOperations>,
}

/// Selects the cases of a suite.
#[derive(Debug, Clone, Default)]
pub struct Selection {
    /// Small cases, for a quick run.
    pub quick: bool,
    /// Those alone whose name contains it; a run of the same day and suite keeps its other rows.
    pub only: Option<String>,
    /// A run of the same day and suite by the same program and adapter keeps its rows, and their cases are left out.
    pub resume: bool,
}

/// Runs a suite and reports lines: its kernels' operations, and each row when it is complete; each case is written after it has run, to the run's own folder in `folder`.
///
/// # Errors
/// [`Error::Write`] if a file cannot be written, [`Error::Input`] if no case is selected; a case that a technique cannot render
/// becomes a row with the reason.
pub fn run(
    engines: &mut Engines,
    suite: &Suite,
    selection: &Selection,
    rules: &Rules,
    folder: &Path,
    mut tell: impl FnMut(&str),
) -> Result<PathBuf> {
    let Selection { quick, only, resume } = selection;
    let cases = suite.cases(*quick);
    let is_asked = |case: &Case| only.as_ref().is_none_or(|text| case.name.contains(text.as_str()));
    let closeups = if *quick { &[] } else { suite.closeups };
    let is_shown = |c: &&closeups::Closeups| only.as_ref().is_none_or(|text| c.name.contains(text.as_str()));
    if !cases.iter().any(is_asked) && !closeups.iter().any(|c| is_shown(&c)) {
        let names = cases.iter().map(|c| c.name.trim()).chain(closeups.iter().map(|c| c.name));
        let names: Vec<&str> = names.collect();
        return Err(Error::input(format!("{} has no such case; there is: {}", suite.name, names.join("; "))));
    }
    let (has, provenance) = (engines.computing.gpu.has, Provenance::now(&engines.computing, *quick));
    let mut ongoing = match resume {
        true => Ongoing::resume(suite, provenance, has, folder)?,
        false => Ongoing::start(suite, provenance, has, folder)?,
    };
    if !ongoing.run.operations.is_empty() {
        tell(&operations::lines(&ongoing.run.operations));
    }
    if only.is_some() && !resume && ongoing.folder.join(RESULTS).is_file() {
        ongoing.keep(read(&ongoing.folder.join(RESULTS))?);
    }
    let left = if *resume { ongoing.left() } else { cases };
    for case in left.iter().filter(|case| is_asked(case)) {
        ongoing.race(engines, case, rules)?.iter().for_each(|row| tell(&row.line()));
    }
    let Ongoing { mut run, folder, .. } = ongoing;
    for closeup in closeups.iter().filter(is_shown) {
        std::fs::create_dir_all(&folder).map_err(|e| Error::work(format!("{}: {e}", folder.display())))?;
        let drawn = closeup.draw(&mut engines.computing, &folder)?;
        run.closeups.retain(|c| c.name != drawn.name);
        run.closeups.push(drawn);
        run.write(&folder, suite.plot)?;
    }
    Ok(folder)
}

/// A run while its cases are added.
pub struct Ongoing<'a> {
    pub suite: &'a Suite,
    run: Run,
    /// Its own.
    folder: PathBuf,
}

impl<'a> Ongoing<'a> {
    /// In a folder of its own in `folder`, on an adapter with these abilities; without rows.
    fn start(suite: &'a Suite, provenance: Provenance, has: AdapterFeatures, folder: &Path) -> Result<Ongoing<'a>> {
        let first = suite.cases(provenance.quick).into_iter().next().filter(|_| suite.plot == Plot::Stages);
        let operations = first.map(|case| operations::of_case(&case, has)).transpose()?.unwrap_or_default();
        let run = Run { suite: suite.name.into(), provenance, rows: Vec::new(), closeups: Vec::new(), operations };
        let folder = folder.join(run.folder_name());
        Ok(Ongoing { suite, run, folder })
    }

    /// The same with the rows that are there, if they are by the same program and adapter.
    ///
    /// # Errors
    /// [`Error`] if the kernels of the suite's first case cannot be made.
    pub fn resume(
        suite: &'a Suite,
        provenance: Provenance,
        has: AdapterFeatures,
        folder: &Path,
    ) -> Result<Ongoing<'a>> {
        let mut ongoing = Ongoing::start(suite, provenance, has, folder)?;
        let there = read(&ongoing.folder.join(RESULTS)).ok();
        if let Some(run) = there.filter(|run| run.provenance.is_by_the_same(&ongoing.run.provenance)) {
            ongoing.keep(run);
        }
        Ok(ongoing)
    }

    fn keep(&mut self, Run { rows, closeups, .. }: Run) {
        (self.run.rows, self.run.closeups) = (rows, closeups);
    }

    /// As a section of a page, the `k`-th; `None` without rows.
    pub fn section(&self, k: usize) -> Option<String> {
        if self.run.rows.is_empty() {
            return None;
        }
        Some(page::section(k, &self.run, &plot::plots(&self.run.rows, self.suite.plot, chart::LARGE)))
    }

    /// The cases that have no rows yet.
    pub fn left(&self) -> Vec<Case> {
        let has_rows = |case: &Case| self.run.rows.iter().any(|row| row.case == case.name);
        self.cases().into_iter().filter(|case| !has_rows(case)).collect()
    }

    /// All of the suite.
    pub fn cases(&self) -> Vec<Case> {
        self.suite.cases(self.run.provenance.quick)
    }

    /// Runs a case and writes the run with its rows, in place of those that the case had.
    pub fn race(&mut self, engines: &mut Engines, case: &Case, rules: &Rules) -> Result<Vec<Row>> {
        let failed = |e: Error| case.arms.iter().map(|arm| Row::refused(self.suite.name, case, arm, &e)).collect();
        let mut own = run_case(engines, self.suite.name, case, rules).unwrap_or_else(failed);
        own.iter_mut().for_each(|row| row.commit = self.run.provenance.commit.clone());
        let cases = self.cases();
        self.run.rows.retain(|row| row.case != case.name);
        self.run.rows.extend(own.iter().cloned());
        self.run.rows.sort_by_key(|row| cases.iter().position(|c| c.name == row.case));
        self.run.write(&self.folder, self.suite.plot)?;
        Ok(own)
    }
}

/// The rows of a case: by frames of its arms in turn, or by whole calls.
fn run_case(engines: &mut Engines, suite: &str, case: &Case, rules: &Rules) -> Result<Vec<Row>> {
    match &case.calls {
        Some(plan) => calls::rows(engines, suite, case, plan, rules),
        None => race(engines, suite, case, rules),
    }
}

/// The file of a run that this program reads again.
const RESULTS: &str = "results.json";

fn read(results: &Path) -> Result<Run> {
    let text = std::fs::read_to_string(results).map_err(|e| Error::work(format!("{}: {e}", results.display())))?;
    let of_another = |e| Error::input(format!("{}: no results of this version: {e}; remove it", results.display()));
    serde_json::from_str(&text).map_err(of_another)
}

impl Run {
    fn folder_name(&self) -> String {
        let quick = if self.provenance.quick { "-quick" } else { "" };
        format!("{}-{}-{}{quick}", self.provenance.date, self.provenance.short_adapter(), self.suite)
    }

    fn write(&self, folder: &Path, plot: Plot) -> Result<()> {
        let failed = |e: &dyn std::fmt::Display| Error::work(format!("{}: {e}", folder.display()));
        std::fs::create_dir_all(folder).map_err(|e| failed(&e))?;
        write_text(&folder.join(RESULTS), &self.json().map_err(|e| failed(&e))?)?;
        self.draw(folder, plot)
    }

    /// The run without its rows on the first line, then a line for each row, so that differences between runs can be read.
    fn json(&self) -> serde_json::Result<String> {
        // a run and a row both begin with their suite, and no text has unescaped quotes
        let lines = serde_json::to_string(self)?.replace("{\"suite\":", "\n{\"suite\":");
        Ok(format!("{}\n", lines.trim_start()))
    }

    /// Writes raw.csv, the plots and summary.md, which follow from the results.
    fn draw(&self, folder: &Path, plot: Plot) -> Result<()> {
        write_text(&folder.join("raw.csv"), &table::csv(&self.rows)?)?;
        let plots = plot::plots(&self.rows, plot, chart::LARGE);
        for (name, _, svg) in &plots {
            write_text(&folder.join(name), &page::standalone(svg))?;
        }
        write_text(&folder.join("summary.md"), &table::markdown(self, &plots))
    }
}

/// The page over all runs, and that of each run in its folder.
pub const INDEX: &str = "index.html";

/// All runs in a folder, by the names of their own folders.
fn runs(folder: &Path) -> Result<Vec<(String, Run)>> {
    let failed = |e: std::io::Error| match e.kind() {
        std::io::ErrorKind::NotFound => {
            Error::input(format!("{}: there is no such folder; check --out", folder.display()))
        }
        _ => Error::work(format!("{}: {e}", folder.display())),
    };
    let mut names: Vec<String> = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        names.extend(entry.path().join(RESULTS).is_file().then(|| entry.file_name().to_string_lossy().into_owned()));
    }
    names.sort();
    names.into_iter().map(|name| Ok((name.clone(), read(&folder.join(name).join(RESULTS))?))).collect()
}

/// Writes raw.csv, the plots and summary.md of all runs in a folder anew from their results.
///
/// # Errors
/// [`Error::Input`] if a results.json in it is not by this program, [`Error::Write`] if a file cannot be written.
pub fn draw_again(folder: &Path) -> Result<()> {
    runs(folder)?.iter().try_for_each(|(name, run)| run.draw(&folder.join(name), page::plot_of(run)))
}

/// Writes index.html over all runs in a folder, and in each run's own folder that of the run; returns the first one's path.
///
/// # Errors
/// [`Error::Input`] if a results.json in it is not by this program.
pub fn write_index(folder: &Path) -> Result<PathBuf> {
    let runs = runs(folder)?;
    for (name, run) in &runs {
        let path = folder.join(name);
        let plots = plot::plots(&run.rows, page::plot_of(run), chart::LARGE);
        write_text(&path.join(INDEX), &page::run_page(run, &plots))?;
    }
    let path = folder.join(INDEX);
    write_text(&path, &page::page(&runs))?;
    Ok(path)
}
