//! `anamorph batch`: many frames of many scenes, one after the other. What goes wrong with one is said, and the rest go on.

mod jobs;
mod names;

use super::args::BatchArgs;
use super::{complain, print, render};
use crate::error::{Error, Result};
use jobs::Jobs;
use std::time::Instant;

/// Frames that the last line names where more have failed.
const NAMED: usize = 10;

pub fn run(args: &BatchArgs) -> Result<()> {
    let jobs = Jobs::read(&args.jobs)?;
    let (mut done, mut failed) = (0, Vec::new());
    for task in jobs.tasks() {
        match task.args().and_then(|args| render::run(&args, Instant::now())) {
            Ok(()) => done += 1,
            Err(e) => {
                complain(&e.at(&task.name));
                failed.push(task.name);
                if args.fail_fast {
                    break;
                }
            }
        }
    }
    if failed.is_empty() {
        return print(&format!("{}: {done} frames\n", args.jobs.display()));
    }
    let (all, count) = (jobs.count(), failed.len());
    let more = if count > NAMED { format!(" and {} more", count - NAMED) } else { String::new() };
    failed.truncate(NAMED);
    Err(Error::work(format!("{done} of {all} frames done, {count} failed: {}{more}", failed.join("; "))))
}
