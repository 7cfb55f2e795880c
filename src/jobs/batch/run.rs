//! The threads of a batch and their shared state: per device two that read and plan and one that renders, and several that write.

use super::list::Task;
use super::manifest::Status;
use super::queue::Queue;
use super::slots::Slots;
use super::worker::{Picture, Taken, Worker};
use super::{BatchOptions, Counts, Event, FAILURES_MAX, Frames, Watch, lock, taken};
use crate::engine::Rendered;
use crate::engine::left_out::LeftOut;
use crate::geometry::mesh::Missing;
use crate::input::{Error, Result};
use std::collections::HashSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread::{Builder, Scope};

/// Reading threads per device: one plans while the other reads.
const READERS: usize = 2;

/// State shared by all threads of a batch.
pub struct Run<'a> {
    pub queue: Queue<'a>,
    pub frames: &'a Frames<'a>,
    options: &'a BatchOptions,
    watch: &'a Watch<'a>,
    counts: Mutex<Counts>,
    /// Memory for frames between reading and writing.
    pub slots: Arc<Slots>,
    /// Number of workers with a device.
    workers: AtomicUsize,
    stopped_by: Mutex<Option<Error>>,
    /// The first of them.
    failures: Mutex<Vec<(String, String)>>,
    /// Notes on missing files and omissions already reported.
    reported: Mutex<HashSet<String>>,
}

impl<'a> Run<'a> {
    pub fn new(frames: &'a Frames<'a>, options: &'a BatchOptions, watch: &'a Watch<'a>) -> Run<'a> {
        Run {
            queue: Queue::new(frames.tasks()),
            frames,
            options,
            watch,
            counts: Mutex::new(Counts { all: frames.count(), ..Counts::default() }),
            slots: Slots::of_this_machine(frames.batch.limits),
            workers: AtomicUsize::new(0),
            stopped_by: Mutex::default(),
            failures: Mutex::default(),
            reported: Mutex::default(),
        }
    }

    /// Runs all threads until every frame is done.
    pub fn work(&self, workers: &mut [Worker]) -> Result<()> {
        self.workers.store(workers.len(), Ordering::SeqCst);
        let cores = || std::thread::available_parallelism().map_or(1, usize::from);
        let writers = self.options.writers.unwrap_or_else(cores).max(1);
        std::thread::scope(|scope| {
            let start = || {
                let (to_write, taken) = sync_channel(1);
                let taken = Arc::new(Mutex::new(taken));
                for worker in workers {
                    let (to_render, ready) = sync_channel(1);
                    let Worker { reader, driver } = worker;
                    let reader = &*reader;
                    for _ in 0..READERS {
                        let to_render = to_render.clone();
                        named(scope, "read", move || reader.run(self, &to_render))?;
                    }
                    let to_write = to_write.clone();
                    named(scope, "device", move || driver.run(self, reader, &ready, &to_write))?;
                }
                for _ in 0..writers {
                    let taken = taken.clone();
                    named(scope, "write", move || self.write(&taken))?;
                }
                Ok(())
            };
            // the scope ends when all threads do: those that run must not wait for one that never started
            start().inspect_err(|_| self.queue.stop())
        })
    }

    /// Writes frames until the channel closes.
    fn write(&self, frames: &Mutex<Receiver<Taken<'a>>>) {
        loop {
            // the lock is free again before the frame is written
            let next = lock(frames).recv();
            let Ok(Taken { ready, picture, device, ms }) = next else { return };
            let written = guarded(|| {
                let seen = match picture {
                    // from its start others were before it
                    Picture::Readback(read) => ready.work.seen(Rendered { frame_ms: vec![ms], ..read.rendered() }),
                    Picture::Seen(seen) => *seen,
                };
                let written = ready.work.write(seen, &device, ready.started, |_| ())?;
                self.tell_left_out(&written.left_out);
                self.frames.manifest.add(&ready.task, &ready.inputs, &written, ms)
            });
            match written {
                Ok(_) => {
                    self.tell(Event::Done(&ready.task, ms));
                    self.queue.finished();
                }
                Err(e) => self.failed(&ready.task, &e),
            }
        }
    }

    /// The next frame to render.
    pub fn next(&self) -> Option<Task<'a>> {
        loop {
            let task = self.queue.next()?;
            if !self.options.resume {
                return Some(task);
            }
            match self.frames.manifest.status(&task) {
                Ok(Status::New) => return Some(task),
                Ok(Status::Changed(why)) => {
                    self.tell(Event::Again(&task, &why));
                    match self.frames.manifest.forget(&task) {
                        Ok(()) => return Some(task),
                        Err(e) => self.failed(&task, &e),
                    }
                }
                Ok(Status::Done) => {
                    self.tell(Event::Skipped(&task));
                    self.queue.finished();
                }
                Err(e) => self.failed(&task, &e),
            }
        }
    }

    /// Records a failed frame; ends the batch if the disk is full.
    pub fn failed(&self, task: &Task, why: &Error) {
        self.tell(Event::Failed(task, why));
        let mut failures = lock(&self.failures);
        if failures.len() < FAILURES_MAX {
            failures.push((task.name.clone(), why.to_string()));
        }
        drop(failures);
        if matches!(why, Error::Full(_)) {
            self.stop(Error::Full("the disk is full".into()));
        } else if self.options.fail_fast {
            self.queue.stop();
        }
        self.queue.finished();
    }

    /// A worker lost its device for good: others render its frames, if any are left.
    pub fn lose_device(&self, why: Error) {
        if self.workers.fetch_sub(1, Ordering::SeqCst) > 1 {
            self.note(&format!("{why}; other workers continue"));
        } else {
            self.stop(why);
        }
    }

    /// Stops: no new frame begins.
    fn stop(&self, why: Error) {
        lock(&self.stopped_by).get_or_insert(why);
        self.queue.stop();
    }

    pub fn note(&self, line: &str) {
        self.tell(Event::Note(line));
    }

    /// Reports what mesh files lack, once for all frames.
    pub fn tell_missing(&self, missing: &[Missing]) {
        let mut reported = lock(&self.reported);
        let new: Vec<Missing> = missing.iter().filter(|m| reported.insert(m.what.clone())).cloned().collect();
        drop(reported);
        if let Some(line) = Missing::line(&new) {
            self.note(&line);
        }
    }

    /// Reports once that scenes use a style that the reference does not draw.
    fn tell_left_out(&self, left_out: &[LeftOut]) {
        for line in left_out.iter().filter(|left| **left == LeftOut::Style).map(LeftOut::to_string) {
            if lock(&self.reported).insert(line.clone()) {
                self.note(&line);
            }
        }
    }

    /// The counts, the failures, and the error that ended the batch early.
    pub fn end(self) -> (Counts, Vec<(String, String)>, Option<Error>) {
        (taken(self.counts), taken(self.failures), taken(self.stopped_by))
    }

    fn tell(&self, event: Event) {
        // locked during the call, so that events come one at a time and counts only grow
        let mut counts = lock(&self.counts);
        match event {
            Event::Done(..) => counts.done += 1,
            Event::Skipped(..) => counts.skipped += 1,
            Event::Again(..) => counts.again += 1,
            Event::Failed(..) => counts.failed += 1,
            Event::Note(_) => {}
        }
        let told = catch_unwind(AssertUnwindSafe(|| (self.watch)(event, &counts)));
        drop(counts);
        // the threads go on, so that none waits for this frame for ever
        if told.is_err() {
            self.stop(Error::work("the callback that watches the batch panicked; see the line above"));
        }
    }
}

/// A thread with a name, for debuggers and profilers.
fn named<'s>(scope: &'s Scope<'s, '_>, name: &str, work: impl FnOnce() + Send + 's) -> Result<()> {
    let spawned = Builder::new().name(name.into()).spawn_scoped(scope, work);
    spawned.map(drop).map_err(|e| Error::work(format!("cannot start the {name} thread: {e}")))
}

/// Catches a panic as an error, so that the rest of the batch continues.
pub fn guarded<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    let failed = |_| Err(Error::work("internal error (panic); see the line above"));
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(failed)
}
