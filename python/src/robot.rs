//! Robots: regressors, torques and mass matrices of many states.

use std::path::PathBuf;
use std::sync::Arc;

use dynid::models;
use dynid::robots::{Dynamics, recursive, resolve};
use dynid_runtime::model::{Model, RecursiveModel, Robot, energies};
use numpy::ndarray::Array3;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::dense::regressors;
use crate::error::{error, of_failure};
use crate::memory;
use crate::signals::{Signals, vector};

/// A robot and its dynamics in closed form, linear in its base parameters chi (n joints, p parameters).
///
/// ``robot`` is the name of a generated model (see :func:`robots`), or the path of a robot YAML or of a URDF. Signals are
/// arrays (N, n), one row a sample, in rad or m and seconds; vectors (n,) are one state, and the answer then has no N.
/// Arrays whose columns lie one after the other in memory (``order="F"``) are read where they are.
///
/// >>> import dynid, numpy as np
/// >>> r = dynid.Robot("tx40")
/// >>> r.joints, len(r.names), r.names[:3]
/// (6, 60, ['ZZ1R', 'Fv1', 'Fc1'])
/// >>> rng = np.random.default_rng(1)
/// >>> q, dq, ddq = rng.uniform(-1, 1, (3, 100, r.joints))
/// >>> W = r.regressor(q, dq, ddq)
/// >>> W.shape
/// (100, 6, 60)
/// >>> np.allclose(W @ r.chi, r.torque(r.chi, q, dq, ddq))
/// True
#[pyclass(module = "dynid", name = "Robot", frozen)]
pub(crate) struct PyRobot {
    /// What it computes.
    pub dynamics: Arc<Dynamics>,
    /// How a person finds it again.
    pub found: String,
}

impl PyRobot {
    /// The model.
    pub fn model(&self) -> &dyn Model {
        self.dynamics.model()
    }

    fn description(&self) -> &Robot {
        self.model().robot()
    }

    fn chi_of(&self, chi: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
        vector("chi", chi, self.description().base.len(), "base parameter")
    }
}

/// The same dynamics once more, for what wants to own it.
pub(crate) fn again(dynamics: &Dynamics) -> PyResult<Dynamics> {
    match dynamics {
        Dynamics::Generated(model) => Ok(Dynamics::Generated(*model)),
        Dynamics::Recursive(model) => {
            recursive(model.robot().clone(), &model.robot().name).map_err(of_failure)
        }
    }
}

#[pymethods]
impl PyRobot {
    #[new]
    fn new(py: Python<'_>, robot: &Bound<'_, PyAny>) -> PyResult<Self> {
        let robot = name_or_path(robot)?;
        let dynamics = py.detach(|| resolve(&robot, None)).map_err(of_failure)?;
        Ok(Self { dynamics: Arc::new(dynamics), found: robot })
    }

    /// Its name.
    #[getter]
    fn name(&self) -> String {
        self.description().name.to_string()
    }

    /// Number of joints n.
    #[getter]
    fn joints(&self) -> usize {
        self.description().joints()
    }

    /// Names of the base parameters, in the order of chi.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.description().base.iter().map(|b| b.name.to_string()).collect()
    }

    /// SI units of the base parameters.
    #[getter]
    fn units(&self) -> Vec<String> {
        self.description().base.iter().map(|b| b.unit.to_string()).collect()
    }

    /// What is regrouped into each base parameter, as a formula.
    #[getter]
    fn relations(&self) -> Vec<String> {
        self.description().base.iter().map(|b| b.relation.to_string()).collect()
    }

    /// Whether the model is generated code, or the recursive engine over a table that was read: the same numbers, slower.
    #[getter]
    fn generated(&self) -> bool {
        matches!(*self.dynamics, Dynamics::Generated(_))
    }

    /// chi of the nominal parameters of the robot's YAML (p,).
    #[getter]
    fn chi<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let robot = self.description();
        match &robot.nominal {
            Some(nominal) => Ok(robot.base_from_standard(&nominal.standard).into_pyarray(py)),
            None => Err(error(format!("{} has no nominal parameters", robot.name))),
        }
    }

    /// Base torque regressor W (N, n, p) with torque = W chi.
    ///
    /// ``out`` is an array (N, n, p) of float64 to write to instead of a new one. ``threads`` work at once, 0 for as many as
    /// the machine has; the numbers do not depend on it. The memory of a large array that is dropped serves the next one,
    /// unless the system takes it back before.
    #[pyo3(signature = (q, dq, ddq, out = None, *, threads = 0))]
    fn regressor<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        ddq: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
        threads: usize,
    ) -> PyResult<Bound<'py, PyAny>> {
        let robot = self.description();
        let (joints, columns) = (robot.joints(), robot.base.len());
        let signals = Signals::read(joints, &[("q", q), ("dq", dq), ("ddq", ddq)])?;
        let shape = [signals.samples, joints, columns];
        let array = match out {
            None => memory::array(py, shape)?,
            Some(given) => room(given, shape)?,
        };
        let mut writable = array.try_readwrite().map_err(|why| error(format!("out: {why}")))?;
        let numbers = writable.as_slice_mut().map_err(|why| error(format!("out: {why}")))?;
        let (views, model) = (signals.views(), self.model());
        py.detach(|| {
            regressors(model, views.samples(), threads, numbers, |range, write| {
                views.blocks_of(range, |_, states| write(states));
            });
        });
        drop(writable);
        if signals.single && out.is_none() {
            Ok(array.reshape([joints, columns])?.into_any())
        } else {
            Ok(array.into_any())
        }
    }

    /// The entries of the regressor that are not zero for every state: an array (N, entries), one entry after the other in
    /// memory, in the order of :attr:`pattern`.
    fn regressor_entries<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        ddq: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let signals = Signals::read(self.joints(), &[("q", q), ("dq", dq), ("ddq", ddq)])?;
        let entries = self.model().pattern().columns.len();
        by_column(py, &signals, entries, |states, stride, out| self.model().idm_block(states, stride, out))
    }

    /// Joints (from 0) and base parameters (from 0) of the entries of :meth:`regressor_entries`.
    #[getter]
    fn pattern<'py>(&self, py: Python<'py>) -> (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>) {
        let pattern = self.model().pattern();
        let rows = pattern.rows.windows(2).enumerate().flat_map(|(j, r)| vec![j as i64; r[1] - r[0]]);
        let columns = pattern.columns.iter().map(|&c| c as i64);
        (rows.collect::<Vec<_>>().into_pyarray(py), columns.collect::<Vec<_>>().into_pyarray(py))
    }

    /// Energy (N,) of base parameters chi, J, kinetic and potential: its rate is the power without friction. The zero of its
    /// potential is that of the base parameters.
    fn energy<'py>(
        &self,
        py: Python<'py>,
        chi: &Bound<'py, PyAny>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (chi, model) = (self.chi_of(chi)?, self.model());
        let signals = Signals::read(self.joints(), &[("q", q), ("dq", dq)])?;
        let views = signals.views();
        let found = py.detach(|| {
            let mut all = Vec::with_capacity(views.samples());
            views.blocks(|_, states| all.extend(energies(model, &chi, states)));
            all
        });
        match (signals.single, found.as_slice()) {
            (true, [one]) => Ok(one.into_pyobject(py)?.into_any()),
            _ => Ok(found.into_pyarray(py).into_any()),
        }
    }

    /// Energy regressor h (N, p): h chi is the energy, J, but for what is in offsets (:meth:`energy` has all of it). Columns
    /// of friction and offsets are zero.
    fn energy_regressor<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let signals = Signals::read(self.joints(), &[("q", q), ("dq", dq)])?;
        let columns = self.description().base.len();
        by_column(py, &signals, columns, |states, stride, out| self.model().energy_block(states, stride, out))
    }

    /// Power regressor dh (N, p), friction included: the power of the motors is dh chi, W.
    fn power_regressor<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        ddq: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let signals = Signals::read(self.joints(), &[("q", q), ("dq", dq), ("ddq", ddq)])?;
        let columns = self.description().base.len();
        by_column(py, &signals, columns, |states, stride, out| self.model().power_block(states, stride, out))
    }

    /// Torques of base parameters chi (N, n), N.m or N: friction, rotor inertias and offsets included.
    fn torque<'py>(
        &self,
        py: Python<'py>,
        chi: &Bound<'py, PyAny>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        ddq: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        torques(py, self.model(), &self.chi_of(chi)?, [q, dq, ddq])
    }

    /// Mass matrices M (N, n, n) of base parameters chi.
    fn mass_matrix<'py>(
        &self,
        py: Python<'py>,
        chi: &Bound<'py, PyAny>,
        q: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let chi = self.chi_of(chi)?;
        let (n, model) = (self.joints(), self.model());
        let signals = Signals::read(n, &[("q", q)])?;
        let views = signals.views();
        let matrices = py.detach(|| {
            let mut all = vec![0.0; views.samples() * n * n];
            let (still, mut state, mut bias) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
            views.blocks(|range, states| {
                for (t, mass) in range.clone().zip(all[range.start * n * n..].chunks_exact_mut(n * n)) {
                    for (x, q) in state.iter_mut().zip(states.q) {
                        *x = q[t - range.start];
                    }
                    model.mass_and_bias(&chi, &state, &still, mass, &mut bias);
                }
            });
            all
        });
        let matrices =
            Array3::from_shape_vec((signals.samples, n, n), matrices).map_err(|e| error(e.to_string()))?;
        let matrices = matrices.into_pyarray(py);
        if signals.single { Ok(matrices.reshape([n, n])?.into_any()) } else { Ok(matrices.into_any()) }
    }

    fn __repr__(&self) -> String {
        let robot = self.description();
        format!(
            "dynid.Robot({:?}): {} joints, {} base parameters",
            self.found,
            robot.joints(),
            robot.base.len()
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String, String))> {
        let rebuild = py.import("dynid._dynid")?.getattr("_robot")?;
        let table = match &*self.dynamics {
            Dynamics::Generated(_) => String::new(),
            Dynamics::Recursive(model) => {
                serde_json::to_string(model.robot()).map_err(|why| error(why.to_string()))?
            }
        };
        Ok((rebuild, (self.found.clone(), table)))
    }
}

/// What names a robot: a string, or a path as Python has them.
pub(crate) fn name_or_path(robot: &Bound<'_, PyAny>) -> PyResult<String> {
    let path: PathBuf = robot
        .extract()
        .map_err(|_| error("robot: expected a name, or the path of a robot YAML or of a URDF"))?;
    path.into_os_string()
        .into_string()
        .map_err(|path| error(format!("robot: {path:?} is no text in Unicode")))
}

/// A robot that was pickled: its name, and its table where it is no generated one.
#[pyfunction]
pub(crate) fn _robot(found: String, table: &str) -> PyResult<PyRobot> {
    let dynamics = if table.is_empty() {
        resolve(&found, None).map_err(of_failure)?
    } else {
        let robot: Robot =
            serde_json::from_str(table).map_err(|why| error(format!("a pickled robot: {why}")))?;
        let model = RecursiveModel::new(robot).map_err(|why| error(format!("a pickled robot: {why}")))?;
        Dynamics::Recursive(Box::new(model))
    };
    Ok(PyRobot { dynamics: Arc::new(dynamics), found })
}

/// Names of the generated models.
#[pyfunction]
pub(crate) fn robots() -> Vec<String> {
    models::all().iter().map(|model| model.robot().name.to_string()).collect()
}

/// Torques of parameters at signals q, dq, ddq: (N, n).
pub(crate) fn torques<'py>(
    py: Python<'py>,
    model: &dyn Model,
    chi: &[f64],
    [q, dq, ddq]: [&Bound<'py, PyAny>; 3],
) -> PyResult<Bound<'py, PyAny>> {
    let joints = model.robot().joints();
    let signals = Signals::read(joints, &[("q", q), ("dq", dq), ("ddq", ddq)])?;
    by_column(py, &signals, joints, |states, stride, out| model.torque_block(chi, states, stride, out))
}

/// What a batch function writes column by column, as an array (N, columns) that is not copied: its columns lie one after
/// the other in memory.
fn by_column<'py>(
    py: Python<'py>,
    signals: &Signals<'py>,
    columns: usize,
    evaluate: impl Fn(dynid_runtime::model::States<'_>, usize, &mut [f64]) + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let samples = signals.samples;
    let array = PyArray2::<f64>::zeros(py, [columns, samples], false);
    let mut writable = array.readwrite();
    let numbers = writable.as_slice_mut().map_err(|why| error(why.to_string()))?;
    let (views, evaluate) = (signals.views(), &evaluate);
    py.detach(|| views.blocks(|range, states| evaluate(states, samples, &mut numbers[range.start..])));
    drop(writable);
    let rows = array.call_method0("transpose")?;
    if signals.single { rows.call_method1("reshape", PyTuple::new(py, [columns])?) } else { Ok(rows) }
}

/// An array to write a regressor to.
fn room<'py>(given: &Bound<'py, PyAny>, shape: [usize; 3]) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let wanted = || error(format!("out must be an array {shape:?} of float64 in the order of C"));
    let array = given.cast::<PyArray3<f64>>().map_err(|_| wanted())?;
    if array.shape() == shape && array.is_c_contiguous() { Ok(array.clone()) } else { Err(wanted()) }
}
