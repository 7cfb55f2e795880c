//! Batches: lists of jobs that render many frames of many scenes. Threads read, render and write frames in parallel. Finished frames are
//! recorded in a manifest. If a frame fails, its error is reported and the others continue.

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
use crate::input::{Error, Limits, Loading, Result};
use crate::scene::library::Library;
use checks::Checks;
use list::Jobs;
pub use list::Task;
#[cfg(feature = "cli")]
pub use manifest::Done;
use manifest::Status;
use manifest::{Costs, Manifest};
use paths::{Paths, folder_of, folders};
use run::Run;
pub use shard::Shard;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;
pub use worker::Worked;
use worker::Worker;

/// Options of a batch.
#[derive(Debug, Clone, Default)]
pub struct BatchOptions {
    /// Skip frames that the manifest beside the list records as done and whose inputs have not changed.
    pub resume: bool,
    /// Render only this part of the list.
    pub shard: Option<Shard>,
    /// Number of threads that write frames; `None`: one per core.
    pub writers: Option<usize>,
    /// Parts of adapters' names, their numbers from 0, or `all`; `None`: the first.
    pub adapters: Option<Vec<String>>,
    /// Stop at the first frame that fails.
    pub fail_fast: bool,
}

/// Numbers of frames by status.
#[derive(Debug, Clone, Copy, Default)]
pub struct Counts {
    /// All frames of this run.
    pub all: usize,
    /// Rendered in this run.
    pub done: usize,
    /// Rendered by an earlier run.
    pub skipped: usize,
    /// Failed.
    pub failed: usize,
    /// Rendered again because an input has changed.
    pub again: usize,
}

/// An event of a running batch.
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// A frame is written; its time on the device, ms.
    Done(&'a Task<'a>, f64),
    /// A frame was rendered by an earlier run.
    Skipped(&'a Task<'a>),
    /// A frame is rendered again, and the reason.
    Again(&'a Task<'a>, &'a str),
    /// A frame failed, and its error.
    Failed(&'a Task<'a>, &'a Error),
    /// A note for the user.
    Note(&'a str),
}

/// Receives each event and the counts after it. Called by several threads, one at a time.
pub type Watch<'a> = dyn Fn(Event, &Counts) + Sync + 'a;

/// The result of a batch.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Numbers of frames by status.
    pub counts: Counts,
    /// Wall time from the first frame to the last, s.
    pub wall_s: f64,
    /// Statistics of each device.
    pub devices: Vec<Worked>,
    /// Names and errors of the first 1,000 frames that failed.
    pub failures: Vec<(String, String)>,
    /// The error that stopped the batch early.
    pub stopped_by: Option<Error>,
}

/// Most entries of [`Outcome::failures`].
pub const FAILURES_MAX: usize = 1000;

/// A program that renders lists on a Ray cluster, shard by shard.
#[cfg(feature = "cli")]
pub const RAY_DRIVER: &str = include_str!("batch/ray_driver.py");

/// A list of jobs, read and checked. Nothing is written yet.
pub struct Batch {
    jobs: Jobs,
    paths: Paths,
    /// Existing manifests.
    earlier: Vec<PathBuf>,
    library: Library,
    /// Files written in addition to the frames.
    beside: Vec<(PathBuf, Kind)>,
    limits: Limits,
}

impl Batch {
    /// Reads a list of jobs and checks all output files, including those of the caller in `beside`. The list and all of its frames are within
    /// `limits`.
    ///
    /// # Errors
    /// [`Error::Input`] if the list is wrong or a file must not be replaced; [`Error::Write`] if a file cannot be written.
    pub fn open(list: &Path, shard: Option<Shard>, beside: Vec<(PathBuf, Kind)>, limits: Limits) -> Result<Batch> {
        let loading = Loading::new(limits);
        let jobs = Jobs::read(list, &loading)?;
        let inputs = loading.into_inputs();
        let paths = Paths::of(list, shard);
        let earlier = paths.others();
        let batch = Batch { jobs, paths, earlier, library: Library::default(), beside, limits };
        Checks { batch: &batch, list, inputs: &inputs }.run()?;
        Ok(batch)
    }

    /// Opens the devices and the manifest for the list, or for a shard of it.
    ///
    /// # Errors
    /// [`Error::Work`] if an adapter or the manifest cannot be opened.
    pub fn start(&self, options: &BatchOptions) -> Result<Started<'_>> {
        let costs = || Costs::read(&self.paths.whole);
        let own = options.shard.map(|shard| shard::share(&self.jobs, shard, &costs()?)).transpose()?;
        let workers = Worker::open_all(options.adapters.as_deref())?;
        let manifest = Manifest::open(&self.paths.own, &self.earlier, options.resume)?;
        if options.resume {
            let more = self.beside.iter().filter_map(|(path, _)| folder_of(path));
            folders(&self.jobs)?.into_iter().chain(more).try_for_each(|folder| clear_up(&folder))?;
        }
        Ok(Started { frames: Frames { batch: self, own, manifest }, options: options.clone(), workers })
    }

    /// Merges the manifests of all shards into that of the list. Also returns the names of the frames that are not done.
    ///
    /// # Errors
    /// [`Error::Work`] if the manifest cannot be opened.
    pub fn gather(&self) -> Result<(Frames<'_>, Vec<String>)> {
        let manifest = Manifest::open(&self.paths.whole, &self.earlier, true)?;
        let mut missing = Vec::new();
        for task in self.jobs.tasks() {
            if manifest.status(&task)? == Status::Done {
                manifest.adopt(&task)?;
            } else {
                manifest.forget(&task)?;
                missing.push(task.name);
            }
        }
        Ok((Frames { batch: self, own: None, manifest }, missing))
    }
}

/// Frames of a list, and the manifest that says which of them are done.
pub struct Frames<'a> {
    batch: &'a Batch,
    /// For each frame of the list whether it is one of these; `None`: all are.
    own: Option<Vec<bool>>,
    manifest: Manifest,
}

impl<'a> Frames<'a> {
    /// Number of these frames.
    pub fn count(&self) -> usize {
        self.own.as_ref().map_or_else(|| self.batch.jobs.count(), |own| own.iter().filter(|own| **own).count())
    }

    fn tasks(&self) -> Box<dyn Iterator<Item = Task<'a>> + Send + 'a> {
        let tasks = self.batch.jobs.tasks();
        match self.own.clone() {
            Some(own) => Box::new(tasks.filter(move |task| own[task.index])),
            None => Box::new(tasks),
        }
    }

    /// Each frame with its manifest entry if it is done.
    #[cfg(feature = "cli")]
    pub fn each(&self) -> impl Iterator<Item = Result<(Task<'a>, Option<Done>)>> {
        self.tasks().map(|task| self.manifest.done(&task).map(|done| (task, done)))
    }
}

/// A batch whose devices are open.
pub struct Started<'a> {
    pub frames: Frames<'a>,
    options: BatchOptions,
    workers: Vec<Worker>,
}

impl Started<'_> {
    /// Renders all frames. A failed frame is reported to `watch`; the others continue.
    ///
    /// # Errors
    /// [`Error::Work`] if no thread can be started.
    pub fn run(&mut self, watch: &Watch) -> Result<Outcome> {
        let run = Run::new(&self.frames, &self.options, watch);
        if self.workers.iter().any(|worker| !worker.has_adapter()) && self.frames.batch.jobs.need_adapter()? {
            run.note(&format!("{NO_ADAPTER}; frames are rendered on the CPU as --engine reference does"));
        }
        let started = Instant::now();
        run.work(&mut self.workers)?;
        let wall_s = started.elapsed().as_secs_f64();
        let (counts, failures, stopped_by) = run.end();
        let devices = self.workers.iter().map(|worker| worker.worked(wall_s)).collect();
        Ok(Outcome { counts, wall_s, devices, failures, stopped_by })
    }
}

/// Locks even if a thread panicked while it held the lock: each statement leaves the data consistent.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn taken<T>(mutex: Mutex<T>) -> T {
    mutex.into_inner().unwrap_or_else(PoisonError::into_inner)
}
