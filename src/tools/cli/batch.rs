//! `anamorph batch`: runs a list of jobs, with progress, log and reports.

mod progress;
mod results;

use super::args::{BatchArgs, ProgressName};
use super::say::print;
use crate::image::write_text;
use crate::input::files::Inputs;
use crate::input::{Error, Result};
use crate::jobs::batch::{Batch, BatchOptions, Counts, Outcome, RAY_DRIVER};
use crate::jobs::outputs::{self, LOG, REPORT, TABLE};
use progress::BatchProgress;
use std::path::Path;

/// Most failed frames named in the last line.
const NAMED: usize = 10;

pub fn run(args: &BatchArgs) -> Result<()> {
    if let Some(path) = &args.write_driver {
        outputs::check(&Inputs::default(), std::iter::once((path.as_path(), outputs::DRIVER)))?;
        return write_text(path, RAY_DRIVER);
    }
    let Some(list) = &args.jobs else { return Err(Error::input("no list of jobs")) };
    let beside = [(&args.csv, TABLE), (&args.report, REPORT), (&args.log, LOG)];
    let beside = beside.into_iter().filter_map(|(path, kind)| Some((path.clone()?, kind))).collect();
    let batch = Batch::open(list, args.shard, beside, args.caps.limits())?;
    if args.gather {
        return gather(args, list, &batch);
    }
    let mut started = batch.start(&BatchOptions {
        resume: args.resume,
        shard: args.shard,
        writers: args.jobs_at_once.map(usize::from),
        adapters: args.adapters.clone(),
        fail_fast: args.fail_fast,
    })?;
    let progress = BatchProgress::new(args.progress, args.log.as_deref(), list, started.frames.count())?;
    let outcome = started.run(&|event, counts| progress.report(event, counts))?;
    progress.end(&outcome.counts);
    if let Some(path) = &args.csv {
        results::write_csv(path, || started.frames.each())?;
    }
    if let Some(path) = &args.report {
        results::write_report(path, &outcome, started.frames.each())?;
    }
    end(list, args.progress, &outcome)
}

/// Merges the manifests of all shards, and lists the frames that are not done.
fn gather(args: &BatchArgs, list: &Path, batch: &Batch) -> Result<()> {
    let (gathered, missing) = batch.gather()?;
    let all = gathered.count();
    if let Some(path) = &args.csv {
        results::write_csv(path, || gathered.each())?;
    }
    if let Some(path) = &args.report {
        let counts = Counts { all, done: all - missing.len(), ..Counts::default() };
        let outcome = Outcome { counts, wall_s: 0.0, devices: Vec::new(), failures: Vec::new(), stopped_by: None };
        results::write_report(path, &outcome, gathered.each())?;
    }
    if missing.is_empty() {
        return print(&format!("{}: {}\n", list.display(), frames(all)));
    }
    let (list, named, missing) =
        (list.display(), named(missing.iter().map(String::as_str), missing.len()), missing.len());
    Err(Error::work(format!("{list}: {missing} of {all} frames are not done, which --resume does: {named}")))
}

fn frames(count: usize) -> String {
    format!("{count} frame{}", if count == 1 { "" } else { "s" })
}

/// The first of `count` frames, and how many more there are.
fn named<'a>(names: impl Iterator<Item = &'a str>, count: usize) -> String {
    let first: Vec<&str> = names.take(NAMED).collect();
    let more = if count > NAMED { format!(" and {} more", count - NAMED) } else { String::new() };
    first.join("; ") + &more
}

/// The last line, or an error that summarizes the failures.
fn end(list: &Path, progress: ProgressName, outcome: &Outcome) -> Result<()> {
    let Outcome { counts: Counts { all, done, skipped, failed, .. }, failures, stopped_by, .. } = outcome;
    let before = if *skipped > 0 { format!(", {skipped} before") } else { String::new() };
    if *failed == 0 && stopped_by.is_none() {
        let line = format!("{}: {}{before}\n", list.display(), frames(*done));
        return if progress == ProgressName::Json { Ok(()) } else { print(&line) };
    }
    let left = all - done - skipped - failed;
    let mut text = format!("{}: {done} of {all} frames done{before}", list.display());
    if *failed > 0 {
        let named = named(failures.iter().map(|(name, _)| name.as_str()), *failed);
        text += &format!(", {failed} failed: {named}");
    }
    if left > 0 {
        text += &format!("; {left} not begun, which --resume does");
    }
    Err(match stopped_by {
        Some(why) => Error::work(format!("stopped: {why}: {text}")),
        None => Error::work(text),
    })
}
