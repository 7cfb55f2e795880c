//! The queue of frames to render. A thread takes a frame and may give it back for another thread.

use super::list::Task;
use super::lock;
use std::sync::{Condvar, Mutex, PoisonError};

pub struct Queue<'a> {
    state: Mutex<State<'a>>,
    changed: Condvar,
}

struct State<'a> {
    tasks: Box<dyn Iterator<Item = Task<'a>> + Send + 'a>,
    given_back: Vec<Task<'a>>,
    /// Frames taken, and neither done nor given back.
    running: usize,
    is_stopped: bool,
}

impl<'a> Queue<'a> {
    pub fn new(tasks: Box<dyn Iterator<Item = Task<'a>> + Send + 'a>) -> Queue<'a> {
        let state = State { tasks, given_back: Vec::new(), running: 0, is_stopped: false };
        Queue { state: Mutex::new(state), changed: Condvar::new() }
    }

    /// The next frame. If the queue is empty, waits while another thread may still give a frame back.
    pub fn next(&self) -> Option<Task<'a>> {
        let mut state = lock(&self.state);
        while !state.is_stopped {
            if let Some(task) = state.given_back.pop().or_else(|| state.tasks.next()) {
                state.running += 1;
                return Some(task);
            }
            if state.running == 0 {
                return None;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        None
    }

    /// Reports that a taken frame is done or has failed.
    pub fn finished(&self) {
        lock(&self.state).running -= 1;
        self.changed.notify_all();
    }

    /// Gives a taken frame back.
    pub fn give_back(&self, task: Task<'a>) {
        let mut state = lock(&self.state);
        state.running -= 1;
        state.given_back.push(task);
        self.changed.notify_all();
    }

    /// Ends the queue: no more frames are handed out.
    pub fn stop(&self) {
        lock(&self.state).is_stopped = true;
        self.changed.notify_all();
    }

    pub fn is_stopped(&self) -> bool {
        lock(&self.state).is_stopped
    }
}
