//! Memory for frames that are on their way: one always has room, more as long as all fit.

use crate::input::limits::memory;
use std::sync::{Arc, Condvar, Mutex, PoisonError};

pub struct Slots {
    most: u64,
    used: Mutex<u64>,
    freed: Condvar,
}

/// Bytes of a frame, until this is dropped.
pub struct Slot {
    room: Arc<Slots>,
    bytes: u64,
}

/// What there is where the system does not say.
const UNKNOWN: u64 = 1 << 30;

impl Slots {
    /// Half of what is free.
    pub fn of_this_machine() -> Arc<Slots> {
        Slots::new(memory::free().unwrap_or(UNKNOWN) / 2)
    }

    fn new(most: u64) -> Arc<Slots> {
        Arc::new(Slots { most, used: Mutex::new(0), freed: Condvar::new() })
    }

    /// Waits until there is room for so many bytes, or nothing else has any.
    pub fn hold(self: &Arc<Slots>, bytes: u64) -> Slot {
        let used = self.used.lock().unwrap_or_else(PoisonError::into_inner);
        let is_taken = |used: &mut u64| *used > 0 && *used + bytes > self.most;
        let mut used = self.freed.wait_while(used, is_taken).unwrap_or_else(PoisonError::into_inner);
        *used += bytes;
        Slot { room: self.clone(), bytes }
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        *self.room.used.lock().unwrap_or_else(PoisonError::into_inner) -= self.bytes;
        self.room.freed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::Duration;

    #[test]
    fn frames_wait_until_they_fit_and_one_always_does() {
        let room = Slots::new(100);
        let (now, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            for _ in 0..12 {
                scope.spawn(|| {
                    let _held = room.hold(40);
                    most.fetch_max(1 + now.fetch_add(1, Ordering::SeqCst), Ordering::SeqCst);
                    std::thread::sleep(Duration::from_millis(5));
                    now.fetch_sub(1, Ordering::SeqCst);
                });
            }
        });
        assert_eq!((most.into_inner(), *room.used.lock().unwrap()), (2, 0));
        drop(room.hold(1000));
    }
}
