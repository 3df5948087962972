//! Numbers that functions take: those that the command line takes.

use std::fmt::Display;

use dynid::ranges;
use pyo3::PyResult;

use crate::error::error;

/// A band, Hz, that the command line takes too.
pub(crate) fn band(asked: Option<f64>) -> PyResult<Option<f64>> {
    in_range("band", ranges::band, asked)
}

/// A number of threads that the command line takes too.
pub(crate) fn threads(asked: usize) -> PyResult<usize> {
    Ok(in_range("threads", ranges::threads, Some(asked))?.unwrap_or(0))
}

/// An instant of a recording, s, that the command line takes too.
pub(crate) fn instant(name: &str, asked: Option<f64>) -> PyResult<Option<f64>> {
    in_range(name, ranges::instant, asked)
}

fn in_range<T: Display>(
    name: &str,
    parser: impl Fn(&str) -> Result<T, String>,
    asked: Option<T>,
) -> PyResult<Option<T>> {
    let number = asked.map(|number| parser(&number.to_string())).transpose();
    number.map_err(|why| error(format!("{name}: {why}")))
}
