//! What a batch tells while it works: a bar on a terminal, lines of JSON for programs, lines of a log.

use super::jobs::Task;
use super::{frames, lock};
use crate::image::open_to_append;
use crate::input::{Error, Result};
use crate::tools::cli::args::ProgressName;
use crate::tools::cli::progress::ProgressLines;
use crate::tools::cli::say::{complain, line_of, note, print};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{IsTerminal, Write};
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::{Instant, SystemTime};

pub struct Board {
    is_json: bool,
    bar: Option<ProgressBar>,
    log: Option<Mutex<File>>,
    started: Instant,
    counts: Arc<Mutex<Counts>>,
    /// Frames that are done again, by what has changed: the first [`REASONS`] of the reasons.
    reasons: Mutex<BTreeMap<String, usize>>,
    _lines: Option<ProgressLines>,
}

/// Frames, by how they stand.
#[derive(Debug, Clone, Copy, Default)]
pub struct Counts {
    /// All that are to be done here.
    pub all: usize,
    pub done: usize,
    /// Done before.
    pub skipped: usize,
    pub failed: usize,
    /// Done before, and done again as something has changed.
    pub again: usize,
}

/// Reasons that are counted, which bounds the memory for them. The log has all.
const REASONS: usize = 1000;

/// Reasons that are printed at the end.
const REASONS_PRINTED: usize = 3;

impl Board {
    /// # Errors
    /// [`Error::Work`] where the log cannot be written.
    pub fn new(progress: ProgressName, log: Option<&Path>, all: usize) -> Result<Board> {
        let open = |path: &Path| {
            open_to_append(path).map_err(|e| Error::work(format!("{}: the log cannot be written: {e}", path.display())))
        };
        let log = log.map(open).transpose()?.map(Mutex::new);
        let is_auto = progress == ProgressName::Auto;
        let has_bar = is_auto && std::io::stderr().is_terminal();
        let (counts, started) = (Arc::new(Mutex::new(Counts { all, ..Counts::default() })), Instant::now());
        let counted = counts.clone();
        let line = move || lock(&counted).line(started);
        let board = Board {
            is_json: progress == ProgressName::Json,
            bar: has_bar.then(|| bar(all)),
            log,
            started,
            counts,
            reasons: Mutex::default(),
            _lines: (is_auto && !has_bar).then(|| ProgressLines::start(line)),
        };
        board.tell(json!({ "event": "start", "frames": all }), &format!("start: {all} frames"));
        Ok(board)
    }

    pub fn counts(&self) -> Counts {
        *lock(&self.counts)
    }

    /// A frame is done.
    pub fn done(&self, task: &Task, ms: f64) {
        let counts = self.count(|c| c.done += 1);
        let rate = counts.done as f64 / self.started.elapsed().as_secs_f64();
        let left = (counts.all - counts.done - counts.skipped - counts.failed) as f64 / rate;
        let value = json!({
            "event": "done", "frame": task.name, "outputs": outputs(task), "ms": ms, "done": counts.done,
            "skipped": counts.skipped, "failed": counts.failed, "frames": counts.all, "per_s": rate, "left_s": left,
        });
        self.tell(value, &format!("done: {}: {ms:.1} ms: {}", task.name, outputs(task).join(", ")));
    }

    /// A frame was done before.
    pub fn skipped(&self, task: &Task) {
        self.count(|c| c.skipped += 1);
        self.tell(json!({ "event": "skipped", "frame": task.name }), &format!("skipped: {}", task.name));
    }

    /// A frame that was done before is done again.
    pub fn again(&self, task: &Task, why: &str) {
        self.count(|c| c.again += 1);
        let line = format!("again: {}: {why}", task.name);
        let mut reasons = lock(&self.reasons);
        if reasons.len() < REASONS || reasons.contains_key(why) {
            *reasons.entry(why.to_owned()).or_default() += 1;
        }
        drop(reasons);
        self.tell(json!({ "event": "again", "frame": task.name, "why": why }), &line);
    }

    /// A frame cannot be done.
    pub fn failed(&self, task: &Task, at: &Path, error: &Error) {
        self.count(|c| c.failed += 1);
        let said = error.clone().at(format_args!("{}: {}", at.display(), task.name));
        match &self.bar {
            Some(bar) => bar.suspend(|| complain(&said)),
            None => complain(&said),
        }
        let why = line_of(error);
        let value = json!({ "event": "failed", "frame": task.name, "why": why });
        self.tell(value, &format!("failed: {}: {why}", task.name));
    }

    /// Something that a person should know.
    pub fn note(&self, line: &str) {
        self.say(line);
        self.tell(json!({ "event": "note", "text": line }), line);
    }

    /// All has been tried.
    pub fn end(&self) -> Counts {
        let counts = self.counts();
        let Counts { all, done, skipped, failed, again } = counts;
        let wall_s = self.started.elapsed().as_secs_f64();
        let value = json!({
            "event": "end", "frames": all, "done": done, "skipped": skipped, "failed": failed, "again": again,
            "wall_s": wall_s,
        });
        self.tell(value, &format!("end: {done} of {all} done, {skipped} skipped, {failed} failed in {wall_s:.1} s"));
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        if again > 0 {
            self.say(&again_line(again, &lock(&self.reasons)));
        }
        counts
    }

    fn count(&self, change: impl FnOnce(&mut Counts)) -> Counts {
        let mut counts = lock(&self.counts);
        change(&mut counts);
        if let Some(bar) = &self.bar {
            bar.set_position((counts.done + counts.skipped + counts.failed) as u64);
        }
        *counts
    }

    /// On stderr, for a person; programs have it as JSON.
    fn say(&self, line: &str) {
        let write = || note(line);
        match &self.bar {
            Some(bar) => bar.suspend(write),
            None if !self.is_json => write(),
            None => {}
        }
    }

    fn tell(&self, value: Value, line: &str) {
        if self.is_json {
            // whoever went away hears no more
            let _ = print(&format!("{value}\n"));
        }
        if let Some(log) = &self.log {
            let now = humantime::format_rfc3339_millis(SystemTime::now());
            // frames are worth more than a line about them
            let _ = lock(log).write_all(format!("{now} {}\n", line_of(line)).as_bytes());
        }
    }
}

impl Counts {
    /// How far the batch is, as text; `None` at its end.
    fn line(&self, started: Instant) -> Option<String> {
        let Counts { all, done, skipped, failed, .. } = *self;
        let tried = done + skipped + failed;
        let per_s = done as f64 / started.elapsed().as_secs_f64();
        let rest = match done {
            0 => String::new(),
            _ => format!(", {}, {:.0} s left", rate(per_s), (all - tried) as f64 / per_s),
        };
        (tried < all).then(|| format!("{tried} of {all} frames{rest}"))
    }
}

/// How many frames were done again and why, the most frequent reasons first.
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
        // a bar without its rate is one still
        let _ = text.write_str(&rate(state.per_sec()));
    }))
}

/// Frames a second, or seconds a frame.
fn rate(per_s: f64) -> String {
    if per_s >= 1.0 || per_s <= 0.0 { format!("{per_s:.1}/s") } else { format!("{:.1} s each", 1.0 / per_s) }
}
