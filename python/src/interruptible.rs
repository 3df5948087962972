//! Long work beside the interpreter: it can be interrupted, and tells how far it is.

use std::any::Any;
use std::panic::resume_unwind;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex};
use std::thread::{self, ThreadId};
use std::time::Duration;

use dynid_runtime::diagnosis::Progress;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyBool;

/// How often signals are looked at and progress is told, and so how long Ctrl-C takes.
const INTERVAL: Duration = Duration::from_millis(50);

/// Stack of the thread that works: that of a main thread.
const STACK: usize = 8 << 20;

/// What a thread that works and the interpreter tell each other.
#[derive(Default)]
struct State {
    interrupted: bool,
    worker: Option<ThreadId>,
    at: Option<(f64, String)>,
}

/// What the work reports to.
#[derive(Clone, Default)]
pub(crate) struct Watch(Arc<Mutex<State>>);

/// What unwinds the thread of work that nobody waits for any more.
struct Interrupted;

impl Watch {
    fn change<T>(&self, change: impl FnOnce(&mut State) -> T) -> Option<T> {
        self.0.lock().ok().map(|mut state| change(&mut state))
    }
}

impl Progress for Watch {
    /// Notes how far the work is; after an interruption the thread that does it ends here.
    fn at(&self, done: f64, what: &str) {
        let ends = self.change(|state| {
            state.at = Some((done, what.to_owned()));
            state.interrupted && state.worker == Some(thread::current().id())
        });
        if ends == Some(true) {
            let interrupted: Box<dyn Any + Send> = Box::new(Interrupted);
            resume_unwind(interrupted);
        }
    }
}

/// Does work in a thread of its own while the interpreter is free for others. `progress` is called with the share that is
/// done, 0 to 1, and what is being done; `True` for it is a bar with this title, where there is tqdm.
///
/// # Errors
/// What `progress` raises, and KeyboardInterrupt on Ctrl-C; the work then ends by itself at its next report.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    (title, progress): (&str, Option<&Bound<'_, PyAny>>),
    work: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    let bar = match progress {
        Some(asked) if asked.is_instance_of::<PyBool>() => {
            if asked.is_truthy()? {
                Some(py.import("dynid._bar")?.getattr("Bar")?.call1((title,))?)
            } else {
                None
            }
        }
        other => return watched(py, other, work),
    };
    let result = watched(py, bar.as_ref(), work);
    if let Some(bar) = bar {
        bar.call_method1("close", (result.is_ok(),))?;
    }
    result
}

/// As [`run`], with a function for `progress` or none.
fn watched<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    let watch = Watch::default();
    let (done, mut waiting) = channel();
    let its = watch.clone();
    let worker = move || {
        its.change(|state| state.worker = Some(thread::current().id()));
        let result = work(&its);
        // Nobody may be waiting any more.
        let _ = done.send(result);
    };
    thread::Builder::new().stack_size(STACK).spawn(worker)?;
    loop {
        let waited;
        (waiting, waited) = py.detach(move || {
            let waited = waiting.recv_timeout(INTERVAL);
            (waiting, waited)
        });
        match waited {
            Ok(result) => return Ok(result),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("a bug of dynid: the work ended without a result"));
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        if let Err(raised) = py.check_signals().and_then(|()| tell(&watch, progress)) {
            watch.change(|state| state.interrupted = true);
            return Err(raised);
        }
    }
}

fn tell(watch: &Watch, progress: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
    match (progress, watch.change(|state| state.at.take()).flatten()) {
        (Some(progress), Some(at)) => progress.call1(at).map(|_| ()),
        _ => Ok(()),
    }
}
