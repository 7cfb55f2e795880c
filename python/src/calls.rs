//! How calls run: without Python's lock, ended by Ctrl-C, with the library's errors as Python's.

use anamorph::Error;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

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

/// Does the work on a thread of its own. After Ctrl-C the call ends, and the work goes on to its end unseen.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> anamorph::Result<T> + Send + 'static,
) -> PyResult<T> {
    let (done, mut waiting) = channel();
    std::thread::spawn(move || done.send(work()));
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
