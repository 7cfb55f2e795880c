//! Lists of jobs.

use crate::input::{Limits, Result};
use crate::jobs::batch::{self, BatchOptions, Counts, Event, Outcome, Shard};
use std::path::{Path, PathBuf};

/// A list of jobs, as run by `anamorph batch`: `docs/reference/batches.md`.
///
/// Frames are read, rendered and written in parallel. Finished frames are recorded in a manifest beside the list, so that an
/// interrupted batch can be resumed.
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
    limits: Limits,
}

impl Batch {
    /// A list of jobs, .toml, .json or .jsonl.
    pub fn new(list: impl Into<PathBuf>) -> Batch {
        Batch { list: list.into(), limits: Limits::default() }
    }

    /// The limits on the list and on each of its frames.
    pub fn limits(self, limits: Limits) -> Batch {
        Batch { limits, ..self }
    }

    /// Renders the frames of the list. `watch` receives each event and the counts after it; several threads call it, one at a time. A
    /// failed frame is reported as an event; the others continue.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) if the list is wrong, before any work; [`Error::Work`](crate::Error::Work) if the
    /// manifest or an adapter cannot be opened.
    pub fn run(&self, options: &BatchOptions, watch: &(dyn Fn(Event, &Counts) + Sync)) -> Result<Outcome> {
        self.open(options.shard)?.start(options)?.run(watch)
    }

    /// Merges the manifests of all shards into that of the list; returns the names of frames that are not done.
    ///
    /// # Errors
    /// As [`Batch::run`].
    pub fn gather(&self) -> Result<Vec<String>> {
        Ok(self.open(None)?.gather()?.1)
    }

    fn open(&self, shard: Option<Shard>) -> Result<batch::Batch> {
        batch::Batch::open(&self.list, shard, Vec::new(), self.limits)
    }

    /// The list.
    pub fn list(&self) -> &Path {
        &self.list
    }
}
