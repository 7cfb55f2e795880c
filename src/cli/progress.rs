//! Progress on stderr: a line that changes where a person sits at a terminal, else a line now and then; only once the work takes long.

use super::say::note;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How long the work goes on in silence, on a terminal.
const SILENT: Duration = Duration::from_secs(1);
/// Time between two pictures of the spinner.
const TICK: Duration = Duration::from_millis(100);
/// Time between two lines elsewhere; the first comes after as long.
const LINES: Duration = Duration::from_secs(5);

/// What such a line starts with.
const START: &str = "progress: ";

/// A line that says what is being done; gone when this is dropped.
pub struct Progress {
    shown: Option<(Sender<String>, JoinHandle<()>)>,
}

impl Progress {
    pub fn start(doing: &str) -> Progress {
        let (sender, receiver) = channel::<String>();
        let doing = doing.to_owned();
        let shows = if std::io::stderr().is_terminal() { spin } else { tell };
        let thread = std::thread::spawn(move || shows(doing, &receiver));
        Progress { shown: Some((sender, thread)) }
    }

    /// Says what is done from now on.
    pub fn now(&self, doing: &str) {
        if let Some((sender, _)) = &self.shown {
            // the thread only ends after this sender
            let _ = sender.send(doing.into());
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        end(self.shown.take());
    }
}

fn spin(mut doing: String, told: &Receiver<String>) {
    let started = Instant::now();
    loop {
        match told.recv_timeout(SILENT.saturating_sub(started.elapsed())) {
            Ok(next) => doing = next,
            Err(RecvTimeoutError::Timeout) => break,
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
    let style = ProgressStyle::with_template("{spinner} {msg} {elapsed}");
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    let bar = bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
    bar.set_message(doing);
    bar.enable_steady_tick(TICK);
    told.iter().for_each(|next| bar.set_message(next));
    bar.finish_and_clear();
}

fn tell(mut doing: String, told: &Receiver<String>) {
    let started = Instant::now();
    now_and_then(told, |next| match next {
        Some(next) => doing = next,
        None => say(format_args!("{doing}, {} s", started.elapsed().as_secs())),
    });
}

/// Hears what is told, and `None` each time that a line is due, until whoever tells is gone.
fn now_and_then<T>(told: &Receiver<T>, mut hear: impl FnMut(Option<T>)) {
    let started = Instant::now();
    let mut due = LINES;
    loop {
        match told.recv_timeout(due.saturating_sub(started.elapsed())) {
            Ok(told) => hear(Some(told)),
            Err(RecvTimeoutError::Timeout) => {
                hear(None);
                due = started.elapsed() + LINES;
            }
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

/// Puts such a line on stderr.
fn say(line: impl std::fmt::Display) {
    note(format_args!("{START}{line}"));
}

/// Lines that are put on stderr until this is dropped.
pub struct Lines {
    shown: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Lines {
    /// `line` makes one each time that it is due, if there is something to say.
    pub fn start(line: impl Fn() -> Option<String> + Send + 'static) -> Lines {
        let (sender, receiver) = channel();
        let thread = std::thread::spawn(move || {
            now_and_then(&receiver, |_| {
                line().into_iter().for_each(say);
            });
        });
        Lines { shown: Some((sender, thread)) }
    }
}

impl Drop for Lines {
    fn drop(&mut self) {
        end(self.shown.take());
    }
}

/// Waits for a thread that ends with its sender.
fn end<T>(shown: Option<(Sender<T>, JoinHandle<()>)>) {
    if let Some((sender, thread)) = shown {
        drop(sender);
        // a panic there has been said by the hook
        let _ = thread.join();
    }
}
