//! Many frames of many scenes: a list of jobs. Frames are read, rendered and written at once by threads of their own; what is done is
//! kept in a manifest, and what goes wrong with one frame is told, and the rest go on.

mod checks;
mod list;
mod manifest;
mod names;
mod paths;
mod queue;
mod run;
mod shard;
mod slots;
#[cfg(test)]
mod tests;
mod worker;

use super::outputs::Kind;
use crate::gpu::device::NO_ADAPTER;
use crate::image::clear_up;
use crate::input::files::noted;
use crate::input::{Error, Result};
use crate::scene::library::Library;
use checks::Checks;
use list::Jobs;
pub use list::Task;
pub use manifest::Done;
use manifest::Standing;
use manifest::{Costs, Manifest};
use paths::{Paths, folder_of, folders};
use run::Run;
pub use shard::Shard;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;
pub use worker::Worked;
use worker::Worker;

/// How a batch is done.
#[derive(Debug, Clone, Default)]
pub struct BatchOptions {
    /// Skip what is done, by the manifest beside the list, as long as nothing has changed that it was made from.
    pub resume: bool,
    /// Do this part of the list only.
    pub shard: Option<Shard>,
    /// Frames that are written at once; `None`: one a core.
    pub writers: Option<usize>,
    /// Parts of adapters' names, their numbers from 0, or `all`; `None`: the first.
    pub adapters: Option<Vec<String>>,
    /// Stop at the first frame that fails.
    pub fail_fast: bool,
}

/// Frames, by how they stand.
#[derive(Debug, Clone, Copy, Default)]
pub struct Counts {
    /// All that are to be done here.
    pub all: usize,
    /// Done now.
    pub done: usize,
    /// Done before.
    pub skipped: usize,
    /// Tried, and not done.
    pub failed: usize,
    /// Done before, and done again as something has changed.
    pub again: usize,
}

/// What happens while a batch works.
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// A frame is written; for how long it kept the device busy, ms.
    Done(&'a Task<'a>, f64),
    /// A frame was done before.
    Skipped(&'a Task<'a>),
    /// A frame that was done before is done again, and why.
    Again(&'a Task<'a>, &'a str),
    /// A frame cannot be done, and why.
    Failed(&'a Task<'a>, &'a Error),
    /// Something that a person should know.
    Note(&'a str),
}

/// Is told each event, and how the frames stand then; by several threads, one at a time.
pub type Watch<'a> = dyn Fn(Event, &Counts) + Sync + 'a;

/// What a batch came to.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// How the frames stand.
    pub counts: Counts,
    /// From the first frame to the last, s.
    pub wall_s: f64,
    /// What each device did.
    pub devices: Vec<Worked>,
    /// The first 1,000 frames that failed, and why.
    pub failures: Vec<(String, String)>,
    /// Why frames were left that could have been begun.
    pub stopped_by: Option<Error>,
}

/// Frames of which [`Outcome::failures`] says why they failed, at most.
pub const FAILURES_MAX: usize = 1000;

/// A program that renders lists on a Ray cluster, shard by shard.
pub const RAY_DRIVER: &str = include_str!("batch/ray_driver.py");

/// A list of jobs, read and checked: nothing is written yet.
pub struct Batch {
    jobs: Jobs,
    paths: Paths,
    /// Manifests that are there.
    earlier: Vec<PathBuf>,
    library: Library,
    /// Files that are written beside the frames.
    beside: Vec<(PathBuf, Kind)>,
}

impl Batch {
    /// Reads a list of jobs, and checks all files that it writes. `beside` are more files that the caller writes.
    ///
    /// # Errors
    /// [`Error::Input`] for what is wrong with the list, or for a file that must not be replaced; [`Error::Work`] for one that cannot be
    /// written.
    pub fn open(list: &Path, shard: Option<Shard>, beside: Vec<(PathBuf, Kind)>) -> Result<Batch> {
        let (jobs, inputs) = noted(|| Jobs::read(list));
        let jobs = jobs?;
        let paths = Paths::of(list, shard);
        let earlier = paths.others();
        let library = Library::default();
        let checks = Checks { beside: &beside, list, jobs: &jobs, paths: &paths, earlier: &earlier, inputs: &inputs };
        checks.run(&library)?;
        Ok(Batch { jobs, paths, earlier, library, beside })
    }

    /// Takes up the frames of the list, or of a shard of it: opens the devices and the manifest.
    ///
    /// # Errors
    /// [`Error::Work`] where an adapter or the manifest cannot be opened.
    pub fn start(&self, options: &BatchOptions) -> Result<Started<'_>> {
        let costs = || Costs::read(&self.paths.whole);
        let own = options.shard.map(|shard| shard::share(&self.jobs, shard, &costs()?)).transpose()?;
        let workers = Worker::open_all(options.adapters.as_deref())?;
        let manifest = Manifest::open(&self.paths.own, &self.earlier, options.resume)?;
        if options.resume {
            let more = self.beside.iter().filter_map(|(path, _)| folder_of(path));
            folders(&self.jobs)?.into_iter().chain(more).try_for_each(|folder| clear_up(&folder))?;
        }
        Ok(Started { batch: self, options: options.clone(), own, workers, manifest })
    }

    /// Has the manifest of the list know of all that is done by its shards.
    ///
    /// # Errors
    /// [`Error::Work`] where the manifest cannot be opened.
    pub fn gather(&self) -> Result<Gathered<'_>> {
        let manifest = Manifest::open(&self.paths.whole, &self.earlier, true)?;
        let mut gathered = Gathered { batch: self, manifest, frames: 0, missing: Vec::new() };
        for task in self.jobs.tasks() {
            gathered.frames += 1;
            if gathered.manifest.standing(&task)? == Standing::Done {
                gathered.manifest.adopt(&task)?;
            } else {
                gathered.manifest.forget(&task)?;
                gathered.missing.push(task.name);
            }
        }
        Ok(gathered)
    }
}

/// What the shards of a list have done.
pub struct Gathered<'a> {
    batch: &'a Batch,
    manifest: Manifest,
    /// All frames of the list.
    pub frames: usize,
    /// The names of those that are not done.
    pub missing: Vec<String>,
}

impl Gathered<'_> {
    /// Each frame of the list, and what is known of it where it is done.
    pub fn each(&self) -> impl Iterator<Item = Result<(Task<'_>, Option<Done>)>> {
        each(shard::tasks(&self.batch.jobs, None), &self.manifest)
    }
}

/// A batch whose devices are open.
pub struct Started<'a> {
    batch: &'a Batch,
    options: BatchOptions,
    /// Of each frame of the list whether it is to be done here; `None`: all are.
    own: Option<Vec<bool>>,
    workers: Vec<Worker>,
    manifest: Manifest,
}

impl Started<'_> {
    /// The number of frames that are to be done here.
    pub fn frames(&self) -> usize {
        self.own.as_ref().map_or_else(|| self.batch.jobs.count(), |own| own.iter().filter(|own| **own).count())
    }

    /// Works until there is nothing left to do. A frame that fails is told to `watch`, and the rest go on.
    ///
    /// # Errors
    /// [`Error::Work`] where no thread can be had.
    pub fn run(&mut self, watch: &Watch) -> Result<Outcome> {
        let (jobs, own, frames) = (&self.batch.jobs, self.own.clone(), self.frames());
        let run = Run::new(shard::tasks(jobs, own), frames, &self.manifest, &self.batch.library, &self.options, watch);
        if self.workers.iter().any(|worker| !worker.has_adapter()) && jobs.need_adapter()? {
            run.note(&format!("{NO_ADAPTER}; frames are rendered on the CPU as --engine reference does"));
        }
        let started = Instant::now();
        run.work(&mut self.workers, self.options.writers.unwrap_or_else(cores))?;
        let wall_s = started.elapsed().as_secs_f64();
        let (counts, failures, stopped_by) = run.end();
        let devices = self.workers.iter().map(|worker| worker.worked(wall_s)).collect();
        Ok(Outcome { counts, wall_s, devices, failures, stopped_by })
    }

    /// Each frame that was to be done here, and what is known of it where it is done.
    pub fn each(&self) -> impl Iterator<Item = Result<(Task<'_>, Option<Done>)>> {
        each(shard::tasks(&self.batch.jobs, self.own.clone()), &self.manifest)
    }
}

fn each<'a>(
    tasks: impl Iterator<Item = Task<'a>>,
    manifest: &Manifest,
) -> impl Iterator<Item = Result<(Task<'a>, Option<Done>)>> {
    tasks.map(|task| manifest.done(&task).map(|done| (task, done)))
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn taken<T>(mutex: Mutex<T>) -> T {
    mutex.into_inner().unwrap_or_else(PoisonError::into_inner)
}
