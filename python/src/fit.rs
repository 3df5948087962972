//! Identified models.

use std::path::PathBuf;
use std::sync::Arc;

use dynid::output::write_json;
use dynid::robots::Dynamics;
use dynid::saved::{own_dynamics, read_model};
use dynid_runtime::effects::{EffectTerm, Form};
use dynid_runtime::model_file::{self, Identified};
use dynid_runtime::prediction::Predictor;
use dynid_runtime::signal::Motion;
use dynid_runtime::simulation::SampledReference;
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{error, of_failure};
use crate::recording::rows;
use crate::robot::{PyRobot, again, torques};
use crate::signals::{motion, series};

/// An identified model: base parameters with their uncertainty, and what it leaves of the torques.
///
/// Made by :func:`identify`, or read from a model.json by :func:`load`.
#[pyclass(module = "dynid", name = "Fit", frozen)]
pub(crate) struct PyFit {
    /// The model as it is saved.
    pub identified: Arc<Identified>,
    /// Its robot.
    pub dynamics: Arc<Dynamics>,
}

impl PyFit {
    /// A model of a robot with these dynamics.
    pub fn of(identified: Identified, dynamics: Dynamics) -> Self {
        Self { identified: Arc::new(identified), dynamics: Arc::new(dynamics) }
    }

    /// Torques (N, n) along a motion.
    fn along<'py>(
        &self,
        py: Python<'py>,
        chi: &[f64],
        arrays: [&Bound<'py, PyAny>; 4],
    ) -> PyResult<Bound<'py, PyAny>> {
        let measured =
            |term: &&EffectTerm| matches!(term.effect.form(), Form::Heard(_) | Form::Compliance(_));
        if let Some(term) = self.identified.effects.iter().find(measured) {
            return Err(error(format!(
                "{} follows the torques that were measured: dynid validate predicts a recording",
                term.effect.words().title()
            )));
        }
        let model = self.dynamics.model();
        let SampledReference { step, q, dq, ddq, .. } = motion(model.robot().joints(), arrays)?;
        let start = series("t", arrays[0])?.first().copied().unwrap_or(0.0);
        let torque = vec![vec![0.0; q.first().map_or(0, Vec::len)]; q.len()];
        let name = "motion".to_owned();
        let motion = Motion {
            name,
            rate: step.recip(),
            start,
            q,
            dq,
            ddq,
            torque,
            fixed: Vec::new(),
            edge_samples: 0,
        };
        let predictor = Predictor { chi, effects: &self.identified.effects, delay: self.identified.delay };
        let found = py.detach(|| predictor.torques(model, &motion)).map_err(|why| error(why.to_string()))?;
        Ok(rows(py, &found).into_any())
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

    /// Torques that it predicts (N, n), N.m or N. A model with laws beside its parameters, as a diagnosis makes it, needs the
    /// times ``t`` (N,), s, evenly spaced: a law may look at all that went before. With them the torques are as late as the
    /// channel that recorded them.
    #[pyo3(signature = (q, dq, ddq, t = None))]
    fn predict<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        ddq: &Bound<'py, PyAny>,
        t: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = self.dynamics.model();
        let missing = |name| error(format!("the model has no {name}, which its robot needs"));
        let chi = self.identified.chi(model.robot()).map_err(missing)?;
        match t {
            Some(t) => self.along(py, &chi, [t, q, dq, ddq]),
            None if self.identified.effects.is_empty() => torques(py, model, &chi, [q, dq, ddq]),
            None => Err(error(
                "the model has laws beside its parameters, which look at a motion: give its times t as well",
            )),
        }
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
