//! Diagnoses: which physics is missing.

use std::path::PathBuf;
use std::sync::Arc;

use dynid::arguments::{DiagnosisOptions, Source};
use dynid::commands::diagnose::compare::{Test, fitted, tested};
use dynid::commands::diagnose::{
    confirmation_failure, contradicting, diagnosis_failure, for_programs, improved, mistakes, tell_speeds,
};
use dynid::failure::Failure;
use dynid::output::write;
use dynid::pages::Prior;
use dynid::pages::diagnosis::{Extras, page, summary};
use dynid::recorded::{Measured, left_out_words, of_the_same_robot};
use dynid::speeds::{and_of_speeds, speed_words};
use dynid_runtime::confirmation::diagnose_and_confirm;
use dynid_runtime::diagnosis::{Diagnosis, Finding, Settings};
use dynid_runtime::recording::Trajectory;
use pyo3::prelude::*;

use crate::error::{error, of_failure};
use crate::fit::PyFit;
use crate::interruptible::{self, Watch};
use crate::known;
use crate::ranges;
use crate::recording::{PyRecording, copy, one};
use crate::robot::again;

/// One effect that was found.
#[pyclass(module = "dynid", name = "Finding", frozen)]
pub(crate) struct PyFinding(Finding);

#[pymethods]
impl PyFinding {
    /// The effect: ``spring``, ``stribeck``, ...
    #[getter]
    fn effect(&self) -> &str {
        &self.0.effect
    }

    /// Numbers of its joints in the robot's table, from 1; empty for the whole robot.
    #[getter]
    fn joints(&self) -> Vec<usize> {
        self.0.joints.clone()
    }

    /// One minus the probability that any of all that was tried gets as far by chance, times how often what is no accident
    /// has the right name.
    #[getter]
    fn confidence(&self) -> f64 {
        self.0.confidence
    }

    /// Its quantities: ``{name: (value, sigma, unit)}``, SI; sigma is None where it is not known.
    #[getter]
    fn parameters(&self) -> std::collections::BTreeMap<String, (f64, Option<f64>, String)> {
        let known = |sigma: f64| (sigma > 0.0).then_some(sigma);
        self.0
            .parameters
            .iter()
            .map(|(name, p)| (name.clone(), (p.value, known(p.sigma), p.unit.clone())))
            .collect()
    }

    /// What was found, for a person.
    #[getter]
    fn sentence(&self) -> &str {
        &self.0.sentence
    }

    /// Held-out relative error of its joints without it and with it.
    #[getter]
    fn held_out(&self) -> (f64, f64) {
        (self.0.held_out_before, self.0.held_out_after)
    }

    /// How much of it the test recording shows, 1 for all of it, and its standard deviation; None without a test.
    #[getter]
    fn on_test(&self) -> Option<(f64, Option<f64>)> {
        self.0.on_test.map(|part| (part.part, part.sigma))
    }

    fn __repr__(&self) -> String {
        format!("dynid.Finding({}, joints {:?}): {}", self.0.effect, self.0.joints, self.0.sentence)
    }
}

/// What a diagnosis found. Made by :func:`diagnose`.
#[pyclass(module = "dynid", name = "Diagnosis", frozen)]
pub(crate) struct PyDiagnosis {
    measured: Arc<Measured>,
    found: Diagnosed,
}

/// A diagnosis and what its page has beside it.
struct Diagnosed {
    diagnosis: Diagnosis,
    extras: Extras,
}

#[pymethods]
impl PyDiagnosis {
    /// What was found, a :class:`Finding` each.
    #[getter]
    fn findings(&self) -> Vec<PyFinding> {
        self.found.diagnosis.findings.iter().cloned().map(PyFinding).collect()
    }

    /// The verdict in sentences.
    #[getter]
    fn verdict(&self) -> Vec<String> {
        self.found.diagnosis.verdict.clone()
    }

    /// Relative error on motion that was held out, without the findings and with them.
    #[getter]
    fn held_out(&self) -> (f64, f64) {
        (self.found.diagnosis.held_out.before, self.found.diagnosis.held_out.after)
    }

    /// Relative error of the test recording, without the findings and with them; None without a test.
    #[getter]
    fn on_test(&self) -> Option<(Option<f64>, Option<f64>)> {
        match self.found.extras.tested.as_ref()?.evaluation.predictions.as_slice() {
            [before, after] => Some((before.errors.relative_error, after.errors.relative_error)),
            _ => None,
        }
    }

    /// The model with the findings, as ``dynid diagnose --out`` saves it: to be saved, or to be the ``reference`` of a later
    /// diagnosis.
    #[getter]
    fn model(&self) -> PyResult<PyFit> {
        let identified = improved(&self.measured, &self.found.diagnosis, &self.found.extras);
        Ok(PyFit::of(identified, again(&self.measured.dynamics)?))
    }

    /// The result as ``dynid diagnose --json`` writes it.
    fn json(&self) -> PyResult<String> {
        let value = for_programs(&self.found.diagnosis, &self.found.extras).map_err(of_failure)?;
        serde_json::to_string_pretty(&value).map_err(|why| error(why.to_string()))
    }

    /// Writes a page with the verdict, the plots and the numbers, as ``dynid diagnose --report``; without a simulation.
    fn report(&self, path: PathBuf) -> PyResult<()> {
        let notes = left_out_words(&self.measured.rows);
        let text = page(&self.measured.title, &self.found.diagnosis, &self.found.extras, &notes);
        write(&path, &text).map_err(of_failure)
    }

    /// What ``dynid diagnose`` prints.
    fn __str__(&self) -> String {
        summary(&self.measured, &self.found.diagnosis, &self.found.extras)
    }

    fn __repr__(&self) -> String {
        let names: Vec<String> =
            self.found.diagnosis.findings.iter().map(|f| format!("{} {:?}", f.effect, f.joints)).collect();
        format!("dynid.Diagnosis({}): [{}]", self.found.diagnosis.robot, names.join(", "))
    }
}

/// Finds out which physics the standard model of a recording leaves out, and whether it holds on held-out motion.
///
/// ``recordings`` is a recording or a list of them; no parameter is fitted to ``test``, which tells how much of each
/// finding is there; with ``baseline``, recordings from before something changed, which are diagnosed first, only what is new; with
/// ``reference``, a :class:`Fit` or the path of a saved model from before, its parameters and laws are no news, nor is what differs
/// anyway between the motions of a file that it names, where these are as they were. ``laws`` are
/// tried beside those of the catalogue: the path of a YAML, or a list of dictionaries with id, joint, law, and where needed
/// unit and shapes. ``progress(share, what)`` is called about every 50 ms; ``True`` is a bar of tqdm, where that is installed.
/// A recording that a wrong sign, order, unit or robot explains far better is refused, unless ``implausible``.
///
/// >>> import dynid, numpy as np
/// >>> r = dynid.Robot("planar_2r")
/// >>> t = np.arange(0, 12, 0.005)[:, None]
/// >>> w, phase = np.array([1.1, 1.7]), np.array([0.0, 1.0])
/// >>> q = np.sin(w * t + phase) + 0.4 * np.sin(2.9 * w * t)
/// >>> dq = w * np.cos(w * t + phase) + 1.16 * w * np.cos(2.9 * w * t)
/// >>> ddq = -w**2 * np.sin(w * t + phase) - 3.364 * w**2 * np.sin(2.9 * w * t)
/// >>> tau = r.torque(r.chi, q, dq, ddq) + np.random.default_rng(1).normal(0, 0.05, q.shape)
/// >>> tau[:, 1] += 4 * q[:, 1]                       # nobody told the model of this spring
/// >>> d = dynid.diagnose(dynid.Recording(robot=r, t=t[:, 0], q=q, tau=tau))
/// >>> [(f.effect, f.joints) for f in d.findings]
/// [('spring', [2])]
#[pyfunction]
#[pyo3(signature = (
    recordings, *, test = None, baseline = None, reference = None, laws = None, implausible = false, threads = 0,
    progress = None
))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub(crate) fn diagnose(
    py: Python<'_>,
    recordings: &Bound<'_, PyAny>,
    test: Option<&Bound<'_, PyAny>>,
    baseline: Option<&Bound<'_, PyAny>>,
    reference: Option<&Bound<'_, PyAny>>,
    laws: Option<&Bound<'_, PyAny>>,
    implausible: bool,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<PyDiagnosis> {
    let recording = one(recordings, "recordings")?;
    let other = |given: Option<&Bound<'_, PyAny>>, name| -> PyResult<Option<(PathBuf, Measured)>> {
        let Some(given) = given else { return Ok(None) };
        let other: PyRecording = one(given, name)?;
        let own = of_the_same_robot(copy(&other.measured)?, &recording.measured, &other.path)
            .map_err(of_failure)?;
        Ok(Some((other.path, own)))
    };
    if baseline.is_some() && reference.is_some() {
        return Err(error("baseline and reference are both what was before: give one of them"));
    }
    let (test, baseline) = (other(test, "test")?, other(baseline, "baseline")?);
    let (path, measured) = (recording.path, recording.measured);
    let robot = measured.dynamics.model().robot();
    let mut settings = Settings::default();
    settings.threads = ranges::threads(threads)?;
    if let Some(laws) = laws {
        settings.laws = known::laws(py, laws, robot)?;
    }
    let mut before: Vec<Trajectory> = baseline.map_or_else(Vec::new, |(_, measured)| measured.trajectories);
    let (mut prior, mut lost) = (None, None);
    if let Some(given) = reference {
        let known = known::before(given, (&Source::whole(path.clone()), &measured))?;
        (settings.reference, prior) = (Some(known.reference), Some(known.prior));
        (before, lost) = (known.origin.motions, known.origin.lost);
    }
    let work = Work { path, measured: Arc::clone(&measured), test, settings, prior, lost, implausible };
    let found = interruptible::run(py, ("diagnosis", progress), move |watch| work.diagnose(&before, watch))?;
    Ok(PyDiagnosis { measured, found: found.map_err(of_failure)? })
}

/// What is asked for.
struct Work {
    path: PathBuf,
    measured: Arc<Measured>,
    test: Option<(PathBuf, Measured)>,
    settings: Settings,
    prior: Option<Prior>,
    /// The sentence that says why the motions of a reference are not used.
    lost: Option<String>,
    implausible: bool,
}

impl Work {
    /// As `dynid diagnose`.
    fn diagnose(self, baseline: &[Trajectory], watch: &Watch) -> Result<Diagnosed, Failure> {
        let Self { path, measured, test, settings, prior, lost, implausible } = self;
        let options = DiagnosisOptions { threads: settings.threads, ..DiagnosisOptions::default() };
        if !implausible {
            mistakes::check(&path, &measured, &options)?;
        }
        let (model, trajectories) = (measured.dynamics.model(), &measured.trajectories);
        let test = match test {
            Some((path, measured)) => Some((Test::new(measured, &path, &options)?, path)),
            None => None,
        };
        let speeds = contradicting(&measured, &options);
        let outcome = match &test {
            Some((test, at)) => {
                diagnose_and_confirm(model, trajectories, baseline, &test.prepared, &settings, watch)
                    .map_err(|error| confirmation_failure(&path, Some(at), &error))
            }
            None => dynid_runtime::diagnosis::diagnose(model, trajectories, baseline, &settings, watch)
                .map_err(|error| diagnosis_failure(&path, &error)),
        };
        let robot = model.robot();
        let mut diagnosis =
            outcome.map_err(|failure| and_of_speeds(failure, &speed_words(&speeds, robot)))?;
        tell_speeds(&mut diagnosis, speeds, robot);
        diagnosis.verdict.extend(lost);
        let own = Extras::of(robot);
        let extras = Extras {
            fitted: fitted(&measured, &diagnosis, &options),
            tested: test.as_ref().map(|(test, at)| tested(test, at, &diagnosis)).transpose()?,
            prior: prior.or(own.prior.clone()),
            ..own
        };
        Ok(Diagnosed { diagnosis, extras })
    }
}
