//! How much of some long work is done, and how long the rest may take.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
#[cfg(any(feature = "cli", test))]
use std::time::Duration;
use std::time::Instant;

/// A part of some work. Threads say when it is done; clones are of the same work.
#[derive(Debug, Clone)]
pub struct Share {
    work: Arc<Work>,
    /// The part's fraction of the work.
    weight: f64,
}

#[derive(Debug, Default)]
struct Work {
    /// What is done of it, in [`UNITS`].
    done: AtomicU64,
    /// When its first part was done, and which fraction that was.
    first: OnceLock<(Instant, f64)>,
    /// The stage that it is in; empty where the stage has no name.
    stage: Mutex<&'static str>,
}

/// All of the work. A part is rounded to a unit, so that a billion parts are off by 2^-22 of the work at most.
const UNITS: f64 = (1u64 << 52) as f64;

impl Default for Share {
    /// All of some work.
    fn default() -> Share {
        Share { work: Arc::default(), weight: 1.0 }
    }
}

impl Share {
    /// One of so many equal parts of this part.
    pub fn part_of(&self, parts: usize) -> Share {
        Share { work: self.work.clone(), weight: self.weight / parts.max(1) as f64 }
    }

    /// Says that this part is done.
    pub fn add(&self) {
        let units = (self.weight * UNITS).round() as u64;
        let before = self.work.done.fetch_add(units, Ordering::Relaxed);
        self.work.first.get_or_init(|| (Instant::now(), (before + units) as f64 / UNITS));
    }

    /// Says that the work is in a stage, such as "sorting triangles", from now on.
    pub fn enter(&self, stage: &'static str) {
        *self.work.stage.lock().unwrap_or_else(PoisonError::into_inner) = stage;
    }

    /// The stage that the work is in; empty before it enters one.
    #[cfg(feature = "cli")]
    pub fn stage(&self) -> &'static str {
        *self.work.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The fraction of the work that is done.
    #[cfg(feature = "cli")]
    pub fn done(&self) -> f64 {
        self.work.done.load(Ordering::Relaxed) as f64 / UNITS
    }

    /// How long the rest takes at the pace since the first part was done, which may have waited for kernels to be compiled; `None` until
    /// another part is done.
    #[cfg(feature = "cli")]
    pub fn left(&self) -> Option<Duration> {
        let &(since, first) = self.work.first.get()?;
        let done = self.done();
        if done <= first {
            return None;
        }
        // the last parts may be rounded to a little more than the rest
        Some(since.elapsed().mul_f64((1.0 - done).max(0.0) / (done - first)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_parts_add_up_and_the_first_is_no_pace() {
        let share = Share::default();
        assert_eq!((share.done(), share.left()), (0.0, None));
        let half = share.part_of(2);
        std::thread::sleep(Duration::from_millis(300));
        half.part_of(5).add();
        assert_eq!(share.left(), None);
        std::thread::sleep(Duration::from_millis(20));
        (1..5).for_each(|_| half.part_of(5).add());
        // five units are rounded
        assert!((share.done() - 0.5).abs() < 5.0 / UNITS);
        // 4/10 in 20 ms or some more, so 25 ms for 5/10; with the first part it would be 320 ms
        let left = share.left().unwrap();
        assert!(left >= Duration::from_millis(24) && left < Duration::from_millis(200), "{left:?}");
        half.add();
        assert!((share.done() - 1.0).abs() < 6.0 / UNITS && share.left().unwrap() < Duration::from_millis(1));
    }
}
