//! `anamorph batch`: many frames of many scenes. Frames are read, rendered and written at once by threads of their own; what is done is
//! kept in a manifest, and what goes wrong with one frame is said, and the rest go on.

mod board;
mod checks;
mod jobs;
mod manifest;
mod names;
mod paths;
mod queue;
mod results;
mod shard;
mod slots;
#[cfg(test)]
mod tests;
mod worker;

use super::args::{BatchArgs, ProgressName};
use super::outputs;
use super::render::missing_line;
use super::say::print;
use crate::engine::Rendered;
use crate::geometry::mesh::Missing;
use crate::gpu::device::{GpuOptions, NO_ADAPTER, adapters};
use crate::image::{clear_up, write_text};
use crate::input::files::{Inputs, noted};
use crate::input::{Error, Result};
use crate::scene::library::Library;
use board::{Board, Counts};
use checks::Checks;
use crossbeam_channel::{Receiver, bounded};
use jobs::{Jobs, Task};
use manifest::{Costs, Manifest, Standing};
use paths::{Paths, folder_of, folders};
use queue::Queue;
use results::Summary;
use slots::Slots;
use std::collections::HashSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{Builder, Scope};
use std::time::Instant;
use worker::{Picture, Taken, Worker};

/// Frames that the last line names where more have failed, and that the report does.
const NAMED: usize = 10;
const REPORTED: usize = 1000;

/// Threads that read for a device: one plans while the other reads.
const READERS: usize = 2;

/// What `--write-driver` writes.
pub const RAY_DRIVER: &str = include_str!("batch/ray_driver.py");

pub fn run(args: &BatchArgs) -> Result<()> {
    if let Some(path) = &args.write_driver {
        outputs::check(&Inputs::default(), std::iter::once((path.as_path(), outputs::DRIVER)))?;
        return write_text(path, RAY_DRIVER);
    }
    let Some(list) = &args.jobs else { return Err(Error::input("no list of jobs")) };
    let (jobs, inputs) = noted(|| Jobs::read(list));
    let jobs = jobs?;
    let paths = Paths::of(list, args.shard);
    let earlier = paths.others();
    let library = Library::default();
    let checks = Checks { args, list, jobs: &jobs, paths: &paths, earlier: &earlier, inputs: &inputs };
    checks.run(&library)?;
    if args.gather {
        return gather(args, list, &jobs, &Manifest::open(&paths.whole, &earlier, true)?);
    }
    let costs = || Costs::read(&paths.whole);
    let own = args.shard.map(|shard| shard::share(&jobs, shard, &costs()?)).transpose()?;
    let all = own.as_ref().map_or_else(|| jobs.count(), |own| own.iter().filter(|own| **own).count());
    let mut workers = workers(args)?;
    let manifest = Manifest::open(&paths.own, &earlier, args.resume)?;
    if args.resume {
        let more = [&args.report, &args.csv].into_iter().flatten().filter_map(|path| folder_of(path));
        folders(&jobs)?.into_iter().chain(more).try_for_each(|folder| clear_up(&folder))?;
    }
    let board = Board::new(args.progress, args.log.as_deref(), all)?;
    if workers.iter().any(|worker| !worker.has_adapter()) && jobs.need_adapter()? {
        board.note(&format!("{NO_ADAPTER}; frames are rendered on the CPU as --engine reference does"));
    }
    let started = Instant::now();
    let todo = shard::tasks(&jobs, own.clone());
    let batch = Batch::new(list, todo, &manifest, &board);
    let batch = Batch { fail_fast: args.fail_fast, resumes: args.resume, library, ..batch };
    let writers = args.jobs_at_once.map_or_else(cores, usize::from);
    work(&batch, &mut workers, writers)?;
    let wall_s = started.elapsed().as_secs_f64();
    let counts = board.end();
    let (stopped_by, failures) = (taken(batch.stopped_by), taken(batch.failures));
    let tasks = || shard::tasks(&jobs, own.clone());
    if let Some(path) = &args.csv {
        results::write_csv(path, tasks, &manifest)?;
    }
    if let Some(path) = &args.report {
        let devices = workers.iter().map(|worker| worker.worked(wall_s)).collect();
        let summary = Summary::new(counts, wall_s, devices, failures.clone());
        results::write_report(path, &summary, tasks(), &manifest)?;
    }
    outcome(list, args.progress, counts, stopped_by, &failures)
}

/// Has the manifest of the list know of all that is done by its shards.
fn gather(args: &BatchArgs, list: &Path, jobs: &Jobs, manifest: &Manifest) -> Result<()> {
    let (mut all, mut missing, mut named) = (0, 0, Vec::new());
    for task in jobs.tasks() {
        all += 1;
        if manifest.standing(&task)? == Standing::Done {
            manifest.adopt(&task)?;
            continue;
        }
        manifest.forget(&task)?;
        missing += 1;
        if named.len() < NAMED {
            named.push(task.name);
        }
    }
    let tasks = || shard::tasks(jobs, None);
    if let Some(path) = &args.csv {
        results::write_csv(path, tasks, manifest)?;
    }
    if let Some(path) = &args.report {
        let counts = Counts { all, done: all - missing, ..Counts::default() };
        results::write_report(path, &Summary::new(counts, 0.0, Vec::new(), Vec::new()), tasks(), manifest)?;
    }
    if missing == 0 {
        return print(&format!("{}: {}\n", list.display(), frames(all)));
    }
    let more = if missing > NAMED { format!(" and {} more", missing - NAMED) } else { String::new() };
    let (list, named) = (list.display(), named.join("; "));
    Err(Error::work(format!("{list}: {missing} of {all} frames are not done, which --resume does: {named}{more}")))
}

/// Has all threads work until there is nothing left to do.
fn work(batch: &Batch, workers: &mut [Worker], writers: usize) -> Result<()> {
    batch.workers.store(workers.len(), Ordering::SeqCst);
    std::thread::scope(|scope| {
        let (to_write, taken) = bounded(1);
        for worker in workers {
            let (to_render, ready) = bounded(1);
            let (reader, mut driver) = worker.parts();
            for _ in 0..READERS {
                let to_render = to_render.clone();
                named(scope, "read", move || reader.run(batch, &to_render))?;
            }
            let to_write = to_write.clone();
            named(scope, "device", move || driver.run(batch, &ready, &to_write))?;
        }
        for _ in 0..writers {
            let taken = taken.clone();
            named(scope, "write", move || write(batch, &taken))?;
        }
        Ok(())
    })
}

/// A thread that debuggers and profilers know.
fn named<'s>(scope: &'s Scope<'s, '_>, name: &str, work: impl FnOnce() + Send + 's) -> Result<()> {
    let spawned = Builder::new().name(name.into()).spawn_scoped(scope, work);
    spawned.map(drop).map_err(|e| Error::work(format!("no thread to {name} with: {e}")))
}

/// Writes frames until none come any more.
fn write<'a>(batch: &Batch<'a>, taken: &Receiver<Taken<'a>>) {
    for Taken { ready, picture, device, ms } in taken {
        let written = guarded(|| {
            let seen = match picture {
                // from its start others were before it
                Picture::Readback(landed) => ready.work.seen(Rendered { frame_ms: vec![ms], ..landed.rendered() }),
                Picture::Seen(seen) => *seen,
            };
            let written = ready.work.write(seen, &device, ready.started, |_| ())?;
            batch.manifest.add(&ready.task, &ready.inputs, &written, ms)
        });
        match written {
            Ok(_) => batch.done(&ready.task, ms),
            Err(e) => batch.failed(&ready.task, &e),
        }
    }
}

/// What all threads of a batch share.
pub struct Batch<'a> {
    list: &'a Path,
    queue: Queue<'a>,
    manifest: &'a Manifest,
    board: &'a Board,
    library: Library,
    /// For frames that are read and not written yet.
    room: Arc<Slots>,
    resumes: bool,
    fail_fast: bool,
    /// Those that have a device.
    workers: AtomicUsize,
    stopped_by: Mutex<Option<Error>>,
    /// The first of them.
    failures: Mutex<Vec<(String, String)>>,
    /// What mesh files lack and was already reported.
    missing: Mutex<HashSet<String>>,
}

impl<'a> Batch<'a> {
    fn new(
        list: &'a Path,
        tasks: Box<dyn Iterator<Item = Task<'a>> + Send + 'a>,
        manifest: &'a Manifest,
        board: &'a Board,
    ) -> Batch<'a> {
        Batch {
            list,
            queue: Queue::new(tasks),
            manifest,
            board,
            library: Library::default(),
            room: Slots::of_this_machine(),
            resumes: false,
            fail_fast: false,
            workers: AtomicUsize::new(0),
            stopped_by: Mutex::default(),
            failures: Mutex::default(),
            missing: Mutex::default(),
        }
    }

    /// The next frame that is to be done.
    fn next(&self) -> Option<Task<'a>> {
        loop {
            let task = self.queue.next()?;
            if !self.resumes {
                return Some(task);
            }
            match self.manifest.standing(&task) {
                Ok(Standing::New) => return Some(task),
                Ok(Standing::Changed(why)) => {
                    self.board.again(&task, &why);
                    match self.manifest.forget(&task) {
                        Ok(()) => return Some(task),
                        Err(e) => self.failed(&task, &e),
                    }
                }
                Ok(Standing::Done) => {
                    self.board.skipped(&task);
                    self.queue.recheck_samples();
                }
                Err(e) => self.failed(&task, &e),
            }
        }
    }

    fn queue(&self) -> &Queue<'a> {
        &self.queue
    }

    fn library(&self) -> &Library {
        &self.library
    }

    fn room(&self) -> &Arc<Slots> {
        &self.room
    }

    fn done(&self, task: &Task, ms: f64) {
        self.board.done(task, ms);
        self.queue.recheck_samples();
    }

    /// A frame has failed; so will others where there is no room to write to.
    fn failed(&self, task: &Task, error: &Error) {
        self.board.failed(task, self.list, error);
        let mut failures = lock(&self.failures);
        if failures.len() < REPORTED {
            failures.push((task.name.clone(), error.to_string()));
        }
        drop(failures);
        if matches!(error, Error::Full(_)) {
            self.stop(Error::Full("there is no room to write to".into()));
        } else if self.fail_fast {
            self.queue.stop();
        }
        self.queue.recheck_samples();
    }

    /// A worker has no device any more: others do what it has not, if there are any.
    fn lose_station(&self, why: Error) {
        if self.workers.fetch_sub(1, Ordering::SeqCst) > 1 {
            self.note(&format!("{why}; the others go on"));
        } else {
            self.stop(why);
        }
    }

    /// Begins no frame any more.
    fn stop(&self, why: Error) {
        lock(&self.stopped_by).get_or_insert(why);
        self.queue.stop();
    }

    fn note(&self, line: &str) {
        self.board.note(line);
    }

    /// Reports what mesh files lack, once for all frames.
    fn report_missing(&self, missing: &[Missing]) {
        let mut reported = lock(&self.missing);
        let new: Vec<Missing> = missing.iter().filter(|m| reported.insert(m.what.clone())).cloned().collect();
        drop(reported);
        if let Some(line) = missing_line(&new) {
            self.note(&line);
        }
    }
}

fn workers(args: &BatchArgs) -> Result<Vec<Worker>> {
    let named = |name: &String| match name.parse() {
        Ok(passed_over) => GpuOptions { passed_over, ..GpuOptions::default() },
        Err(_) => GpuOptions { adapter: Some(name.clone()), ..GpuOptions::default() },
    };
    let options = match args.adapters.as_deref() {
        None | Some([]) => vec![GpuOptions::default()],
        Some([all]) if all == "all" => all_adapters(),
        Some(names) => names.iter().map(named).collect(),
    };
    options.into_iter().map(Worker::open).collect()
}

/// Those that are no software, unless all are.
fn all_adapters() -> Vec<GpuOptions> {
    let all: Vec<_> = adapters().iter().map(wgpu::Adapter::get_info).collect();
    let is_hard = |info: &&wgpu::AdapterInfo| info.device_type != wgpu::DeviceType::Cpu;
    let count = all.iter().filter(is_hard).count();
    // the fastest kinds come first
    let own = 0..if count > 0 { count } else { all.len().max(1) };
    own.map(|passed_over| GpuOptions { passed_over, ..GpuOptions::default() }).collect()
}

fn frames(count: usize) -> String {
    format!("{count} frame{}", if count == 1 { "" } else { "s" })
}

/// The last line, or what all that went wrong comes to.
fn outcome(
    list: &Path,
    progress: ProgressName,
    counts: Counts,
    stopped_by: Option<Error>,
    failures: &[(String, String)],
) -> Result<()> {
    let Counts { all, done, skipped, failed, .. } = counts;
    let before = if skipped > 0 { format!(", {skipped} before") } else { String::new() };
    if failed == 0 && stopped_by.is_none() {
        let line = format!("{}: {}{before}\n", list.display(), frames(done));
        return if progress.is_for_programs() { Ok(()) } else { print(&line) };
    }
    let left = all - done - skipped - failed;
    let more = if failed > NAMED { format!(" and {} more", failed - NAMED) } else { String::new() };
    let named: Vec<&str> = failures.iter().take(NAMED).map(|(name, _)| name.as_str()).collect();
    let mut text = format!("{}: {done} of {all} frames done{before}", list.display());
    if failed > 0 {
        text += &format!(", {failed} failed: {}{more}", named.join("; "));
    }
    if left > 0 {
        text += &format!("; {left} not begun, which --resume does");
    }
    Err(match stopped_by {
        Some(why) => Error::work(format!("stopped: {why}: {text}")),
        None => Error::work(text),
    })
}

/// Work that may panic, which is no reason for the rest to stop.
fn guarded<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    let failed = |_| Err(Error::work("a defect of this program; the line before says where"));
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(failed)
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
