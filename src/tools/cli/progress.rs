//! Progress on stderr, if work takes long: a spinner on a terminal, otherwise a line every few seconds.

use super::say::note;
use crate::parallel::share::Share;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How long work takes before the spinner appears.
const SILENT: Duration = Duration::from_secs(1);
/// Time between two pictures of the spinner.
const TICK: Duration = Duration::from_millis(100);
/// Time before the first line and between lines.
const LINES: Duration = Duration::from_secs(5);

/// Every progress line starts with this.
const START: &str = "progress: ";

/// A thread that shows progress until this is dropped, and what tells it of more.
pub struct Shown<T>(Option<(Sender<T>, JoinHandle<()>)>);

impl<T: Send + 'static> Shown<T> {
    fn start(show: impl FnOnce(&Receiver<T>) + Send + 'static) -> Shown<T> {
        let (sender, receiver) = channel();
        Shown(Some((sender, std::thread::spawn(move || show(&receiver)))))
    }
}

impl<T> Drop for Shown<T> {
    fn drop(&mut self) {
        if let Some((sender, thread)) = self.0.take() {
            // the thread ends with the sender
            drop(sender);
            // the panic hook has reported a panic there
            let _ = thread.join();
        }
    }
}

/// Shows the current step until it is dropped.
pub struct Progress(Shown<Step>);

/// A step, and how much of it is done where that is known.
pub struct Step {
    doing: String,
    share: Option<Share>,
}

impl Step {
    fn of(doing: &str) -> Step {
        Step { doing: doing.into(), share: None }
    }

    /// The stage of the work, or else the step.
    fn name(&self) -> &str {
        let stage = self.share.as_ref().map_or("", Share::stage);
        if stage.is_empty() { &self.doing } else { stage }
    }

    /// What is done of it and the time left, as ", 35 %, 12 s left"; empty where that is not known.
    fn so_far(&self) -> String {
        let Some(share) = self.share.as_ref().filter(|share| (0.0..1.0).contains(&share.done()) && share.done() > 0.0)
        else {
            return String::new();
        };
        let left = share.left().map_or(String::new(), |left| format!(", {:.0} s left", left.as_secs_f64()));
        // rounded down, so that no more is said than is done
        format!(", {:.0} %{left}", (100.0 * share.done()).floor())
    }
}

impl Progress {
    pub fn start(doing: &str) -> Progress {
        let step = Step::of(doing);
        let show = if std::io::stderr().is_terminal() { show_spinner } else { print_lines };
        Progress(Shown::start(move |messages| show(step, messages)))
    }

    /// Sets the current step.
    pub fn now(&self, doing: &str) {
        self.send(Step::of(doing));
    }

    /// Sets the current step, of which `share` says how much is done.
    pub fn of(&self, doing: &str, share: Share) {
        self.send(Step { share: Some(share), ..Step::of(doing) });
    }

    fn send(&self, step: Step) {
        if let Some((sender, _)) = &self.0.0 {
            // the thread only ends after this sender
            let _ = sender.send(step);
        }
    }
}

/// Shows a spinner until the sender is dropped. Messages replace the step.
fn show_spinner(mut step: Step, messages: &Receiver<Step>) {
    let started = Instant::now();
    loop {
        match messages.recv_timeout(SILENT.saturating_sub(started.elapsed())) {
            Ok(next) => step = next,
            Err(RecvTimeoutError::Timeout) => break,
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
    let style = ProgressStyle::with_template("{spinner} {msg} {elapsed}");
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    let bar = bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
    bar.enable_steady_tick(TICK);
    loop {
        bar.set_message(format!("{}{}", step.name(), step.so_far()));
        match messages.recv_timeout(SILENT) {
            Ok(next) => step = next,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    bar.finish_and_clear();
}

/// Prints lines until the sender is dropped. Messages replace the step.
fn print_lines(mut step: Step, messages: &Receiver<Step>) {
    let started = Instant::now();
    receive_and_tick(messages, |message| match message {
        Some(next) => step = next,
        None => print_line(format_args!("{}, {} s{}", step.name(), started.elapsed().as_secs(), step.so_far())),
    });
}

/// Calls `handle` with each message, and with `None` each time that a line is due, until the sender is dropped.
fn receive_and_tick<T>(messages: &Receiver<T>, mut handle: impl FnMut(Option<T>)) {
    let started = Instant::now();
    let mut next_line = LINES;
    loop {
        match messages.recv_timeout(next_line.saturating_sub(started.elapsed())) {
            Ok(message) => handle(Some(message)),
            Err(RecvTimeoutError::Timeout) => {
                handle(None);
                next_line = started.elapsed() + LINES;
            }
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

fn print_line(line: impl std::fmt::Display) {
    note(format_args!("{START}{line}"));
}

/// Prints progress lines to stderr until the result is dropped. `line` gives the text of each; `None` prints nothing.
pub fn progress_lines(line: impl Fn() -> Option<String> + Send + 'static) -> Shown<()> {
    Shown::start(move |messages| receive_and_tick(messages, |_| line().into_iter().for_each(print_line)))
}
