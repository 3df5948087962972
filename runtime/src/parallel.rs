//! Work over threads, with results that do not depend on their number.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// As many threads as were asked for, 0 for as many as the machine has, and no more than there are pieces of work.
fn threads_for(asked: usize, pieces: usize) -> usize {
    let available = || std::thread::available_parallelism().map_or(1, |n| n.get());
    (if asked == 0 { available() } else { asked }).min(pieces)
}

/// `work(0), .. work(count - 1)` in this order, whatever thread did them; 0 threads: as many as the machine has.
pub(crate) fn map<T: Send>(threads: usize, count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let threads = threads_for(threads, count);
    if threads <= 1 {
        return (0..count).map(work).collect();
    }
    let next = AtomicUsize::new(0);
    let slots: Vec<Mutex<Option<T>>> = (0..count).map(|_| Mutex::new(None)).collect();
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    let Some(slot) = slots.get(k) else { break };
                    let result = work(k);
                    if let Ok(mut slot) = slot.lock() {
                        *slot = Some(result);
                    }
                }
            });
        }
    });
    // Every slot was filled above: a panic in a thread is passed on by the scope.
    slots.into_iter().filter_map(|slot| slot.into_inner().ok().flatten()).collect()
}

/// The same for work that changes the items of a list in place.
#[cfg(any(test, feature = "diagnosis"))]
pub(crate) fn for_each<T: Send>(threads: usize, items: &mut [T], work: impl Fn(&mut T) + Sync) {
    let threads = threads_for(threads, items.len());
    if threads <= 1 {
        return items.iter_mut().for_each(work);
    }
    let queue = Mutex::new(items.iter_mut());
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let item = match queue.lock() {
                        Ok(mut items) => items.next(),
                        Err(_) => None,
                    };
                    let Some(item) = item else { break };
                    work(item);
                }
            });
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_the_outcome_does_not_depend_on_the_threads() {
        let square = |k: usize| k * k;
        let expected: Vec<usize> = (0..100).map(square).collect();
        for threads in [0, 1, 2, 7] {
            assert_eq!(map(threads, 100, square), expected);
            let mut items: Vec<usize> = (0..100).collect();
            for_each(threads, &mut items, |x| *x *= *x);
            assert_eq!(items, expected);
        }
    }
}
