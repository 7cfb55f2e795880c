//! Results of a batch: a table with a row per frame, and a report. Both are made from the manifest, so they include frames rendered
//! earlier or elsewhere.

use crate::image::write_lines;
use crate::input::{Error, Result};
use crate::jobs::batch::{Counts, Done, Outcome, Task, Worked};
use indexmap::IndexSet;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::io;
use std::path::Path;

/// The report without the frames.
#[derive(Serialize)]
struct Summary<'a> {
    version: &'static str,
    frames: usize,
    done: usize,
    skipped: usize,
    failed: usize,
    wall_s: f64,
    devices: &'a [Worked],
    /// Names and errors of the first failed frames.
    failures: &'a [(String, String)],
}

/// Writes the report: the summary, and `each`, a line per frame.
///
/// # Errors
/// [`Error::Write`] if it cannot be written.
pub fn write_report<'a>(
    path: &Path,
    outcome: &Outcome,
    frames: impl Iterator<Item = Result<(Task<'a>, Option<Done>)>>,
) -> Result<()> {
    let Outcome { counts: Counts { all, done, skipped, failed, .. }, wall_s, ref devices, ref failures, .. } = *outcome;
    let summary =
        Summary { version: env!("CARGO_PKG_VERSION"), frames: all, done, skipped, failed, wall_s, devices, failures };
    let head = serde_json::to_string_pretty(&summary).map_err(|e| Error::work(format!("report as JSON: {e}")))?;
    let head = head.trim_end_matches("\n}").to_owned();
    write_lines(path, |out| {
        write!(out, "{head},\n  \"each\": [")?;
        let mut gap = "\n";
        for frame in frames {
            if let (_, Some(done)) = frame.map_err(io::Error::other)? {
                write!(out, "{gap}    {}", serde_json::to_string(&done)?)?;
                gap = ",\n";
            }
        }
        writeln!(out, "\n  ]\n}}")
    })
}

/// Writes the table: each frame with its swept values, times, and its error if requested.
///
/// # Errors
/// [`Error::Write`] if it cannot be written.
pub fn write_csv<'a, T>(path: &Path, frames: impl Fn() -> T) -> Result<()>
where
    T: Iterator<Item = Result<(Task<'a>, Option<Done>)>>,
{
    let mut columns = IndexSet::new();
    for frame in frames() {
        let (task, done) = frame.map_err(|e| e.at(path.display()))?;
        columns.extend(row(&task, done.as_ref()).into_iter().map(|(name, _)| name));
    }
    write_lines(path, |out| {
        let mut table = csv::Writer::from_writer(out);
        table.write_record(&columns)?;
        for frame in frames() {
            let (task, done) = frame.map_err(io::Error::other)?;
            let row: BTreeMap<String, String> = row(&task, done.as_ref()).into_iter().collect();
            table.write_record(columns.iter().map(|name| row.get(name).map_or("", String::as_str)))?;
        }
        table.flush()
    })
}

/// Names and values of a frame, in order.
fn row(task: &Task, done: Option<&Done>) -> Vec<(String, String)> {
    let mut row = vec![("job".to_owned(), task.job_name().to_owned()), ("frame".into(), task.frame.to_string())];
    row.extend(task.values.iter().map(|(key, value)| ((*key).to_owned(), value.trim_matches('"').to_owned())));
    row.push(("is_done".into(), done.is_some().to_string()));
    let Some(done) = done else { return row };
    let numbers = [
        ("triangles", done.triangles.to_string()),
        ("pieces", done.pieces.to_string()),
        ("adapter", done.adapter.clone()),
        ("call_ms", done.call_ms.to_string()),
        ("frame_ms", done.frame_ms.to_string()),
        ("runs", done.runs.to_string()),
        ("device_ms", done.ms.to_string()),
    ];
    row.extend(numbers.map(|(name, value)| (name.to_owned(), value)));
    row.extend(done.stages.iter().map(|(name, ms)| (format!("{name}_ms"), ms.to_string())));
    if let Some(error) = &done.error {
        flatten("error", error, &mut row);
    }
    row
}

/// Adds the leaves of a value by their dotted keys.
fn flatten(key: &str, value: &Value, row: &mut Vec<(String, String)>) {
    match value {
        Value::Object(fields) => fields.iter().for_each(|(name, own)| flatten(&format!("{key}.{name}"), own, row)),
        Value::Array(items) => items.iter().enumerate().for_each(|(k, own)| flatten(&format!("{key}.{k}"), own, row)),
        Value::Null => row.push((key.to_owned(), String::new())),
        Value::String(text) => row.push((key.to_owned(), text.clone())),
        leaf => row.push((key.to_owned(), leaf.to_string())),
    }
}
