//! Recordings: from arrays, or from files.

use std::path::PathBuf;
use std::sync::Arc;

use dynid::arguments::Source;
use dynid::recorded::{LeftOut, Measured, left_out_words, measure, of_the_same_robot};
use dynid_runtime::recording::{Side, Trajectory};
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::error::{error, of_failure};
use crate::interruptible;
use crate::ranges;
use crate::robot::{PyRobot, again, name_or_path};
use crate::signals::{Signals, series};

/// What was measured on a robot, on the joint side of its gears: one motion or several.
///
/// ``t`` (N,) in s, ``q`` (N, n) in rad or m, ``tau`` (N, n) in N.m or N, and where they were recorded ``dq`` (N, n).
/// The arrays are copied. ``a + b`` has the motions of both. Files are read by :func:`open`.
///
/// >>> import dynid, numpy as np
/// >>> r = dynid.Robot("planar_2r")
/// >>> t = np.arange(0, 4, 0.002)
/// >>> q = np.stack([np.sin(2 * t), np.cos(3 * t)], axis=1)
/// >>> rec = dynid.Recording(robot=r, t=t, q=q, tau=np.zeros_like(q))
/// >>> rec.samples, rec.motions
/// (2000, ['recording'])
#[pyclass(module = "dynid", name = "Recording", frozen)]
pub(crate) struct PyRecording {
    /// The robot, its motions and what was left out.
    pub measured: Arc<Measured>,
    /// What errors call it: its file, or its title.
    pub path: PathBuf,
}

/// One motion as it is pickled: name, t, q, tau, dq, fixed joints.
type Motion<'py> = (
    String,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Option<Bound<'py, PyArray2<f64>>>,
    Vec<usize>,
);

impl PyRecording {
    fn of(
        robot: &PyRobot,
        title: String,
        path: PathBuf,
        side: Side,
        trajectories: Vec<Trajectory>,
    ) -> PyResult<Self> {
        let measured = Measured {
            dynamics: again(&robot.dynamics)?,
            title,
            robot: robot.found.clone(),
            joints: Vec::new(),
            side,
            trajectories,
            rows: LeftOut::default(),
        };
        Ok(Self { measured: Arc::new(measured), path })
    }
}

#[pymethods]
impl PyRecording {
    #[new]
    #[pyo3(signature = (robot, t, q, tau, dq = None, title = "recording"))]
    fn new(
        robot: &PyRobot,
        t: &Bound<'_, PyAny>,
        q: &Bound<'_, PyAny>,
        tau: &Bound<'_, PyAny>,
        dq: Option<&Bound<'_, PyAny>>,
        title: &str,
    ) -> PyResult<Self> {
        let motion = trajectory(robot, title, t, [Some(q), Some(tau), dq], Vec::new())?;
        Self::of(robot, title.to_owned(), PathBuf::from(title), Side::Joint, vec![motion])
    }

    /// Its robot.
    #[getter]
    fn robot(&self) -> PyResult<PyRobot> {
        Ok(PyRobot {
            dynamics: Arc::new(again(&self.measured.dynamics)?),
            found: self.measured.robot.clone(),
        })
    }

    /// What it is called.
    #[getter]
    fn title(&self) -> &str {
        &self.measured.title
    }

    /// Samples of all motions.
    #[getter]
    fn samples(&self) -> usize {
        self.measured.trajectories.iter().map(|t| t.time.len()).sum()
    }

    /// Names of its motions.
    #[getter]
    fn motions(&self) -> Vec<&str> {
        self.measured.trajectories.iter().map(|t| t.name.as_str()).collect()
    }

    /// What of its files was not used and why, in sentences.
    #[getter]
    fn left_out(&self) -> Vec<String> {
        left_out_words(&self.measured.rows)
    }

    /// t (N,), q (N, n) and tau (N, n) of each motion, as copies.
    fn arrays<'py>(&self, py: Python<'py>) -> Vec<(Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let all = self.measured.trajectories.iter();
        all.map(|t| {
            let time = t.time.clone().into_pyarray(py).into_any();
            (time, rows(py, &t.position).into_any(), rows(py, &t.torque).into_any())
        })
        .collect()
    }

    fn __add__(&self, other: &Self) -> PyResult<Self> {
        joined(&[self, other])
    }

    fn __repr__(&self) -> String {
        let robot = self.measured.dynamics.model().robot();
        format!("dynid.Recording({:?}): {}, {} samples", self.measured.title, robot.name, self.samples())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let rebuild = py.import("dynid._dynid")?.getattr("_recording")?;
        let motions: Vec<Motion<'_>> = self
            .measured
            .trajectories
            .iter()
            .map(|t| {
                let velocity = t.velocity.as_ref().map(|v| rows(py, v));
                (
                    t.name.clone(),
                    t.time.clone().into_pyarray(py),
                    rows(py, &t.position),
                    rows(py, &t.torque),
                    velocity,
                    t.fixed.clone(),
                )
            })
            .collect();
        let motor = self.measured.side == Side::Motor;
        let arguments = (self.robot()?, self.measured.title.clone(), self.path.clone(), motor, motions);
        Ok((rebuild, arguments.into_pyobject(py)?.into_any()))
    }
}

/// A recording that was pickled. Rows that were left out of its files are not told again.
#[pyfunction]
pub(crate) fn _recording(
    robot: PyRef<'_, PyRobot>,
    title: String,
    path: PathBuf,
    motor: bool,
    motions: Vec<Motion<'_>>,
) -> PyResult<PyRecording> {
    let side = if motor { Side::Motor } else { Side::Joint };
    let motions = motions.iter().map(|(name, t, q, tau, dq, fixed)| {
        let signals = [Some(q.as_any()), Some(tau.as_any()), dq.as_ref().map(|dq| dq.as_any())];
        trajectory(&robot, name, t.as_any(), signals, fixed.clone())
    });
    let motions = motions.collect::<PyResult<_>>()?;
    PyRecording::of(&robot, title, path, side, motions)
}

/// Reads a recording that a YAML describes, as ``dynid identify recording.yaml`` does; ``robot`` is another robot than the
/// one that it names.
#[pyfunction]
#[pyo3(signature = (path, robot = None, start = None, end = None))]
pub(crate) fn open(
    py: Python<'_>,
    path: PathBuf,
    robot: Option<Bound<'_, PyAny>>,
    start: Option<f64>,
    end: Option<f64>,
) -> PyResult<PyRecording> {
    let robot = robot.as_ref().map(name_or_path).transpose()?;
    let source = Source {
        recording: path.clone(),
        robot,
        from: ranges::instant("start", start)?,
        to: ranges::instant("end", end)?,
    };
    let measured =
        interruptible::run(py, ("reading", None), move |_| measure(&source))?.map_err(of_failure)?;
    Ok(PyRecording { measured: Arc::new(measured), path })
}

/// A recording, or several of one robot as one.
pub(crate) fn one(value: &Bound<'_, PyAny>, name: &str) -> PyResult<PyRecording> {
    if let Ok(one) = value.cast::<PyRecording>() {
        return joined(&[one.get()]);
    }
    let wrong = |_| error(format!("{name}: expected a dynid.Recording or a list of them"));
    let several: Vec<Bound<'_, PyRecording>> = value
        .try_iter()
        .map_err(wrong)?
        .map(|item| item.and_then(|item| Ok(item.cast_into::<PyRecording>()?)))
        .collect::<PyResult<_>>()
        .map_err(wrong)?;
    joined(&several.iter().map(Bound::get).collect::<Vec<_>>())
}

/// Recordings of one robot as one.
fn joined(recordings: &[&PyRecording]) -> PyResult<PyRecording> {
    let [first, others @ ..] = recordings else { return Err(error("there is no recording")) };
    if others.is_empty() {
        return Ok(PyRecording { measured: Arc::clone(&first.measured), path: first.path.clone() });
    }
    let mut all = copy(&first.measured)?;
    for other in others {
        let other = of_the_same_robot(copy(&other.measured)?, &all, &other.path).map_err(of_failure)?;
        all.trajectories.extend(other.trajectories);
    }
    Ok(PyRecording { measured: Arc::new(all), path: first.path.clone() })
}

/// A recording once more, for what wants to own it.
pub(crate) fn copy(measured: &Measured) -> PyResult<Measured> {
    Ok(Measured {
        dynamics: again(&measured.dynamics)?,
        title: measured.title.clone(),
        robot: measured.robot.clone(),
        joints: measured.joints.clone(),
        side: measured.side,
        trajectories: measured.trajectories.clone(),
        rows: measured.rows.clone(),
    })
}

/// One motion of q, tau and, where there are speeds, dq.
fn trajectory(
    robot: &PyRobot,
    name: &str,
    t: &Bound<'_, PyAny>,
    [q, tau, dq]: [Option<&Bound<'_, PyAny>>; 3],
    fixed: Vec<usize>,
) -> PyResult<Trajectory> {
    let time = series("t", t)?;
    let named: Vec<_> =
        [("q", q), ("tau", tau), ("dq", dq)].into_iter().filter_map(|(n, a)| Some((n, a?))).collect();
    let joints = robot.model().robot().joints();
    let signals = Signals::read(joints, &named)?;
    if signals.single {
        return Err(error(format!(
            "q has the shape ({joints},), expected (N, {joints}): one row for each value of t"
        )));
    }
    if signals.samples != time.len() {
        return Err(error(format!("q has {} rows, and t has {} values", signals.samples, time.len())));
    }
    let views = signals.views();
    let columns: Vec<Vec<Vec<f64>>> = (0..named.len()).map(|s| views.columns(s)).collect();
    if let Some(k) = time.iter().position(|x| !x.is_finite()) {
        return Err(error(format!("t[{k}] is {}, expected a number", time[k])));
    }
    if let Some(k) = (1..time.len()).find(|&k| time[k] <= time[k - 1]) {
        return Err(error(format!(
            "t[{k}] is {}, which does not come after t[{}], {}",
            time[k],
            k - 1,
            time[k - 1]
        )));
    }
    for ((name, _), columns) in named.iter().zip(&columns) {
        for (j, column) in columns.iter().enumerate() {
            if let Some(k) = column.iter().position(|x| !x.is_finite()) {
                return Err(error(format!("{name}[{k}, {j}] is {}, expected a number", column[k])));
            }
        }
    }
    let mut columns = columns.into_iter();
    let (position, torque) = (columns.next().unwrap_or_default(), columns.next().unwrap_or_default());
    Ok(Trajectory { name: name.to_owned(), time, position, velocity: columns.next(), torque, fixed })
}

/// Signals joint by joint as an array (N, n).
pub(crate) fn rows<'py>(py: Python<'py>, signal: &[Vec<f64>]) -> Bound<'py, PyArray2<f64>> {
    let samples = signal.first().map_or(0, Vec::len);
    Array2::from_shape_fn((samples, signal.len()), |(t, j)| signal[j][t]).into_pyarray(py)
}
