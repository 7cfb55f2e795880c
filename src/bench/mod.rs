//! `anamorph bench`: error against run time for every technique, as files that a person looks at.
//!
//! A [`suites::Suite`] is a list of [`case::Case`]s, each one scene and the arms that show it; a [`race`] of one gives [`row::Row`]s. A
//! run is written as raw.csv, results.json, summary.md and plots; index.html beside all runs shows them together.

pub mod case;
mod page;
mod plot;
mod provenance;
pub mod race;
pub mod row;
pub mod suites;
mod table;
mod yardstick;

use crate::engine::Engine;
use crate::error::{Error, Result};
use crate::output::write_text;
pub use provenance::Provenance;
use race::{Rules, race};
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
}

/// Runs a suite, telling of each row as it is there; each case is written once it is run, to a folder of the run's own in `folder`.
///
/// # Errors
/// [`Error::Work`] where a file cannot be written; what a technique cannot show is a row that says so.
pub fn run(
    engine: &mut Engine,
    suite: &Suite,
    quick: bool,
    rules: &Rules,
    folder: &Path,
    mut tell: impl FnMut(&Row),
) -> Result<PathBuf> {
    let mut run = Run { suite: suite.name.into(), provenance: Provenance::now(engine, quick), rows: Vec::new() };
    let folder = folder.join(run.folder_name());
    for case in suite.cases(quick) {
        let failed = |e: Error| case.arms.iter().map(|arm| Row::refused(suite.name, &case, arm, &e)).collect();
        let own = race(engine, suite.name, &case, rules).unwrap_or_else(failed);
        own.iter().for_each(&mut tell);
        run.rows.extend(own);
        run.write(&folder, suite.plot)?;
    }
    Ok(folder)
}

impl Run {
    fn folder_name(&self) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
        let adapter: String =
            self.provenance.adapter.split(['(', ',']).next().unwrap_or("").trim().chars().map(plain).collect();
        let quick = if self.provenance.quick { "-quick" } else { "" };
        format!("{}-{adapter}-{}{quick}", self.provenance.date, self.suite)
    }

    fn write(&self, folder: &Path, plot: Plot) -> Result<()> {
        let failed = |e: &dyn std::fmt::Display| Error::work(format!("{}: {e}", folder.display()));
        std::fs::create_dir_all(folder).map_err(|e| failed(&e))?;
        let json = serde_json::to_string_pretty(self).map_err(|e| failed(&e))?;
        write_text(&folder.join("results.json"), &(json + "\n"))?;
        write_text(&folder.join("raw.csv"), &table::csv(&self.rows)?)?;
        let plots = plot::plots(&self.rows, plot)?;
        for (name, _, svg) in &plots {
            write_text(&folder.join(name), svg)?;
        }
        write_text(&folder.join("summary.md"), &table::markdown(self, &plots))
    }
}

/// Writes index.html over all runs in a folder; returns its path.
///
/// # Errors
/// [`Error::Input`] where a results.json there is none of this program.
pub fn write_index(folder: &Path) -> Result<PathBuf> {
    let failed = |e: std::io::Error| Error::work(format!("{}: {e}", folder.display()));
    let mut names: Vec<PathBuf> = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        names.extend(path.join("results.json").is_file().then_some(path));
    }
    names.sort();
    let read = |path: &PathBuf| {
        let file = path.join("results.json");
        let text = std::fs::read_to_string(&file).map_err(failed)?;
        let of_another = |e| Error::input(format!("{}: no results of this version: {e}; remove it", file.display()));
        let run: Run = serde_json::from_str(&text).map_err(of_another)?;
        let plot = suites::SUITES.iter().find(|s| s.name == run.suite).map_or(Plot::Error, |s| s.plot);
        let plots = plot::plots(&run.rows, plot)?;
        Ok((run, plots))
    };
    let runs = names.iter().map(read).collect::<Result<Vec<_>>>()?;
    let path = folder.join("index.html");
    write_text(&path, &page::page(&runs))?;
    Ok(path)
}
