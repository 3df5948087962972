//! Work on several threads whose outcome does not depend on how many there are.

use std::sync::atomic::{AtomicUsize, Ordering};

/// `work(0), .. work(count - 1)` in this order, each computed once by one of `threads` threads.
pub(super) fn map<T: Send>(threads: usize, count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    if threads <= 1 || count <= 1 {
        return (0..count).map(work).collect();
    }
    let next = AtomicUsize::new(0);
    let mut done: Vec<(usize, T)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.min(count))
            .map(|_| {
                scope.spawn(|| {
                    let mut mine = Vec::new();
                    loop {
                        let k = next.fetch_add(1, Ordering::Relaxed);
                        if k >= count {
                            break mine;
                        }
                        mine.push((k, work(k)));
                    }
                })
            })
            .collect();
        workers
            .into_iter()
            .flat_map(|w| match w.join() {
                Ok(mine) => mine,
                Err(panic) => std::panic::resume_unwind(panic),
            })
            .collect()
    });
    done.sort_by_key(|(k, _)| *k);
    done.into_iter().map(|(_, t)| t).collect()
}

/// The same for work that changes the items of a list in place.
pub(super) fn for_each<T: Send>(threads: usize, items: &mut [T], work: impl Fn(&mut T) + Sync) {
    if threads <= 1 {
        return items.iter_mut().for_each(work);
    }
    let queue = std::sync::Mutex::new(items.iter_mut());
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
