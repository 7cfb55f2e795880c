//! Memory budget for frames in flight: one is always admitted, more as long as all fit.

use crate::input::Limits;
use std::sync::{Arc, Condvar, Mutex, PoisonError};

pub struct Slots {
    most: u64,
    used: Mutex<u64>,
    freed: Condvar,
}

/// A frame's share of the budget, released on drop.
pub struct Slot {
    slots: Arc<Slots>,
    bytes: u64,
}

/// The budget if the system does not report its free memory.
const UNKNOWN: u64 = 1 << 30;

impl Slots {
    /// Half of the free memory.
    pub fn of_this_machine(limits: Limits) -> Arc<Slots> {
        Slots::new(limits.free_memory().unwrap_or(UNKNOWN) / 2)
    }

    fn new(most: u64) -> Arc<Slots> {
        Arc::new(Slots { most, used: Mutex::new(0), freed: Condvar::new() })
    }

    /// Waits until so many bytes fit, or no other frame is in flight.
    pub fn reserve(self: &Arc<Slots>, bytes: u64) -> Slot {
        let used = self.used.lock().unwrap_or_else(PoisonError::into_inner);
        let is_taken = |used: &mut u64| *used > 0 && *used + bytes > self.most;
        let mut used = self.freed.wait_while(used, is_taken).unwrap_or_else(PoisonError::into_inner);
        *used += bytes;
        Slot { slots: self.clone(), bytes }
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        *self.slots.used.lock().unwrap_or_else(PoisonError::into_inner) -= self.bytes;
        self.slots.freed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::Duration;

    #[test]
    fn frames_wait_until_they_fit_and_one_always_does() {
        let slots = Slots::new(100);
        let (now, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            for _ in 0..12 {
                scope.spawn(|| {
                    let _slot = slots.reserve(40);
                    most.fetch_max(1 + now.fetch_add(1, Ordering::SeqCst), Ordering::SeqCst);
                    std::thread::sleep(Duration::from_millis(5));
                    now.fetch_sub(1, Ordering::SeqCst);
                });
            }
        });
        assert_eq!((most.into_inner(), *slots.used.lock().unwrap()), (2, 0));
        drop(slots.reserve(1000));
    }
}
