//! Arrays of Python as the signals that models take.

use std::ops::Range;

use dynid_runtime::model::States;
use dynid_runtime::simulation::SampledReference;
use numpy::ndarray::{ArrayView2, Axis, Ix1, Slice};
use numpy::{
    AllowTypeChange, PyArray2, PyArrayDyn, PyArrayLikeDyn, PyArrayMethods, PyReadonlyArray2,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;

use crate::error::error;

/// Samples that are worked on at once: a multiple of a line of the batch engine, and what stays in the cache.
const BLOCK: usize = 64;

/// An array, or what numpy makes one of, as numbers. An array of float64 is not copied. What numpy would turn into other
/// numbers is refused: complex ones lose their imaginary part, dates their unit.
fn numbers<'py>(
    name: &str,
    value: &Bound<'py, PyAny>,
) -> PyResult<PyArrayLikeDyn<'py, f64, AllowTypeChange>> {
    let wrong = |_| error(format!("{name}: not an array of numbers"));
    if value.cast::<PyArrayDyn<f64>>().is_err() {
        let given = value.py().import("numpy")?.call_method1("asarray", (value,)).map_err(wrong)?;
        let dtype = given.getattr("dtype")?;
        let kind: char = dtype.getattr("kind")?.extract()?;
        if !"biufO".contains(kind) {
            return Err(error(format!("{name}: an array of {dtype} instead of numbers")));
        }
    }
    value.extract().map_err(wrong)
}

/// The shape of an array as Python writes it.
fn shape_words(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        several => format!("({})", several.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// One value for each of `of`, as a vector: chi for example.
pub(crate) fn vector(name: &str, value: &Bound<'_, PyAny>, length: usize, of: &str) -> PyResult<Vec<f64>> {
    let found = numbers(name, value)?;
    match found.as_array().into_dimensionality::<Ix1>() {
        Ok(values) if values.len() == length => Ok(values.to_vec()),
        _ => Err(error(format!(
            "{name} has the shape {}, expected ({length},): one value for each {of}",
            shape_words(found.shape())
        ))),
    }
}

/// A vector of any length.
pub(crate) fn series(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let found = numbers(name, value)?;
    match found.as_array().into_dimensionality::<Ix1>() {
        Ok(values) => Ok(values.to_vec()),
        Err(_) => Err(error(format!("{name} has the shape {}, expected (N,)", shape_words(found.shape())))),
    }
}

/// A motion: t (N,), evenly spaced, and q, dq and ddq (N, n).
///
/// # Errors
/// Shapes that do not fit, values that are not finite, times that are not evenly spaced.
pub(crate) fn motion(joints: usize, [t, q, dq, ddq]: [&Bound<'_, PyAny>; 4]) -> PyResult<SampledReference> {
    let time = series("t", t)?;
    let signals = Signals::read(joints, &[("q", q), ("dq", dq), ("ddq", ddq)])?;
    if signals.single || signals.samples != time.len() {
        return Err(error(format!("q has {} rows, and t has {} values", signals.samples, time.len())));
    }
    let views = signals.views();
    let columns = [0, 1, 2].map(|s| views.columns(s));
    if !columns.iter().flatten().flatten().chain(&time).all(|x| x.is_finite()) {
        return Err(error("a value is not a finite number"));
    }
    SampledReference::new(&time, columns).map_err(|why| error(why.to_string()))
}

/// Signals of the joints at N samples, each (N, n).
pub(crate) struct Signals<'py> {
    arrays: Vec<PyReadonlyArray2<'py, f64>>,
    /// N.
    pub samples: usize,
    /// n.
    pub joints: usize,
    /// Whether one state was given as vectors (n,).
    pub single: bool,
}

impl<'py> Signals<'py> {
    /// Checks named signals of a robot with so many joints: all of them (N, n), or all of them (n,).
    ///
    /// # Errors
    /// Which one has what shape, and what was expected.
    pub fn read(joints: usize, named: &[(&str, &Bound<'py, PyAny>)]) -> PyResult<Self> {
        let mut arrays = Vec::with_capacity(named.len());
        let mut first: Option<(&str, Vec<usize>)> = None;
        for (name, value) in named {
            let array = numbers(name, value)?;
            let shape = array.shape().to_vec();
            let fits = matches!(shape[..], [n] | [_, n] if n == joints);
            if !fits {
                return Err(error(format!(
                    "{name} has the shape {}, expected (N, {joints}) or ({joints},): the robot has {joints} joints",
                    shape_words(&shape)
                )));
            }
            match &first {
                Some((other, expected)) if *expected != shape => {
                    return Err(error(format!(
                        "{name} has the shape {}, and {other} has {}: they must be the same",
                        shape_words(&shape),
                        shape_words(expected)
                    )));
                }
                Some(_) => {}
                None => first = Some((name, shape)),
            }
            arrays.push(as_rows(&array, joints)?);
        }
        let shape = first.map_or_else(Vec::new, |(_, shape)| shape);
        let single = shape.len() == 1;
        Ok(Self {
            arrays,
            samples: if single { 1 } else { shape.first().copied().unwrap_or(0) },
            joints,
            single,
        })
    }

    /// The signals as Rust sees them, which does not need the interpreter.
    pub fn views(&self) -> Views<'_> {
        Views {
            signals: self.arrays.iter().map(|a| a.as_array()).collect(),
            samples: self.samples,
            joints: self.joints,
        }
    }
}

/// An array (N, n), or (n,) as one row, without copying it.
fn as_rows<'py>(array: &Bound<'py, PyArrayDyn<f64>>, joints: usize) -> PyResult<PyReadonlyArray2<'py, f64>> {
    let rows = if array.ndim() == 1 {
        array.reshape([1, joints])?
    } else {
        array.clone().into_any().cast_into::<PyArray2<f64>>().map_err(|_| error("not an array of float64"))?
    };
    rows.try_readonly().map_err(|_| error("an array that is being written to cannot be read"))
}

/// Signals without the interpreter.
pub(crate) struct Views<'a> {
    signals: Vec<ArrayView2<'a, f64>>,
    samples: usize,
    joints: usize,
}

impl Views<'_> {
    /// N.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Calls `work` with blocks of samples in sequence. Columns that lie in memory as the batch engine reads them
    /// (an array in the order of Fortran, or the transpose of one with a row a joint) are read where they are; others are
    /// gathered block by block. A signal that was not given reads as zeros.
    pub fn blocks(&self, work: impl FnMut(Range<usize>, States<'_>)) {
        self.blocks_of(0..self.samples, work);
    }

    /// [`Self::blocks`] of a range of the samples.
    pub fn blocks_of(&self, samples: Range<usize>, mut work: impl FnMut(Range<usize>, States<'_>)) {
        let (n, zeros) = (self.joints, [0.0; BLOCK]);
        let mut gathered = vec![0.0; 3 * n * BLOCK];
        let mut from = samples.start;
        while from < samples.end {
            let range = from..samples.end.min(from + BLOCK);
            let count = range.len();
            for (s, signal) in self.signals.iter().enumerate().filter(|(_, s)| !columns_lie(s)) {
                let room = &mut gathered[s * n * BLOCK..][..n * BLOCK];
                let rows = signal.slice_axis(Axis(0), Slice::from(range.clone()));
                for (j, column) in rows.columns().into_iter().enumerate() {
                    for (x, value) in room[j * BLOCK..].iter_mut().zip(column) {
                        *x = *value;
                    }
                }
            }
            let column = |s: usize, j: usize| -> &[f64] {
                let Some(signal) = self.signals.get(s) else { return &zeros[..count] };
                match lying(signal, j) {
                    Some(column) => &column[range.clone()],
                    None => &gathered[(s * n + j) * BLOCK..][..count],
                }
            };
            let [q, dq, ddq] = [0, 1, 2].map(|s| (0..n).map(|j| column(s, j)).collect::<Vec<_>>());
            work(range, States { q: &q, dq: &dq, ddq: &ddq });
            from += count;
        }
    }

    /// Copies of the columns of a signal: `[j][t]`.
    pub fn columns(&self, signal: usize) -> Vec<Vec<f64>> {
        self.signals
            .get(signal)
            .map_or_else(Vec::new, |s| s.columns().into_iter().map(|c| c.to_vec()).collect())
    }
}

/// Whether the samples of a joint follow one another in memory.
fn columns_lie(signal: &ArrayView2<'_, f64>) -> bool {
    signal.strides()[0] == 1
}

/// The samples of a joint where they follow one another in memory.
fn lying<'a>(signal: &ArrayView2<'a, f64>, joint: usize) -> Option<&'a [f64]> {
    if !columns_lie(signal) {
        return None;
    }
    (*signal).index_axis_move(Axis(1), joint).to_slice()
}
