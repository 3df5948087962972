//! Memory of large arrays, used again after they were dropped.

use std::sync::Mutex;

use numpy::PyArray3;
use numpy::ndarray::ArrayView3;
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

use crate::dense::CACHED;
use crate::error::error;

/// Arrays of fewer numbers than this, half a megabyte, come from numpy.
const LEAST: usize = 1 << 16;

/// What the last array that was dropped left. The system clears memory before it gives it to a program, which takes longer
/// than to compute and write a regressor; this was given already. The system may take back what is larger than the cache.
static LEFT: Mutex<Vec<f64>> = Mutex::new(Vec::new());

/// What an array of Python keeps alive while it is used.
#[pyclass(module = "dynid", name = "_Memory", frozen)]
pub(crate) struct Memory(Vec<f64>);

impl Drop for Memory {
    fn drop(&mut self) {
        let mut dropped = std::mem::take(&mut self.0);
        // To offer memory costs as much as it saves where it fits into the cache.
        let is_kept = dropped.len() <= CACHED || system::may_take_back(&mut dropped);
        if let (true, Ok(mut left)) = (is_kept, LEFT.lock()) {
            // The one before it is given back here.
            *left = dropped;
        }
    }
}

/// An array for results, whose numbers are of no meaning before they are written.
///
/// # Errors
/// Where the machine has no room for it.
pub(crate) fn array(py: Python<'_>, shape: [usize; 3]) -> PyResult<Bound<'_, PyArray3<f64>>> {
    let no_room = || PyMemoryError::new_err(format!("no room for an array {shape:?} of float64"));
    let length = shape.iter().try_fold(1_usize, |product, n| product.checked_mul(*n)).ok_or_else(no_room)?;
    if length < LEAST || (length > CACHED && !system::CAN_TAKE_BACK) {
        return Ok(PyArray3::zeros(py, shape, false));
    }
    let memory = Bound::new(py, Memory(numbers(length).ok_or_else(no_room)?))?;
    let view =
        ArrayView3::from_shape(shape, &memory.get().0[..length]).map_err(|why| error(why.to_string()))?;
    // SAFETY: the numbers are those of `memory`, which the array keeps alive and whose vector nobody else can reach: the
    // class has no methods, and only its drop changes it, which comes after that of the array.
    Ok(unsafe { PyArray3::borrow_from_array(&view, memory.clone().into_any()) })
}

/// At least so many numbers: what was left where it is long enough and not twice as long, else fresh zeros. `None` where there
/// is no room.
fn numbers(length: usize) -> Option<Vec<f64>> {
    let left = LEFT.lock().map(|mut left| std::mem::take(&mut *left)).unwrap_or_default();
    if (length..length.saturating_mul(2)).contains(&left.len()) {
        return Some(left);
    }
    // Before more is asked for.
    drop(left);
    // Zeros that the system gives cost nothing before they are written to, but end the process where there are none.
    Vec::<f64>::new().try_reserve_exact(length).ok()?;
    let mut fresh = vec![0.0; length];
    system::in_large_pages(&mut fresh);
    Some(fresh)
}

#[cfg(target_os = "linux")]
mod system {
    /// Whether memory can be offered back without giving it up.
    pub const CAN_TAKE_BACK: bool = true;

    /// Bytes of a page that every machine's pages are multiples or divisors of.
    const PAGE: usize = 64 << 10;

    /// The system may take back the memory of these numbers, which then are zeros, as long as nobody writes to it. False
    /// where it will not.
    pub fn may_take_back(numbers: &mut [f64]) -> bool {
        advise(numbers, libc::MADV_FREE)
    }

    /// Asks for pages of 2 MB, of which far fewer are given out and looked up. Without them it is only slower.
    pub fn in_large_pages(numbers: &mut [f64]) {
        advise(numbers, libc::MADV_HUGEPAGE);
    }

    /// Whole pages of nothing but these numbers.
    fn advise(numbers: &mut [f64], advice: libc::c_int) -> bool {
        let start = numbers.as_mut_ptr();
        let before = start.align_offset(PAGE);
        let bytes = size_of_val(numbers).saturating_sub(8 * before) / PAGE * PAGE;
        if bytes == 0 {
            return false;
        }
        // SAFETY: the range lies within the slice, which is borrowed mutably: nobody else looks at it meanwhile. What either
        // advice does to it is to leave every number as it is or to make it zero, and both are numbers.
        unsafe { libc::madvise(start.add(before).cast(), bytes, advice) == 0 }
    }
}

#[cfg(not(target_os = "linux"))]
mod system {
    pub const CAN_TAKE_BACK: bool = false;

    pub fn may_take_back(_: &mut [f64]) -> bool {
        false
    }

    pub fn in_large_pages(_: &mut [f64]) {}
}
