//! Sufficient statistics of recordings: made where the recording is, merged and solved where the answer is wanted.

use std::sync::Arc;

use dynid::commands::identify::method::Identification;
use dynid::failure::Failure;
use dynid::recorded::observe_failure;
use dynid::robots::Dynamics;
use dynid_runtime::estimation::observe::{Equations, Observation};
use dynid_runtime::estimation::{EstimateSettings, Method, RecordedSettings, estimate, observe_trajectories};
use dynid_runtime::model_file::{EvaluatedRows, Identified, fingerprint};
use dynid_runtime::prediction::observed_errors;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::{error, of_failure};
use crate::fit::PyFit;
use crate::interruptible;
use crate::ranges;
use crate::recording::{copy, one};
use crate::robot::{PyRobot, again};
use crate::written;

/// What is kept of recordings of one robot: orthogonal factors of their torque equations, however long they were.
///
/// Made by :func:`factor`. ``bytes(f)`` can be kept or sent; ``Factors.from_bytes(data, robot)`` reads it back.
#[pyclass(module = "dynid", name = "Factors", frozen)]
pub(crate) struct PyFactors {
    observation: Observation,
    dynamics: Arc<Dynamics>,
    found: String,
}

#[pymethods]
impl PyFactors {
    /// Rows of all equations.
    #[getter]
    fn rows(&self) -> usize {
        self.observation.groups.iter().map(|group| group.factor.rows()).sum()
    }

    /// Names of the motions.
    #[getter]
    fn motions(&self) -> Vec<String> {
        self.observation.trajectories.clone()
    }

    /// Reads what ``bytes(f)`` wrote, for the same robot.
    #[staticmethod]
    fn from_bytes(data: &[u8], robot: &PyRobot) -> PyResult<Self> {
        let observation = written::read(data, robot.model().robot()).map_err(error)?;
        Ok(Self { observation, dynamics: Arc::clone(&robot.dynamics), found: robot.found.clone() })
    }

    fn __bytes__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let written = written::write(&self.observation, self.dynamics.model().robot()).map_err(error)?;
        Ok(PyBytes::new(py, &written))
    }

    fn __repr__(&self) -> String {
        format!(
            "dynid.Factors({}): {} motions, {} rows",
            self.found,
            self.observation.trajectories.len(),
            self.rows()
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let rebuild = py.import("dynid._dynid")?.getattr("Factors")?.getattr("from_bytes")?;
        let robot = PyRobot { dynamics: Arc::clone(&self.dynamics), found: self.found.clone() };
        Ok((rebuild, (self.__bytes__(py)?, robot).into_pyobject(py)?.into_any()))
    }
}

/// Reduces a recording, or several of one robot, to what an identification needs of it. ``band`` is that of the equations,
/// Hz: factors that are merged should have one.
#[pyfunction]
#[pyo3(signature = (recording, *, band = None))]
pub(crate) fn factor(py: Python<'_>, recording: &Bound<'_, PyAny>, band: Option<f64>) -> PyResult<PyFactors> {
    let (recording, band) = (one(recording, "recording")?, ranges::band(band)?);
    let (path, own) = (recording.path.clone(), copy(&recording.measured)?);
    let observed = interruptible::run(py, ("factor", None), move |_| {
        let settings = RecordedSettings { band, ..RecordedSettings::default() };
        let model = own.dynamics.model();
        observe_trajectories(&own.trajectories, model, &[Equations::Torque], &settings, None)
            .map_err(|error| observe_failure(&path, &error))
    })?;
    let mut observations = observed.map_err(of_failure)?.observations;
    let mut observation = observations.pop().ok_or_else(|| error("nothing was observed"))?;
    observation.rows = None;
    let dynamics = Arc::new(again(&recording.measured.dynamics)?);
    Ok(PyFactors { observation, dynamics, found: recording.measured.robot.clone() })
}

/// The factors of several recordings of one robot as one.
#[pyfunction]
pub(crate) fn merge(factors: Vec<PyRef<'_, PyFactors>>) -> PyResult<PyFactors> {
    let [first, others @ ..] = factors.as_slice() else { return Err(error("there are no factors to merge")) };
    let mut observation = first.observation.clone();
    let own = fingerprint(first.dynamics.model().robot());
    for other in others {
        if fingerprint(other.dynamics.model().robot()) != own {
            return Err(error(format!(
                "factors of {} and of {} are of different robots",
                first.found, other.found
            )));
        }
        observation.append(other.observation.clone()).map_err(|why| error(why.to_string()))?;
    }
    Ok(PyFactors { observation, dynamics: Arc::clone(&first.dynamics), found: first.found.clone() })
}

/// Identifies base parameters from factors: ``idim-ols``, ``idim-wls``, ``idim-irls`` or ``idim-tls``. Whether such a robot
/// can have made the recording is not asked: that needs its rows. Standard deviations are those by blocks of time.
#[pyfunction]
#[pyo3(signature = (factors, method = "idim-wls"))]
pub(crate) fn solve(py: Python<'_>, factors: &PyFactors, method: &str) -> PyResult<PyFit> {
    let method: Identification = method.parse().map_err(|said: String| error(said))?;
    let solved_by = match method {
        Identification::Solved(method) if !method.is_power() => method,
        other => {
            let name = other.name();
            return Err(error(format!("{name} needs the recording: factors are of torque equations")));
        }
    };
    let (observation, own, found) =
        (factors.observation.clone(), again(&factors.dynamics)?, factors.found.clone());
    let identified =
        interruptible::run(py, ("solve", None), move |_| solved(&observation, &own, &found, solved_by))?;
    Ok(PyFit::of(identified.map_err(of_failure)?, again(&factors.dynamics)?))
}

fn solved(
    observation: &Observation,
    dynamics: &Dynamics,
    found: &str,
    method: Method,
) -> Result<Identified, Failure> {
    let robot = dynamics.model().robot();
    let estimated = estimate(observation, &EstimateSettings::for_method(method));
    if estimated.degrees_of_freedom == 0 {
        return Err(Failure::Data(format!(
            "{} equations cannot determine {} parameters: record longer",
            estimated.rows,
            robot.base.len()
        )));
    }
    let errors = observed_errors(observation, &estimated.chi());
    let band = observation.bands.iter().copied().fold(0.0, f64::max);
    let rows = EvaluatedRows::observed(observation, band, &estimated, errors);
    Ok(Identified::new(robot, found, rows, &estimated))
}
