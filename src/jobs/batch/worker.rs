//! A worker keeps one device busy: while it renders a frame, the next one is read, planned and uploaded, and the previous one written.

use super::list::Task;
use super::lock;
use super::run::{Run, guarded};
use super::slots::Slot;
use crate::engine::Engine;
use crate::engine::planned::{Planned, Planner};
use crate::engine::readback::{InFlight, Readback};
use crate::engine::report::Device;
use crate::engine::sequence::Sequence;
use crate::gpu::device::{GpuOptions, NO_ADAPTER, adapters};
use crate::gpu::needs::lacks;
use crate::input::files::Inputs;
use crate::input::{Error, Result};
use crate::jobs::{Backend, Seen, Work};
use serde::Serialize;
use std::collections::VecDeque;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender};
use std::time::{Duration, Instant};

/// A frame after reading.
pub struct Ready<'a> {
    pub task: Task<'a>,
    pub work: Work,
    /// The plan, if other frames may overlap with this one.
    pub planned: Option<Planned>,
    pub inputs: Inputs,
    pub started: Instant,
    _slot: Slot,
}

/// A frame after rendering.
pub struct Taken<'a> {
    pub ready: Ready<'a>,
    pub picture: Picture,
    pub device: Device,
    /// Device time, ms.
    pub ms: f64,
}

pub enum Picture {
    Readback(Box<Readback>),
    Seen(Box<Seen>),
}

/// One device: the half of its reading threads and that of its rendering thread.
pub struct Worker {
    pub reader: Reader,
    pub driver: Driver,
}

/// A frame fails after losing the device this often.
const LOSSES_MAX: u32 = 2;

/// Attempts to reopen a lost device, and the pauses before them.
const REOPEN: u32 = 5;
const REOPEN_PAUSE: Duration = Duration::from_millis(500);

/// Statistics of a device in a batch.
#[derive(Debug, Clone, Serialize)]
pub struct Worked {
    /// The adapter's name, or cpu.
    pub adapter: String,
    /// Time with frames in flight, s.
    pub busy_s: f64,
    /// The same relative to the batch's time.
    pub busy_share: f64,
    /// Number of times it was lost and reopened.
    pub reopened: u32,
}

impl Worker {
    /// One worker per named adapter: a part of its name, its index from 0, or `all`.
    pub fn open_all(adapters: Option<&[String]>) -> Result<Vec<Worker>> {
        let named = |name: &String| match name.parse() {
            Ok(skipped) => GpuOptions { skipped, ..GpuOptions::default() },
            Err(_) => GpuOptions { adapter: Some(name.clone()), ..GpuOptions::default() },
        };
        let options = match adapters {
            None | Some([]) => vec![GpuOptions::default()],
            Some([all]) if all == "all" => all_adapters(),
            Some(names) => names.iter().map(named).collect(),
        };
        options.into_iter().map(Worker::open).collect()
    }

    pub fn open(options: GpuOptions) -> Result<Worker> {
        let engine = Engine::open(&options)?;
        let planner = engine.as_ref().map(Engine::planner);
        let driver = Driver {
            options,
            name: engine.as_ref().map_or("cpu".into(), |engine| engine.gpu.info.name.clone()),
            engine,
            sequence: Sequence::default(),
            until: Instant::now(),
            busy: Duration::ZERO,
            reopened: 0,
            is_uncertain: false,
        };
        Ok(Worker { reader: Reader { last: Mutex::default(), planner, is_gone: AtomicBool::new(false) }, driver })
    }

    pub fn has_adapter(&self) -> bool {
        self.driver.engine.is_some()
    }

    #[cfg(test)]
    pub fn gpu(&self) -> Option<std::sync::Arc<crate::gpu::Gpu>> {
        self.driver.engine.as_ref().map(|engine| engine.gpu.clone())
    }

    /// From now on none like its device will be found.
    #[cfg(test)]
    pub fn lose_adapter(&mut self) {
        self.driver.options.adapter = Some("none that is there".into());
    }

    /// Its statistics over a time, s.
    pub fn worked(&self, wall_s: f64) -> Worked {
        let Driver { name, busy, reopened, .. } = &self.driver;
        let busy_s = busy.as_secs_f64();
        Worked { adapter: name.clone(), busy_s, busy_share: busy_s / wall_s, reopened: *reopened }
    }
}

/// Reads and plans frames for a worker.
pub struct Reader {
    /// The last planned frame.
    last: Mutex<Option<Planned>>,
    planner: Option<Planner>,
    /// The device is lost for good.
    is_gone: AtomicBool,
}

impl Reader {
    /// Reads frames until the queue ends or the device is lost for good.
    pub fn run<'a>(&self, run: &Run<'a>, ready: &SyncSender<Ready<'a>>) {
        while !self.is_gone.load(Ordering::SeqCst)
            && let Some(task) = run.next()
        {
            match guarded(|| self.read(run, task.clone())) {
                Ok(read) => {
                    if let Err(unsent) = ready.send(read) {
                        return run.queue.give_back(unsent.0.task);
                    }
                }
                Err(e) => run.failed(&task, &e),
            }
        }
    }

    fn read<'a>(&self, run: &Run<'a>, task: Task<'a>) -> Result<Ready<'a>> {
        let started = Instant::now();
        let job = task.job()?;
        let (work, inputs) = Work::read_of_many(job, &run.frames.batch.library)?;
        run.tell_missing(work.missing());
        let slot = run.slots.reserve(work.bytes);
        work.check_memory()?;
        let last = lock(&self.last).clone();
        let planned = match &self.planner {
            Some(planner) => work.plan(planner, last.as_ref())?,
            None => None,
        };
        if let Some(planned) = &planned {
            *lock(&self.last) = Some(planned.clone());
        }
        Ok(Ready { task, work, planned, inputs, started, _slot: slot })
    }
}

/// The device of a worker and its contents.
pub struct Driver {
    options: GpuOptions,
    /// Its adapter.
    name: String,
    /// `None` on a machine without adapters.
    engine: Option<Engine>,
    sequence: Sequence,
    /// End of the last busy time, and total busy time.
    until: Instant,
    busy: Duration,
    reopened: u32,
    /// An error interrupted an update: the device may hold data of two frames.
    is_uncertain: bool,
}

impl Driver {
    /// Renders frames until the channel closes.
    pub fn run<'a>(
        &mut self,
        run: &Run<'a>,
        reader: &Reader,
        ready: &Receiver<Ready<'a>>,
        taken: &SyncSender<Taken<'a>>,
    ) {
        self.until = Instant::now();
        let mut in_flight: Option<(Ready<'a>, InFlight)> = None;
        let mut again: VecDeque<Ready<'a>> = VecDeque::new();
        loop {
            // a frame that lost the device is rendered alone
            let next = match again.pop_front() {
                Some(next) => Some(next),
                None if in_flight.is_some() => ready.try_recv().ok(),
                None => match ready.recv() {
                    Ok(next) => Some(next),
                    Err(_) => return,
                },
            };
            let is_alone = next.as_ref().is_none_or(|next| next.planned.is_none() || next.task.losses > 0);
            let mut lost = Vec::new();
            let mut launched = None;
            if let Some(next) = next.filter(|_| !run.queue.is_stopped()) {
                if is_alone {
                    self.finish(run, in_flight.take(), taken, &mut lost);
                }
                if self.has_lost() {
                    // not the fault of this frame
                    lost.push(next);
                } else {
                    match guarded(|| self.launch(&next, &mut in_flight, run, taken, &mut lost)) {
                        Ok(Launched::InFlight(pending)) => launched = Some((next, *pending)),
                        Ok(Launched::Seen(seen, ms)) => self.hand_on(next, Picture::Seen(seen), ms, taken),
                        Ok(Launched::Not) => lost.push(next),
                        Err(e) => self.fault(run, next, e, &mut lost),
                    }
                }
            }
            let finished = in_flight.take();
            self.finish(run, finished, taken, &mut lost);
            in_flight = launched;
            if self.is_uncertain && !self.has_lost() {
                self.finish(run, in_flight.take(), taken, &mut lost);
                self.sequence.clear();
                self.is_uncertain = false;
            }
            if !lost.is_empty() || self.has_lost() {
                lost.extend(in_flight.take().map(|(ready, _)| ready));
                again.extend(lost);
                if let Err(e) = guarded(|| self.reopen(run)) {
                    reader.is_gone.store(true, Ordering::SeqCst);
                    run.lose_device(e);
                    again.into_iter().chain(ready).for_each(|ready| run.queue.give_back(ready.task));
                    return;
                }
            }
        }
    }

    /// Starts a frame on the device: overlapping with others, or whole.
    fn launch<'a>(
        &mut self,
        next: &Ready<'a>,
        in_flight: &mut Option<(Ready<'a>, InFlight)>,
        run: &Run<'a>,
        taken: &SyncSender<Taken<'a>>,
        lost: &mut Vec<Ready<'a>>,
    ) -> Result<Launched> {
        let (Some(planned), Some(_)) = (&next.planned, self.engine.as_ref()) else {
            let started = Instant::now();
            let mut backend = Backend::of(self.engine.as_mut(), &next.work.job)?;
            let seen = next.work.render(&mut backend)?;
            let ms = self.was_busy(started);
            return Ok(Launched::Seen(Box::new(seen), ms));
        };
        if !self.sequence.show(planned)? {
            // frames in flight use the present contents
            self.finish(run, in_flight.take(), taken, lost);
            if self.has_lost() {
                return Ok(Launched::Not);
            }
            let Some(engine) = self.engine.as_mut() else { return Err(Error::work(NO_ADAPTER)) };
            self.sequence.upload(engine, planned, &next.work.job.run_options())?;
        }
        let Some(engine) = self.engine.as_mut() else { return Err(Error::work(NO_ADAPTER)) };
        Ok(Launched::InFlight(Box::new(self.sequence.start(engine, planned.clone())?)))
    }

    /// Waits for a frame and passes it on. If its lists were too small it is rendered again, alone.
    fn finish<'a>(
        &mut self,
        run: &Run<'a>,
        in_flight: Option<(Ready<'a>, InFlight)>,
        taken: &SyncSender<Taken<'a>>,
        lost: &mut Vec<Ready<'a>>,
    ) {
        let Some((ready, pending)) = in_flight else { return };
        let started = pending.started;
        let waited = guarded(|| match self.engine.as_mut() {
            Some(engine) => self.sequence.wait_for(engine, pending),
            None => Err(Error::work(NO_ADAPTER)),
        });
        match waited {
            Ok(readback) => {
                let ms = self.was_busy(started);
                self.hand_on(ready, Picture::Readback(Box::new(readback)), ms, taken);
            }
            Err(e) => self.fault(run, ready, e, lost),
        }
    }

    fn hand_on<'a>(&self, mut ready: Ready<'a>, picture: Picture, ms: f64, taken: &SyncSender<Taken<'a>>) {
        let device = Backend::device_of(self.engine.as_ref(), &ready.work.job);
        // the uploaded data is not needed any more
        ready.planned = None;
        // who writes is there as long as this is
        let _ = taken.send(Taken { ready, picture, device, ms });
    }

    /// Records a failed frame, unless the device was lost.
    fn fault<'a>(&mut self, run: &Run<'a>, mut ready: Ready<'a>, error: Error, lost: &mut Vec<Ready<'a>>) {
        ready.task.losses += 1;
        self.is_uncertain = true;
        if self.has_lost() && ready.task.losses < LOSSES_MAX {
            lost.push(ready);
        } else {
            run.failed(&ready.task, &error);
        }
    }

    /// The device has reported an error and may be unusable.
    fn has_lost(&self) -> bool {
        self.engine.as_ref().is_some_and(|engine| engine.gpu.failure().is_err())
    }

    fn reopen(&mut self, run: &Run) -> Result<()> {
        let planner = self.engine.as_ref().map(Engine::planner);
        let why = self.engine.as_ref().and_then(|engine| engine.gpu.failure().err());
        self.sequence.clear();
        (self.engine, self.is_uncertain) = (None, false);
        self.reopened += 1;
        run.note(&format!("reopening the lost device: {}", why.map(|e| e.to_string()).unwrap_or_default()));
        let mut opened = Engine::open(&self.options);
        for _ in 1..REOPEN {
            if matches!(&opened, Ok(Some(_))) {
                break;
            }
            std::thread::sleep(REOPEN_PAUSE);
            opened = Engine::open(&self.options);
        }
        let failed = |why: &str| Err(Error::work(format!("the device was lost, and {why}")));
        match opened {
            Ok(Some(engine)) if Some(engine.planner()) == planner => {
                self.engine = Some(engine);
                Ok(())
            }
            Ok(Some(_)) => failed("a different device is present now"),
            Ok(None) => failed("no device is present any more"),
            Err(e) => failed(&format!("it cannot be reopened: {e}")),
        }
    }

    /// Adds the time from a start, or from the end of the last busy time, until now; returns it, ms.
    fn was_busy(&mut self, started: Instant) -> f64 {
        let now = Instant::now();
        let own = now.duration_since(started.max(self.until));
        self.busy += own;
        self.until = now;
        own.as_secs_f64() * 1e3
    }
}

/// The hardware adapters; if there are none, the software ones. Each once, under the best of its backends.
fn all_adapters() -> Vec<GpuOptions> {
    // those that cannot run the kernels come last
    let is_able = |a: &&wgpu::Adapter| lacks(&a.limits()).is_none();
    let infos: Vec<_> = adapters().iter().take_while(is_able).map(wgpu::Adapter::get_info).collect();
    numbers(&infos).into_iter().map(|skipped| GpuOptions { skipped, ..GpuOptions::default() }).collect()
}

/// The numbers of these adapters among all of a machine. One of these ids that another backend has before is the same GPU.
fn numbers(all: &[wgpu::AdapterInfo]) -> Vec<usize> {
    let is_hard = |info: &wgpu::AdapterInfo| info.device_type != wgpu::DeviceType::Cpu;
    let any_hard = all.iter().any(is_hard);
    let ids = |info: &wgpu::AdapterInfo| (info.vendor, info.device);
    let is_known = |k: usize| all[..k].iter().any(|o| ids(o) == ids(&all[k]) && o.backend != all[k].backend);
    let own: Vec<usize> = (0..all.len()).filter(|&k| is_hard(&all[k]) == any_hard && !is_known(k)).collect();
    // without any, the worker finds that out
    if own.is_empty() { vec![0] } else { own }
}

enum Launched {
    InFlight(Box<InFlight>),
    Seen(Box<Seen>, f64),
    /// The device was lost during the previous frame.
    Not,
}

#[test]
fn a_gpu_of_two_backends_works_once() {
    let info =
        |device_type, backend, device| wgpu::AdapterInfo { device, ..wgpu::AdapterInfo::new(device_type, backend) };
    use wgpu::Backend::{Dx12, Vulkan};
    use wgpu::DeviceType::{Cpu, DiscreteGpu, IntegratedGpu};
    let all = [
        info(DiscreteGpu, Vulkan, 1),
        info(DiscreteGpu, Vulkan, 1),
        info(DiscreteGpu, Dx12, 1),
        info(DiscreteGpu, Dx12, 1),
        info(IntegratedGpu, Dx12, 2),
        info(Cpu, Vulkan, 3),
        info(Cpu, Dx12, 4),
    ];
    assert_eq!(numbers(&all), [0, 1, 4]);
    assert_eq!(numbers(&all[5..]), [0, 1]);
    assert_eq!(numbers(&[]), [0]);
}
