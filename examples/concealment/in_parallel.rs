//! Many cases on several threads.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::failure::Failure;

/// Does something with every case, on several threads; the order of the results is that of the cases. Each is told on
/// standard error as it ends; one that fails gives `None`.
pub fn in_parallel<C: Sync, T: Send>(
    cases: &[C],
    threads: usize,
    name: impl Fn(&C) -> String + Sync,
    work: impl Fn(&C) -> Result<(String, T), Failure> + Sync,
) -> Vec<Option<T>> {
    let next = AtomicUsize::new(0);
    let done = AtomicUsize::new(0);
    let results: Mutex<Vec<Option<T>>> = Mutex::new(cases.iter().map(|_| None).collect());
    std::thread::scope(|scope| {
        for _ in 0..threads.max(1) {
            scope.spawn(|| {
                while let Some((k, case)) =
                    Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|k| Some((k, cases.get(k)?)))
                {
                    let (words, result) = match work(case) {
                        Ok((words, result)) => (words, Some(result)),
                        Err(error) => (error.to_string(), None),
                    };
                    let finished = done.fetch_add(1, Ordering::Relaxed) + 1;
                    eprintln!("{finished}/{} {}: {words}", cases.len(), name(case));
                    if let Ok(mut all) = results.lock() {
                        all[k] = result;
                    }
                }
            });
        }
    });
    results.into_inner().unwrap_or_default()
}
