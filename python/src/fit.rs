//! Identified models.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use dynid::failure::Failure;
use dynid::output::write_json;
use dynid::recorded::{LeftOut, Measured, Recorded, observe_failure};
use dynid::robots::Dynamics;
use dynid::saved::{own_dynamics, read_model};
use dynid::speeds::{and_of_speeds, speed_words};
use dynid::verdict;
use dynid_runtime::estimation::observe::{Equations, Observation};
use dynid_runtime::estimation::{
    Estimate, EstimateSettings, Method, ObservedRecording, RecordedSettings, estimate, observe_trajectories,
};
use dynid_runtime::model_file::{self, EvaluatedRows, Identified};
use dynid_runtime::prediction::observed_errors;
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{error, of_failure};
use crate::interruptible;
use crate::recording::{copy, one};
use crate::robot::{PyRobot, again, torques};

/// An identified model: base parameters with their uncertainty, and what it leaves of the torques.
///
/// Made by :func:`identify`, or read from a model.json by :func:`load`.
#[pyclass(module = "dynid", name = "Fit", frozen)]
pub(crate) struct PyFit {
    identified: Arc<Identified>,
    dynamics: Arc<Dynamics>,
}

impl PyFit {
    /// A model of a robot with these dynamics.
    pub fn of(identified: Identified, dynamics: Dynamics) -> Self {
        Self { identified: Arc::new(identified), dynamics: Arc::new(dynamics) }
    }

    fn each<T>(&self, of: impl Fn(&model_file::NamedParameter) -> T) -> Vec<T> {
        self.identified.base_parameters.iter().map(of).collect()
    }
}

#[pymethods]
impl PyFit {
    /// Names of the base parameters.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.each(|p| p.name.clone())
    }

    /// SI units of the base parameters.
    #[getter]
    fn units(&self) -> Vec<String> {
        self.each(|p| p.unit.clone())
    }

    /// Values of the base parameters (p,): zero where the data do not determine one.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(|p| p.value).into_pyarray(py)
    }

    /// Standard deviations (p,), nan where the data do not determine a parameter.
    #[getter]
    fn sigma<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(|p| p.sigma.unwrap_or(f64::NAN)).into_pyarray(py)
    }

    /// Covariance of the parameters (p, p): rows of zeros are of what is not determined.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let found = self.identified.base_covariance(self.dynamics.model().robot());
        Array2::from_shape_fn(found.shape(), |(i, k)| found[(i, k)]).into_pyarray(py)
    }

    /// The method: ``idim-wls`` for example.
    #[getter]
    fn method(&self) -> &str {
        &self.identified.method
    }

    /// ||Y - W chi|| / ||Y|| of the torques, in the band; None where all torques are zero.
    #[getter]
    fn relative_error(&self) -> Option<f64> {
        self.identified.relative_error
    }

    /// The same joint by joint.
    #[getter]
    fn per_joint(&self) -> Vec<Option<f64>> {
        self.identified.per_joint.clone()
    }

    /// Band of the equations, Hz.
    #[getter]
    fn band(&self) -> f64 {
        self.identified.band
    }

    /// What to know before believing it, in sentences.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.identified.warnings.clone()
    }

    /// The robot that it is of.
    #[getter]
    fn robot(&self) -> PyResult<PyRobot> {
        Ok(PyRobot { dynamics: Arc::new(again(&self.dynamics)?), found: self.identified.robot.clone() })
    }

    /// Torques that it predicts (N, n), N.m or N.
    fn predict<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        ddq: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if !self.identified.effects.is_empty() {
            return Err(error(
                "the model has laws beside its parameters, which need a recording: dynid validate predicts one",
            ));
        }
        let model = self.dynamics.model();
        let missing = |name| error(format!("the model has no {name}, which its robot needs"));
        let chi = self.identified.chi(model.robot()).map_err(missing)?;
        torques(py, model, &chi, [q, dq, ddq])
    }

    /// A pandas.DataFrame: a row a parameter, with value, sigma and unit. Needs pandas.
    fn to_frame<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let columns = PyDict::new(py);
        columns.set_item("value", self.values(py))?;
        columns.set_item("sigma", self.sigma(py))?;
        columns.set_item("unit", self.units())?;
        let arguments = PyDict::new(py);
        arguments.set_item("index", self.names())?;
        py.import("pandas")?.getattr("DataFrame")?.call((columns,), Some(&arguments))
    }

    /// The model as ``dynid identify --out`` writes it.
    fn json(&self) -> PyResult<String> {
        serde_json::to_string_pretty(&*self.identified).map_err(|why| error(why.to_string()))
    }

    /// Writes the model for ``dynid validate``, ``simulate``, ``export`` and :func:`load`.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        write_json(&path, &*self.identified).map_err(of_failure)
    }

    fn __repr__(&self) -> String {
        let own = &self.identified;
        let error = own.relative_error.map_or_else(|| "unknown".to_owned(), |e| format!("{e:.4}"));
        format!(
            "dynid.Fit({}, {}): {} parameters, relative error {error}",
            own.robot,
            own.method,
            own.base_parameters.len()
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.import("dynid._dynid")?.getattr("_fit")?, (self.json()?,)))
    }
}

/// A model that was pickled.
#[pyfunction]
pub(crate) fn _fit(text: &str) -> PyResult<PyFit> {
    let path = PathBuf::from("a pickled model");
    let identified = model_file::read(text).map_err(|why| error(format!("{}:{why}", path.display())))?;
    let dynamics = own_dynamics(&identified, &path).map_err(of_failure)?;
    Ok(PyFit { identified: Arc::new(identified), dynamics: Arc::new(dynamics) })
}

/// Reads a model.json that ``dynid identify`` or :meth:`Fit.save` wrote.
#[pyfunction]
pub(crate) fn load(path: PathBuf) -> PyResult<PyFit> {
    let identified = read_model(&path).map_err(of_failure)?;
    let dynamics = own_dynamics(&identified, &path).map_err(of_failure)?;
    Ok(PyFit { identified: Arc::new(identified), dynamics: Arc::new(dynamics) })
}

/// Identifies the base parameters of a recording, or of several of one robot.
///
/// ``method`` is idim-ols, idim-wls, pim-ols, pim-wls, idim-irls, pim-irls, idim-tls or pim-tls; ``band`` is that of the
/// equations, Hz. A recording that no such robot can have made is refused, unless ``implausible``.
///
/// >>> import dynid, numpy as np
/// >>> r = dynid.Robot("planar_2r")
/// >>> t = np.arange(0, 20, 0.005)[:, None]
/// >>> w, phase = np.array([1.1, 1.7]), np.array([0.0, 1.0])
/// >>> q = np.sin(w * t + phase) + 0.4 * np.sin(2.9 * w * t)
/// >>> dq = w * np.cos(w * t + phase) + 1.16 * w * np.cos(2.9 * w * t)
/// >>> ddq = -w**2 * np.sin(w * t + phase) - 3.364 * w**2 * np.sin(2.9 * w * t)
/// >>> rec = dynid.Recording(robot=r, t=t[:, 0], q=q, tau=r.torque(r.chi, q, dq, ddq))
/// >>> fit = dynid.identify(rec, method="idim-wls")
/// >>> bool(np.abs(fit.values - r.chi).max() < 0.05)
/// True
#[pyfunction]
#[pyo3(signature = (recording, method = "idim-wls", *, band = None, implausible = false, threads = 0))]
pub(crate) fn identify(
    py: Python<'_>,
    recording: &Bound<'_, PyAny>,
    method: &str,
    band: Option<f64>,
    implausible: bool,
    threads: usize,
) -> PyResult<PyFit> {
    let method: Method = method.parse().map_err(|said: String| error(said))?;
    let recording = one(recording, "recording")?;
    let work = Work { method, band, implausible, threads };
    let (path, measured) = (recording.path.clone(), Arc::clone(&recording.measured));
    let own = copy(&measured)?;
    let identified = interruptible::run(py, None, move |_| work.identify(&path, own))?.map_err(of_failure)?;
    let dynamics = Arc::new(again(&recording.measured.dynamics)?);
    Ok(PyFit { identified: Arc::new(identified), dynamics })
}

/// What is asked for.
struct Work {
    method: Method,
    band: Option<f64>,
    implausible: bool,
    threads: usize,
}

impl Work {
    /// As `dynid identify`.
    fn identify(&self, path: &Path, measured: Measured) -> Result<Identified, Failure> {
        let mut settings = RecordedSettings { band: self.band, ..RecordedSettings::default() };
        settings.rows.threads = self.threads;
        let power = Equations::Power { closed_form: false };
        let equations: &[Equations] =
            if self.method.is_power() { &[power, Equations::Torque] } else { &[Equations::Torque] };
        let model = measured.dynamics.model();
        let observed = observe_trajectories(&measured.trajectories, model, equations, &settings, None)
            .map_err(|error| observe_failure(path, &error))?;
        let ObservedRecording { observations, motions, settings, speeds, left_out, .. } = observed;
        let rows = LeftOut { too_short: left_out, ..measured.rows };
        let (title, robot, joints, side) = (measured.title, measured.robot, measured.joints, measured.side);
        let dynamics = measured.dynamics;
        let recorded = Recorded { dynamics, title, robot, joints, side, motions, rows, speeds, settings };
        let [observation, ..] = observations.as_slice() else {
            return Err(Failure::Data("nothing was observed".to_owned()));
        };
        self.solve(path, &recorded, observation, observations.last().unwrap_or(observation))
    }

    fn solve(
        &self,
        path: &Path,
        recorded: &Recorded,
        observation: &Observation,
        torques: &Observation,
    ) -> Result<Identified, Failure> {
        let robot = recorded.dynamics.model().robot();
        let estimated = estimate(observation, &EstimateSettings::for_method(self.method));
        if estimated.degrees_of_freedom == 0 {
            return Err(Failure::Data(format!(
                "{}: {} equations cannot determine {} parameters: record longer, or raise the band",
                path.display(),
                estimated.rows,
                robot.base.len(),
            )));
        }
        let mut warnings = speed_words(&recorded.speeds, robot);
        if !self.implausible {
            let doubts = doubts(path, recorded, torques, &estimated);
            warnings.extend(doubts.map_err(|failure| and_of_speeds(failure, &warnings))?);
        }
        let errors = observed_errors(torques, &estimated.chi());
        let mut rows = EvaluatedRows::observed(observation, recorded.settings.band, &estimated, errors);
        rows.rows_left_out = Some(recorded.rows.rows.left_out);
        let mut identified = Identified::new(robot, &recorded.robot, rows, &estimated);
        identified.warnings.extend(warnings);
        Ok(identified)
    }
}

/// What is doubtful in the data, by the weighted estimate of the torques.
fn doubts(
    path: &Path,
    recorded: &Recorded,
    torques: &Observation,
    found: &Estimate,
) -> Result<Vec<String>, Failure> {
    if found.method == Method::IdimWls {
        return verdict::check(path, &recorded.judged(), torques, found);
    }
    verdict::check(path, &recorded.judged(), torques, &estimate(torques, &EstimateSettings::default()))
}
