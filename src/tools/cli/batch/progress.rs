//! Progress of a batch: a bar on a terminal, JSON lines for programs, and a log.

use super::frames;
use crate::image::open_to_append;
use crate::input::{Error, Result};
use crate::jobs::batch::{Counts, Event, Task, lock};
use crate::tools::cli::args::ProgressName;
use crate::tools::cli::progress::{Shown, progress_lines};
use crate::tools::cli::say::{complain, line_of, note, print};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Instant, SystemTime};

pub struct BatchProgress {
    /// The list of jobs.
    list: PathBuf,
    is_json: bool,
    bar: Option<ProgressBar>,
    log: Option<Mutex<File>>,
    started: Instant,
    so_far: Arc<Mutex<SoFar>>,
    /// Number of frames rendered again by reason, for the first [`REASONS`] reasons.
    reasons: Mutex<BTreeMap<String, usize>>,
    _lines: Option<Shown<()>>,
}

/// The counts, and when the first frame was done.
struct SoFar {
    counts: Counts,
    first: Option<Instant>,
}

impl SoFar {
    /// Frames a second since the first one was done, which waits for kernels to be compiled; `None` before the second.
    fn per_s(&self) -> Option<f64> {
        let later = self.counts.done.checked_sub(1).filter(|later| *later > 0)?;
        Some(later as f64 / self.first?.elapsed().as_secs_f64())
    }

    fn tried(&self) -> usize {
        self.counts.done + self.counts.skipped + self.counts.failed
    }

    /// Seconds that the frames which are left take at that rate.
    fn left_s(&self) -> Option<f64> {
        Some((self.counts.all - self.tried()) as f64 / self.per_s()?)
    }

    /// The progress as text; `None` at the end.
    fn line(&self) -> Option<String> {
        let (tried, all) = (self.tried(), self.counts.all);
        let rest = self.per_s().zip(self.left_s());
        let rest = rest.map_or(String::new(), |(per_s, left_s)| format!(", {}, {left_s:.0} s left", rate(per_s)));
        (tried < all).then(|| format!("{tried} of {all} frames{rest}"))
    }
}

/// Most reasons counted, to bound the memory. The log has all.
const REASONS: usize = 1000;

/// Most reasons printed at the end.
const REASONS_PRINTED: usize = 3;

impl BatchProgress {
    /// # Errors
    /// [`Error::Work`] if the log cannot be written.
    pub fn new(progress: ProgressName, log: Option<&Path>, list: &Path, all: usize) -> Result<BatchProgress> {
        let open = |path: &Path| {
            open_to_append(path).map_err(|e| Error::work(format!("{}: the log cannot be written: {e}", path.display())))
        };
        let log = log.map(open).transpose()?.map(Mutex::new);
        let is_auto = progress == ProgressName::Auto;
        let has_bar = is_auto && std::io::stderr().is_terminal();
        let so_far = SoFar { counts: Counts { all, ..Counts::default() }, first: None };
        let (so_far, started) = (Arc::new(Mutex::new(so_far)), Instant::now());
        let told = so_far.clone();
        let line = move || lock(&told).line();
        let shown = BatchProgress {
            list: list.to_owned(),
            is_json: progress == ProgressName::Json,
            bar: has_bar.then(|| bar(all)),
            log,
            started,
            so_far,
            reasons: Mutex::default(),
            _lines: (is_auto && !has_bar).then(|| progress_lines(line)),
        };
        shown.write(json!({ "event": "start", "frames": all }), &format!("start: {all} frames"));
        Ok(shown)
    }

    /// Shows an event and the counts after it.
    pub fn report(&self, event: Event, counts: &Counts) {
        let mut so_far = lock(&self.so_far);
        so_far.counts = *counts;
        let is_first = so_far.first.is_none() && counts.done > 0;
        if is_first {
            so_far.first = Some(Instant::now());
        }
        if let Some(bar) = &self.bar {
            bar.set_position(so_far.tried() as u64);
            if is_first {
                // the pace of the bar begins here
                bar.reset_eta();
            }
        }
        drop(so_far);
        match event {
            Event::Done(task, ms) => self.done(task, ms, counts),
            Event::Skipped(task) => {
                self.write(json!({ "event": "skipped", "frame": task.name }), &format!("skipped: {}", task.name));
            }
            Event::Again(task, why) => {
                let mut reasons = lock(&self.reasons);
                if reasons.len() < REASONS || reasons.contains_key(why) {
                    *reasons.entry(why.to_owned()).or_default() += 1;
                }
                drop(reasons);
                let value = json!({ "event": "again", "frame": task.name, "why": why });
                self.write(value, &format!("again: {}: {why}", task.name));
            }
            Event::Failed(task, error) => {
                let said = error.clone().at(format_args!("{}: {}", self.list.display(), task.name));
                self.beside_bar(|| complain(&said));
                let why = line_of(error);
                let value = json!({ "event": "failed", "frame": task.name, "why": why });
                self.write(value, &format!("failed: {}: {why}", task.name));
            }
            Event::Note(line) => {
                self.say(line);
                self.write(json!({ "event": "note", "text": line }), line);
            }
        }
    }

    fn done(&self, task: &Task, ms: f64, counts: &Counts) {
        let (per_s, left_s) = {
            let so_far = lock(&self.so_far);
            (so_far.per_s(), so_far.left_s())
        };
        let value = json!({
            "event": "done", "frame": task.name, "outputs": outputs(task), "ms": ms, "done": counts.done,
            "skipped": counts.skipped, "failed": counts.failed, "frames": counts.all, "per_s": per_s, "left_s": left_s,
        });
        self.write(value, &format!("done: {}: {ms:.1} ms: {}", task.name, outputs(task).join(", ")));
    }

    /// Ends the display: no frame is left.
    pub fn end(&self, counts: &Counts) {
        let Counts { all, done, skipped, failed, again } = *counts;
        let wall_s = self.started.elapsed().as_secs_f64();
        let value = json!({
            "event": "end", "frames": all, "done": done, "skipped": skipped, "failed": failed, "again": again,
            "wall_s": wall_s,
        });
        self.write(value, &format!("end: {done} of {all} done, {skipped} skipped, {failed} failed in {wall_s:.1} s"));
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        if again > 0 {
            self.say(&again_line(again, &lock(&self.reasons)));
        }
    }

    /// Prints a line on stderr unless JSON is written.
    fn say(&self, line: &str) {
        if !self.is_json {
            self.beside_bar(|| note(line));
        }
    }

    /// Runs a closure that writes to the terminal, with the bar hidden meanwhile.
    fn beside_bar(&self, write: impl FnOnce()) {
        match &self.bar {
            Some(bar) => bar.suspend(write),
            None => write(),
        }
    }

    fn write(&self, value: Value, line: &str) {
        if self.is_json {
            // the reader may have closed stdout
            let _ = print(&format!("{value}\n"));
        }
        if let Some(log) = &self.log {
            let now = humantime::format_rfc3339_millis(SystemTime::now());
            // a failed log line must not stop the batch
            let _ = lock(log).write_all(format!("{now} {}\n", line_of(line)).as_bytes());
        }
    }
}

/// The number of frames rendered again, and the most frequent reasons.
fn again_line(again: usize, reasons: &BTreeMap<String, usize>) -> String {
    if let (Some((why, _)), 1) = (reasons.first_key_value(), reasons.len()) {
        return format!("again: {}: {why}", frames(again));
    }
    let mut sorted: Vec<(&String, &usize)> = reasons.iter().collect();
    // stable, so that equal counts stay in the order of their texts
    sorted.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
    let explained: usize = sorted.iter().take(REASONS_PRINTED).map(|(_, count)| **count).sum();
    let named = sorted.iter().take(REASONS_PRINTED).map(|(why, count)| format!("{why} ({})", frames(**count)));
    let more = (explained < again).then(|| format!("other reasons ({})", frames(again - explained)));
    let each: Vec<String> = named.chain(more).collect();
    format!("again: {}: {}", frames(again), each.join("; "))
}

fn outputs(task: &Task) -> Vec<String> {
    task.outputs().unwrap_or_default().iter().map(|path| path.display().to_string()).collect()
}

fn bar(all: usize) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(all as u64), ProgressDrawTarget::stderr());
    let style = ProgressStyle::with_template("{wide_bar} {pos} of {len}, {rate}, {eta} left");
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
    bar.with_style(style.with_key("rate", |state: &ProgressState, text: &mut dyn std::fmt::Write| {
        // a bar without its rate is still useful
        let _ = text.write_str(&rate(state.per_sec()));
    }))
}

/// Frames a second, or seconds a frame.
fn rate(per_s: f64) -> String {
    if per_s >= 1.0 || per_s <= 0.0 { format!("{per_s:.1}/s") } else { format!("{:.1} s each", 1.0 / per_s) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn the_first_frame_is_no_pace() {
        let now = Instant::now();
        let so_far = |done, skipped, seconds| SoFar {
            counts: Counts { all: 100, done, skipped, ..Counts::default() },
            // Linux counts from its start, which is longer ago than this
            first: now.checked_sub(Duration::from_secs(seconds)),
        };
        assert_eq!(so_far(0, 5, 0).line().as_deref(), Some("5 of 100 frames"));
        // whatever the first took
        assert_eq!(so_far(1, 9, 3).line().as_deref(), Some("10 of 100 frames"));
        // ten more in ten seconds: one a second, or little less, as the clock goes on
        assert_eq!(so_far(11, 9, 10).line().as_deref(), Some("20 of 100 frames, 1.0 s each, 80 s left"));
        assert_eq!(so_far(91, 9, 10).line(), None);
    }
}
