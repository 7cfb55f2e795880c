//! Lists of jobs.

use crate::input::Result;
use crate::jobs::batch::{self, BatchOptions, Counts, Event, Outcome};
use std::path::{Path, PathBuf};

/// A list of jobs, as `anamorph batch` does it: `docs/reference/batches.md`.
///
/// Frames are read, rendered and written side by side. What is done is kept in a manifest beside the list, so that a batch that was
/// interrupted can go on.
///
/// ```no_run
/// use anamorph::{Batch, BatchEvent, BatchOptions};
///
/// # fn main() -> anamorph::Result<()> {
/// let options = BatchOptions { resume: true, ..Default::default() };
/// let outcome = Batch::new("jobs.toml").run(&options, &|event, counts| {
///     if let BatchEvent::Failed(task, why) = event {
///         eprintln!("{}: {why}; {} of {} done", task.name, counts.done, counts.all);
///     }
/// })?;
/// assert_eq!(outcome.counts.failed, 0);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Batch {
    list: PathBuf,
}

impl Batch {
    /// A list of jobs, .toml, .json or .jsonl.
    pub fn new(list: impl Into<PathBuf>) -> Batch {
        Batch { list: list.into() }
    }

    /// Does the frames of the list. `watch` is told each event and how the frames stand then, by several threads, one at a time. A frame
    /// that fails is told, and the rest go on.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) for what is wrong with the list, before any work; [`Error::Work`](crate::Error::Work) where the
    /// manifest or an adapter cannot be opened.
    pub fn run(&self, options: &BatchOptions, watch: &(dyn Fn(Event, &Counts) + Sync)) -> Result<Outcome> {
        batch::Batch::open(&self.list, options.shard, Vec::new())?.start(options)?.run(watch)
    }

    /// Joins what shards have done to the list's own manifest; returns the names of frames that are not done.
    ///
    /// # Errors
    /// As [`Batch::run`].
    pub fn gather(&self) -> Result<Vec<String>> {
        Ok(batch::Batch::open(&self.list, None, Vec::new())?.gather()?.missing)
    }

    /// The list.
    pub fn list(&self) -> &Path {
        &self.list
    }
}
