//! Progress on stderr: only for a person at a terminal, and only once the work takes longer than a second.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// How long the work goes on in silence.
const SILENT: Duration = Duration::from_secs(1);
/// Time between two pictures of the spinner.
const TICK: Duration = Duration::from_millis(100);

/// A line that says what is being done; gone when this is dropped.
pub struct Progress {
    shown: Option<(Sender<String>, JoinHandle<()>)>,
}

impl Progress {
    pub fn start(doing: &str) -> Progress {
        if !std::io::stderr().is_terminal() {
            return Progress { shown: None };
        }
        let (sender, receiver) = channel::<String>();
        let mut doing = doing.to_owned();
        let thread = std::thread::spawn(move || {
            let started = std::time::Instant::now();
            loop {
                match receiver.recv_timeout(SILENT.saturating_sub(started.elapsed())) {
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
            receiver.iter().for_each(|next| bar.set_message(next));
            bar.finish_and_clear();
        });
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
        if let Some((sender, thread)) = self.shown.take() {
            drop(sender);
            // a panic there has been said by the hook
            let _ = thread.join();
        }
    }
}
