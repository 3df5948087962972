//! Identification: parameters from recordings.

use std::path::{Path, PathBuf};

use dynid::commands::identify::method::Identification;
use dynid::commands::identify::simulated::{Plan, Task};
use dynid::failure::Failure;
use dynid::recorded::{LeftOut, Measured, Recorded, observe_failure};
use dynid::speeds::{and_of_speeds, speed_words};
use dynid::verdict;
use dynid_runtime::diagnosis::Progress;
use dynid_runtime::estimation::observe::{Equations, Observation};
use dynid_runtime::estimation::{
    Estimate, EstimateSettings, Method, ObservedRecording, RecordedSettings, estimate, observe_trajectories,
};
use dynid_runtime::model_file::{EvaluatedRows, Identified};
use dynid_runtime::prediction::observed_errors;
use pyo3::prelude::*;

use crate::error::{error, of_failure};
use crate::fit::PyFit;
use crate::interruptible::{self, Watch};
use crate::ranges;
use crate::recording::{copy, one};
use crate::robot::again;
use crate::signals::motion;

/// Identifies the base parameters of a recording, or of several of one robot.
///
/// ``method`` is idim-ols, idim-wls, pim-ols, pim-wls, idim-irls, pim-irls, idim-tls or pim-tls; or idim-iv or idim-didim,
/// which simulate the motions that were ``planned``: a CSV or a folder as ``dynid excite`` writes it, or a list with
/// ``(t, q, dq, ddq)`` for each motion of the recording, evenly sampled from its time 0. ``band`` is that of the equations, Hz.
/// A recording that no such robot can have made is refused, unless ``implausible``. ``progress(share, what)`` is called
/// about every 50 ms; ``True`` is a bar of tqdm, where that is installed.
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
#[pyo3(signature = (
    recording, method = "idim-wls", *, planned = None, band = None, implausible = false, threads = 0, progress = None
))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub(crate) fn identify(
    py: Python<'_>,
    recording: &Bound<'_, PyAny>,
    method: &str,
    planned: Option<&Bound<'_, PyAny>>,
    band: Option<f64>,
    implausible: bool,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<PyFit> {
    let method: Identification = method.parse().map_err(|said: String| error(said))?;
    let recording = one(recording, "recording")?;
    let joints = recording.measured.dynamics.model().robot().joints();
    let plan = plan(method, planned, joints)?;
    let (band, threads) = (ranges::band(band)?, ranges::threads(threads)?);
    let work = Work { method, plan, band, implausible, threads };
    let (path, own) = (recording.path.clone(), copy(&recording.measured)?);
    let identified =
        interruptible::run(py, ("identification", progress), move |watch| work.identify(&path, own, watch))?;
    Ok(PyFit::of(identified.map_err(of_failure)?, again(&recording.measured.dynamics)?))
}

/// The motions that a method simulates, where it does: a path, or (t, q, dq, ddq) of each.
fn plan(method: Identification, planned: Option<&Bound<'_, PyAny>>, joints: usize) -> PyResult<Option<Plan>> {
    let planned = match (method.simulates(), planned) {
        (None, None) => return Ok(None),
        (Some(what), None) => {
            return Err(error(format!(
                "{}: {what} needs the planned motions, which a recording does not hold: give them as planned, a path or a \
                 list with (t, q, dq, ddq) for each motion of the recording",
                method.name()
            )));
        }
        (None, Some(_)) => {
            return Err(error(format!(
                "planned is for idim-iv and idim-didim; {} does not simulate",
                method.name()
            )));
        }
        (Some(_), Some(planned)) => planned,
    };
    if let Ok(path) = planned.extract::<PathBuf>() {
        return Plan::read(&path, joints).map(Some).map_err(of_failure);
    }
    let wrong = |_| error("planned: expected a path, or a list with (t, q, dq, ddq) for each motion");
    let mut motions = Vec::new();
    for item in planned.try_iter().map_err(wrong)? {
        let [t, q, dq, ddq]: [Bound<'_, PyAny>; 4] = item.and_then(|item| item.extract()).map_err(wrong)?;
        let which = |why: PyErr| error(format!("planned[{}]: {}", motions.len(), why.value(planned.py())));
        motions.push(motion(joints, [&t, &q, &dq, &ddq]).map_err(which)?);
    }
    Ok(Some(Plan { motions, path: PathBuf::from("planned") }))
}

/// What is asked for.
struct Work {
    method: Identification,
    plan: Option<Plan>,
    band: Option<f64>,
    implausible: bool,
    threads: usize,
}

impl Work {
    /// As `dynid identify`.
    fn identify(&self, path: &Path, measured: Measured, watch: &Watch) -> Result<Identified, Failure> {
        let mut settings = RecordedSettings { band: self.band, ..RecordedSettings::default() };
        settings.rows.threads = self.threads;
        let power = Equations::Power { closed_form: false };
        let equations: &[Equations] =
            if self.method.method().is_power() { &[power, Equations::Torque] } else { &[Equations::Torque] };
        let model = measured.dynamics.model();
        let progress = |done: usize, all: usize| watch.at(done as f64 / all.max(1) as f64, "samples");
        let observed =
            observe_trajectories(&measured.trajectories, model, equations, &settings, Some(&progress))
                .map_err(|error| observe_failure(path, &error))?;
        let ObservedRecording { observations, motions, settings, speeds, left_out, .. } = observed;
        let rows = LeftOut { too_short: left_out, ..measured.rows };
        let (title, robot, joints, side) = (measured.title, measured.robot, measured.joints, measured.side);
        let dynamics = measured.dynamics;
        let recorded = Recorded { dynamics, title, robot, joints, side, motions, rows, speeds, settings };
        let [observation, ..] = observations.as_slice() else {
            return Err(Failure::Data("nothing was observed".to_owned()));
        };
        watch.at(1.0, if self.plan.is_some() { "simulation" } else { "parameters" });
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
        let asked = EstimateSettings::for_method(self.method.method());
        let mut estimated = estimate(observation, &asked);
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
        let mut simulated = None;
        if let Some(plan) = &self.plan {
            let task = Task { method: self.method, recorded, recording: path, plan, r_sigma: asked.r_sigma };
            let found = task.identify(torques, &estimated)?;
            estimated = found.estimate;
            simulated = Some(found.simulated);
            warnings.extend(found.warnings);
        }
        let errors = observed_errors(torques, &estimated.chi());
        let mut rows = EvaluatedRows::observed(observation, recorded.settings.band, &estimated, errors);
        rows.rows_left_out = Some(recorded.rows.rows.left_out);
        let mut identified = Identified::new(robot, &recorded.robot, rows, &estimated);
        identified.method = self.method.name().to_owned();
        identified.simulated = simulated;
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
