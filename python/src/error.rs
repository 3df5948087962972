//! Errors of dynid as exceptions of Python.

use dynid::failure::Failure;
use pyo3::PyErr;
use pyo3::exceptions::PyValueError;

pyo3::create_exception!(
    dynid,
    Error,
    PyValueError,
    "What dynid refuses, in the words of its command line: an input that is wrong, or data that cannot support an answer."
);

/// The exception with these words.
pub(crate) fn error(words: impl Into<String>) -> PyErr {
    Error::new_err(words.into())
}

/// The exception of a command that failed.
#[expect(clippy::needless_pass_by_value, reason = "for map_err")]
pub(crate) fn of_failure(failure: Failure) -> PyErr {
    error(failure.to_string())
}
