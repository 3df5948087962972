//! dynid as a Python module: arrays in, arrays out, errors as exceptions with the words of the command line.

mod dense;
mod diagnosis;
mod error;
mod factor;
mod fit;
mod identify;
mod interruptible;
mod known;
mod memory;
mod ranges;
mod recording;
mod robot;
mod signals;
mod written;

use pyo3::prelude::*;

#[pymodule]
fn _dynid(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("Error", m.py().get_type::<error::Error>())?;
    m.add_class::<robot::PyRobot>()?;
    m.add_class::<recording::PyRecording>()?;
    m.add_class::<fit::PyFit>()?;
    m.add_class::<diagnosis::PyDiagnosis>()?;
    m.add_class::<diagnosis::PyFinding>()?;
    m.add_class::<factor::PyFactors>()?;
    m.add_function(wrap_pyfunction!(factor::factor, m)?)?;
    m.add_function(wrap_pyfunction!(factor::merge, m)?)?;
    m.add_function(wrap_pyfunction!(factor::solve, m)?)?;
    m.add_function(wrap_pyfunction!(robot::robots, m)?)?;
    m.add_function(wrap_pyfunction!(robot::_robot, m)?)?;
    m.add_function(wrap_pyfunction!(recording::open, m)?)?;
    m.add_function(wrap_pyfunction!(recording::_recording, m)?)?;
    m.add_function(wrap_pyfunction!(identify::identify, m)?)?;
    m.add_function(wrap_pyfunction!(fit::load, m)?)?;
    m.add_function(wrap_pyfunction!(fit::_fit, m)?)?;
    m.add_function(wrap_pyfunction!(diagnosis::diagnose, m)?)?;
    Ok(())
}
