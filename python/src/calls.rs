//! How calls run: without Python's lock, ended by Ctrl-C, with the library's errors as Python's.

use anamorph::Error;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

const FORKED: &str = "this process was forked from one that had called anamorph, whose threads are not in it; start processes by \
                      multiprocessing.get_context(\"spawn\"), or call anamorph in the new ones only";

/// How long a call may go on after Ctrl-C.
const SIGNALS_EVERY: Duration = Duration::from_millis(50);

pub fn python_error(error: Error) -> PyErr {
    let text = error.to_string();
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
static IDLE: Mutex<Vec<Sender<Work>>> = Mutex::new(Vec::new());

/// The process whose calls have started threads; 0: none has.
static PROCESS: AtomicU32 = AtomicU32::new(0);

/// Does the work on another thread. After Ctrl-C the call ends, and the work goes on to its end unseen.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> anamorph::Result<T> + Send + 'static,
) -> PyResult<T> {
    let own = std::process::id();
    let first = PROCESS.compare_exchange(0, own, Ordering::SeqCst, Ordering::SeqCst);
    if first.is_err_and(|other| other != own) {
        return Err(PyRuntimeError::new_err(FORKED));
    }
    let (done, mut waiting) = channel();
    start(Box::new(move || {
        // no one may be waiting any more
        let _ = done.send(work());
    }));
    loop {
        let waiting = &mut waiting;
        match py.detach(move || waiting.recv_timeout(SIGNALS_EVERY)) {
            Ok(result) => return result.map_err(python_error),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("a defect of anamorph ended the call; please report it"));
            }
        }
    }
}

/// Gives work to a thread that waits for some, or to a new one: a thread that worked before has its memory at hand.
fn start(mut work: Work) {
    let waiting = || IDLE.lock().unwrap_or_else(PoisonError::into_inner);
    loop {
        let Some(thread) = waiting().pop() else { break };
        match thread.send(work) {
            Ok(()) => return,
            Err(unsent) => work = unsent.0,
        }
    }
    let (give, given) = channel::<Work>();
    std::thread::spawn(move || {
        loop {
            work();
            IDLE.lock().unwrap_or_else(PoisonError::into_inner).push(give.clone());
            work = match given.recv() {
                Ok(next) => next,
                Err(_) => return,
            };
        }
    });
}
