//! Loops that run on all cores. All but the sorts end in [`on_all_cores`], which is not generic: rayon's code is compiled once, not once
//! for each loop.

pub mod share;

use std::mem::MaybeUninit;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use rayon::slice::ParallelSliceMut;

/// A long loop is cut into this many parts for each thread. They are small, so no thread waits long for the last one.
const PARTS: usize = 32;

/// What a loop goes over: a range of numbers, or the items of a slice.
///
/// # Safety
/// `part` gives exactly one item for each of its places.
pub unsafe trait Items: Sync {
    type Item;

    fn count(&self) -> usize;

    /// The items at these places, in order.
    fn part(&self, places: Range<usize>) -> impl Iterator<Item = Self::Item>;
}

// SAFETY: a slice has an item at each of its places
unsafe impl<'a, T: Sync> Items for &'a [T] {
    type Item = &'a T;

    fn count(&self) -> usize {
        self.len()
    }

    fn part(&self, places: Range<usize>) -> impl Iterator<Item = &'a T> {
        self[places].iter()
    }
}

// SAFETY: a slice has an item at each of its places
unsafe impl<'a, T: Sync> Items for &'a Vec<T> {
    type Item = &'a T;

    fn count(&self) -> usize {
        self.len()
    }

    fn part(&self, places: Range<usize>) -> impl Iterator<Item = &'a T> {
        self[places].iter()
    }
}

macro_rules! items_of_range {
    ($($number:ty),+) => {$(
        // SAFETY: a range of as many numbers as there are places
        unsafe impl Items for Range<$number> {
            type Item = $number;

            fn count(&self) -> usize {
                // machines whose pointers have 32 bits have no memory for the results of more numbers either
                usize::try_from(self.end.saturating_sub(self.start)).unwrap_or(usize::MAX)
            }

            fn part(&self, places: Range<usize>) -> impl Iterator<Item = $number> {
                // the places lie in the range, so the sums fit its type
                self.start + places.start as $number..self.start + places.end as $number
            }
        }
    )+};
}

items_of_range!(u32, u64, usize);

/// Calls `each` with every item and returns the results, in the order of the items.
pub fn map<I: Items, T: Send>(items: I, each: impl Fn(I::Item) -> T + Sync) -> Vec<T> {
    let count = items.count();
    let mut all = Vec::with_capacity(count);
    let slots: &mut [MaybeUninit<T>] = &mut all.spare_capacity_mut()[..count];
    in_parts(slots, &|first, slots| {
        let items = items.part(first..first + slots.len());
        slots.iter_mut().zip(items).for_each(|(slot, item)| {
            slot.write(each(item));
        });
    });
    // SAFETY: no call of `each` panicked, or this line would not be reached. So every part is finished, and by the contract of `Items` a part
    // has an item for each of its slots: all `count` slots are written.
    unsafe { all.set_len(count) };
    all
}

/// Calls `each` with every item and joins the lists or options that it returns, in the order of the items.
pub fn flat_map<I: Items, L: IntoIterator<Item: Send>>(items: I, each: impl Fn(I::Item) -> L + Sync) -> Vec<L::Item> {
    let of_part = |places| {
        let mut own = Vec::new();
        items.part(places).for_each(|item| own.extend(each(item)));
        own
    };
    joined(of_parts(items.count(), |_, places| of_part(places)))
}

/// Calls `each` with the items and returns the results in their order, or the error of the first item that has one. Items after that one
/// may be left out.
pub fn try_map<I: Items, T: Send, E: Send>(
    items: I,
    each: impl Fn(I::Item) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    let failed = AtomicUsize::new(usize::MAX);
    let of_part = |k: usize, places| {
        if k > failed.load(Ordering::Relaxed) {
            return Ok(Vec::new());
        }
        let own: Result<Vec<T>, E> = items.part(places).map(&each).collect();
        if own.is_err() {
            failed.fetch_min(k, Ordering::Relaxed);
        }
        own
    };
    // where a part was left out, an earlier one failed, whose error is returned here
    let parts = of_parts(items.count(), of_part).into_iter().collect::<Result<Vec<Vec<T>>, E>>()?;
    Ok(joined(parts))
}

/// Joins the results of `each`, in the order of the items; `None` if there is no result. `join` must be associative, since the number of
/// threads decides which results are joined first.
pub fn reduce<I: Items, T: Send>(
    items: I,
    each: impl Fn(I::Item) -> Option<T> + Sync,
    join: impl Fn(T, T) -> T + Sync,
) -> Option<T> {
    let of_part = |_, places| items.part(places).filter_map(&each).reduce(&join);
    of_parts(items.count(), of_part).into_iter().flatten().reduce(&join)
}

/// Whether `holds` is true of any item. Once one is found, the rest may be left out.
pub fn any<I: Items>(items: I, holds: impl Fn(I::Item) -> bool + Sync) -> bool {
    let found = AtomicBool::new(false);
    of_parts(items.count(), |_, places| {
        if !found.load(Ordering::Relaxed) && items.part(places).any(&holds) {
            found.store(true, Ordering::Relaxed);
        }
    });
    found.into_inner()
}

/// Calls `each` with the number of every item of a list and the item.
pub fn for_each_mut<T: Send>(list: &mut [T], each: impl Fn(usize, &mut T) + Sync) {
    in_parts(list, &|first, part| part.iter_mut().zip(first..).for_each(|(item, k)| each(k, item)));
}

/// Calls `each` with every item of an iterator, such as the chunks of a list. Each idle thread takes the next few.
pub fn for_each<I: ExactSizeIterator + Send>(all: I, each: impl Fn(I::Item) + Sync) {
    let size = part_size(all.len());
    let parts = all.len().div_ceil(size);
    let left = Mutex::new(all);
    on_all_cores(parts, &|| {
        loop {
            let own: Vec<I::Item> = in_turn(&left, |left| left.by_ref().take(size).collect());
            if own.is_empty() {
                return;
            }
            own.into_iter().for_each(&each);
        }
    });
}

/// Calls two functions, at the same time if a thread is idle.
pub fn both(a: &mut (dyn FnMut() + Send), b: &mut (dyn FnMut() + Send)) {
    rayon::join(a, b);
}

/// Sorts a list. Equal items may change places.
pub fn sort<T: Ord + Send>(list: &mut [T]) {
    list.par_sort_unstable();
}

/// Sorts a list by `order`. Equal items may change places.
pub fn sort_by<T: Send>(list: &mut [T], order: impl Fn(&T, &T) -> std::cmp::Ordering + Sync) {
    list.par_sort_unstable_by(order);
}

/// How many items a part has, in a loop over `count` items.
fn part_size(count: usize) -> usize {
    count.div_ceil(PARTS * rayon::current_num_threads()).max(1)
}

/// Calls `of_part` with the number of each part of a loop and with its places, and returns the results in order.
fn of_parts<T: Send>(count: usize, of_part: impl Fn(usize, Range<usize>) -> T + Sync) -> Vec<T> {
    let size = part_size(count);
    map(0..count.div_ceil(size), |k| of_part(k, k * size..count.min((k + 1) * size)))
}

/// The lists one after another; each is freed when it has been copied.
fn joined<T>(parts: Vec<Vec<T>>) -> Vec<T> {
    let mut all = Vec::with_capacity(parts.iter().map(Vec::len).sum());
    parts.into_iter().for_each(|part| all.extend(part));
    all
}

/// Calls `work` with each part of a list, and the number of its first item.
fn in_parts<T: Send>(list: &mut [T], work: &(dyn Fn(usize, &mut [T]) + Sync)) {
    let size = part_size(list.len());
    let parts = list.chunks_mut(size).enumerate();
    let count = parts.len();
    let left = Mutex::new(parts);
    on_all_cores(count, &|| {
        while let Some((k, part)) = in_turn(&left, Iterator::next) {
            work(k * size, part);
        }
    });
}

/// Takes work from a shared queue. The lock is free again when this returns.
fn in_turn<L, T>(left: &Mutex<L>, take: impl FnOnce(&mut L) -> T) -> T {
    // a panic in `take` leaves the queue usable
    take(&mut left.lock().unwrap_or_else(PoisonError::into_inner))
}

/// Calls `work` on as many threads as there are tasks, but not on more than rayon has. `work` takes tasks from a queue until none is left, so it does not
/// matter how often it is called: a thread that is busy elsewhere and comes late finds nothing to do.
fn on_all_cores(tasks: usize, work: &(dyn Fn() + Sync)) {
    match tasks.min(rayon::current_num_threads()) {
        0 => {}
        1 => work(),
        n => both(&mut || on_all_cores(n / 2, work), &mut || on_all_cores(n - n / 2, work)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::{AssertUnwindSafe, catch_unwind};

    /// Lengths of loops just below, at and above the one from which parts have more than one item.
    fn counts() -> Vec<usize> {
        let most = PARTS * rayon::current_num_threads();
        vec![0, 1, 2, 3, most - 1, most, most + 1, 10 * most + 7]
    }

    #[test]
    fn results_are_in_order() {
        for n in counts() {
            let list: Vec<usize> = (0..n).collect();
            assert_eq!(map(0..n, |k| k), list);
            assert_eq!(map(&list, |k| *k), list);
            assert_eq!(map(&list[n / 2..], |k| *k), list[n / 2..]);
            assert_eq!(map(5..5 + n as u32, |k| k as usize - 5), list);
            assert_eq!(map(5..5 + n as u64, |k| k.to_string()).len(), n);
            // the end of a range may lie before its start
            assert_eq!(map(n + 1..n, |k| k), [0; 0]);
            assert_eq!(try_map(&list, |k| Ok::<_, ()>(*k)), Ok(list.clone()));
            assert_eq!(
                flat_map(0..n, |k| (k % 3 == 0).then_some(k)),
                list.iter().copied().step_by(3).collect::<Vec<_>>()
            );
            assert_eq!(flat_map(0..n, |k| [k, k]), list.iter().flat_map(|k| [*k, *k]).collect::<Vec<_>>());
            let text = |k: usize| k.to_string();
            let joined = reduce(0..n, |k| (k % 2 == 0).then(|| text(k)), |a, b| a + &b);
            assert_eq!(joined, list.iter().copied().step_by(2).map(text).reduce(|a, b| a + &b));
        }
    }

    #[test]
    fn every_item_is_visited_once() {
        for n in counts() {
            let mut list = vec![1; n];
            for_each_mut(&mut list, |k, item| *item += 2 * k);
            assert!(list.iter().enumerate().all(|(k, item)| *item == 2 * k + 1));
            for_each(list.chunks_mut(3).enumerate(), |(k, chunk)| chunk.iter_mut().for_each(|item| *item -= k));
            assert!(list.iter().enumerate().all(|(k, item)| *item == 2 * k + 1 - k / 3));
            for at in [0, n / 2, n] {
                assert_eq!(any(0..n, |k| k == at), at < n);
            }
            sort(&mut list);
            assert!(list.is_sorted());
        }
    }

    #[test]
    fn the_first_error_is_the_one() {
        for n in counts() {
            for first in [0, n / 3, n.saturating_sub(1)] {
                let found = try_map(0..n, |k| if k >= first { Err(k) } else { Ok(k) });
                assert_eq!(found, if n == 0 { Ok(vec![]) } else { Err(first) });
            }
        }
    }

    #[test]
    fn panics_reach_the_caller() {
        let caught = |work: &dyn Fn()| {
            let panic = catch_unwind(AssertUnwindSafe(work)).unwrap_err();
            *panic.downcast_ref::<&str>().unwrap()
        };
        let fail_at = |k: usize, at: usize| {
            if k == at {
                panic!("as it should")
            }
        };
        for n in counts().into_iter().filter(|n| *n > 0) {
            for at in [0, n - 1] {
                assert_eq!(caught(&|| drop(map(0..n, |k| fail_at(k, at)))), "as it should");
                assert_eq!(caught(&|| drop(map(0..n, |k| (vec![k], fail_at(k, at))))), "as it should");
                assert_eq!(caught(&|| for_each_mut(&mut vec![0; n], |k, _| fail_at(k, at))), "as it should");
                assert_eq!(caught(&|| for_each(0..n, |k| fail_at(k, at))), "as it should");
                assert_eq!(caught(&|| both(&mut || {}, &mut || fail_at(0, 0))), "as it should");
            }
        }
        // threads go on
        assert_eq!(map(0..9u32, |k| k).len(), 9);
    }

    #[test]
    fn nested_loops_end() {
        fn leaves(depth: u32) -> usize {
            if depth == 0 { 1 } else { map(0..4u32, |_| leaves(depth - 1)).into_iter().sum() }
        }
        assert_eq!(leaves(6), 4096);
        let sums = map(0..100usize, |i| reduce(0..1000usize, |k| Some(i * k), |a, b| a + b));
        assert!(sums.iter().enumerate().all(|(i, sum)| *sum == Some(i * 499_500)));
    }
}
