//! How calls run: without Python's lock, ended by Ctrl-C, with the library's errors as Python's.

use anamorph::Error;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// How long a call may go on after Ctrl-C.
const SIGNALS_EVERY: Duration = Duration::from_millis(50);

/// Remedies as the program and scene files write them, and as Python does.
const REMEDIES: [(&str, &str); 3] = [
    ("give width and height in [image] or --size", "give size=(width, height)"),
    ("use a smaller --size", "use a smaller size"),
    ("use --engine reference", "use Renderer(reference=True)"),
];

pub fn python_error(error: Error) -> PyErr {
    let text = REMEDIES.iter().fold(error.to_string(), |text, (theirs, own)| text.replace(theirs, own));
    match error {
        Error::Input(_) => PyValueError::new_err(text),
        Error::Missing(_) => PyFileNotFoundError::new_err(text),
        Error::Read(_) | Error::Write(_) | Error::Full(_) => PyOSError::new_err(text),
        Error::Work(_) => PyRuntimeError::new_err(text),
    }
}

/// What a thread does.
type Work = Box<dyn FnOnce() + Send>;

/// Threads that wait for work, by what gives it to them.
type Idle = Arc<Mutex<Vec<Sender<Work>>>>;

/// Idle threads of the process of this id. It is locked only while Python's lock is held, as that is when Python forks: the new process finds it
/// unlocked.
static IDLE: Mutex<Option<(u32, Idle)>> = Mutex::new(None);

/// Idle threads of this process. A process that was forked has none of its parent's threads, and starts its own.
fn idle(_: Python<'_>) -> Idle {
    let process = std::process::id();
    let mut kept = IDLE.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, own)) = kept.as_ref().filter(|(of, _)| *of == process) {
        return own.clone();
    }
    let own = Idle::default();
    // the parent's senders are not dropped here: they would wake threads that are not in this process
    std::mem::forget(kept.replace((process, own.clone())));
    own
}

/// Does the work on another thread. After Ctrl-C the call ends, and the work goes on to its end unseen.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> anamorph::Result<T> + Send + 'static,
) -> PyResult<T> {
    let mut waiting = begin(py, work);
    loop {
        let waiting = &mut waiting;
        match py.detach(move || waiting.recv_timeout(SIGNALS_EVERY)) {
            Ok(result) => return result.map_err(python_error),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => return Err(defect()),
        }
    }
}

/// Does the work on another thread. Ctrl-C waits for its end.
pub fn finish<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> anamorph::Result<T> + Send + 'static,
) -> PyResult<T> {
    let waiting = begin(py, work);
    match py.detach(move || waiting.recv()) {
        Ok(result) => result.map_err(python_error),
        Err(_) => Err(defect()),
    }
}

fn defect() -> PyErr {
    PyRuntimeError::new_err("a defect of anamorph ended the call; please report it")
}

fn begin<T: Send + 'static>(py: Python<'_>, work: impl FnOnce() -> T + Send + 'static) -> Receiver<T> {
    let (done, waiting) = channel();
    start(
        &idle(py),
        Box::new(move || {
            // no one may be waiting any more
            let _ = done.send(work());
        }),
    );
    waiting
}

/// Gives work to a thread that waits for some, or to a new one: a thread that worked before has its memory at hand.
fn start(idle: &Idle, mut work: Work) {
    loop {
        let Some(thread) = idle.lock().unwrap_or_else(PoisonError::into_inner).pop() else { break };
        match thread.send(work) {
            Ok(()) => return,
            Err(unsent) => work = unsent.0,
        }
    }
    let (give, given) = channel::<Work>();
    let idle = idle.clone();
    std::thread::spawn(move || {
        // Loops that this thread starts run on threads of its own. Rayon's global pool is started once and is dead in a forked process,
        // where its loops would wait for ever; without threads for another pool it is used all the same.
        let _pool = rayon::ThreadPoolBuilder::new().use_current_thread().build();
        loop {
            work();
            idle.lock().unwrap_or_else(PoisonError::into_inner).push(give.clone());
            work = match given.recv() {
                Ok(next) => next,
                Err(_) => return,
            };
        }
    });
}

/// The process that opened a device or a server.
#[derive(Clone, Copy)]
pub struct Opener(u32);

impl Opener {
    pub fn this_process() -> Opener {
        Opener(std::process::id())
    }

    /// Whether this process was forked from the opener. What was opened must then not be dropped: its threads, for whose end that
    /// would wait, are not in this process.
    pub fn is_parent(self) -> bool {
        self.0 != std::process::id()
    }
}
