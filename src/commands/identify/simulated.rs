//! Methods that simulate the planned motions: instrumental variables and DIDIM.

use std::path::{Path, PathBuf};

use dynid_runtime::estimation::observe::{Equations, Observation, ObserveSettings, observe};
use dynid_runtime::estimation::{
    Estimate, EstimateSettings, Instruments, instrumental_variables, physical_fit,
};
use dynid_runtime::model_file::SimulatedStates;
use dynid_runtime::report::{percent, significant};
use dynid_runtime::signal::Motion;
use dynid_runtime::simulation::{
    DidimError, DidimEstimate, DidimSettings, Experiment, Planned, Reference, SampledReference, apart, didim,
    simulated_motions,
};

use super::method::Identification;
use crate::failure::Failure;
use crate::motions::read as read_motions;
use crate::recorded::{Recorded, observe_failure};
use crate::words::joint_number;

/// Lowest rate of the simulated controller, Hz.
const CONTROL: f64 = 5000.0;
/// A joint that is simulated this far from where it was, as a share of its motion, was not driven like that: what a
/// torque depends on is off by as much, and a rigid model's own error is smaller.
const FAR: f64 = 0.05;

/// What such a method gives.
pub struct Outcome {
    /// The parameters.
    pub estimate: Estimate,
    /// What was simulated, and how far from the recording.
    pub simulated: SimulatedStates,
    /// What to know before believing it, in sentences.
    pub warnings: Vec<String>,
}

/// The motions that were planned, one for each that was recorded.
pub struct Plan {
    /// The motions; time 0 of each is that of its recording.
    pub motions: Vec<SampledReference>,
    /// What errors call it: its file or folder.
    pub path: PathBuf,
}

impl Plan {
    /// Reads a CSV or a folder as `dynid excite` writes it.
    ///
    /// # Errors
    /// As of [`crate::motions::read`].
    pub fn read(path: &Path, joints: usize) -> Result<Self, Failure> {
        Ok(Self { motions: read_motions(path, joints)?, path: path.to_path_buf() })
    }
}

/// What a method that simulates needs beside the recording, where it was not given.
///
/// # Errors
/// [`Failure::Input`].
pub(super) fn check(method: Identification, planned: Option<&Path>) -> Result<(), Failure> {
    match (method.simulates(), planned) {
        (Some(what), None) => Err(Failure::Input(format!(
            "--method {}: {what} needs the planned motions, which a recording does not hold: give them with --planned, a \
             CSV or a folder as `dynid excite` writes it, one motion for each of the recording, both beginning at time 0",
            method.name(),
        ))),
        (None, Some(_)) => Err(Failure::Input(format!(
            "--planned is for --method idim-iv and idim-didim; {} does not simulate",
            method.name()
        ))),
        _ => Ok(()),
    }
}

/// Whether a recording is read at once, which a simulation needs.
///
/// # Errors
/// [`Failure::Data`] where only the motions of its first pieces are there.
pub(super) fn at_once(whole: bool, recording: &Path) -> Result<(), Failure> {
    if whole {
        return Ok(());
    }
    Err(Failure::Data(format!(
        "{}: too long to be simulated at once: choose a part with --from and --to",
        recording.display()
    )))
}

/// What is identified with simulated states.
pub struct Task<'a> {
    /// One of the methods that simulate.
    pub method: Identification,
    /// The recording, all of its motions.
    pub recorded: &'a Recorded,
    /// What errors call it: its file.
    pub recording: &'a Path,
    /// What was planned.
    pub plan: &'a Plan,
    /// Ratio of relative standard deviations among essential parameters, where these are wanted.
    pub r_sigma: Option<f64>,
}

impl Task<'_> {
    /// Identifies with simulated states, from the weighted estimate of the torques.
    ///
    /// # Errors
    /// [`Failure::Input`] where the plan is none of this recording's, [`Failure::Data`] where nothing comes out.
    pub fn identify(&self, torques: &Observation, weighted: &Estimate) -> Result<Outcome, Failure> {
        let Self { method, recorded, recording, plan, r_sigma } = *self;
        let model = recorded.dynamics.model();
        let references: Vec<&dyn Reference> =
            plan.motions.iter().map(|motion| motion as &dyn Reference).collect();
        let values = weighted.chi();
        let refused = |what: String| Failure::Data(format!("{}: {what}", recording.display()));
        let planned = Planned::new(model, &values, &references, &recorded.motions, CONTROL)
            .map_err(|error| Failure::Input(format!("{}: {error}", plan.path.display())))?;
        let mut warnings = Vec::new();
        let experiments = planned.experiments();
        let mut start = values.clone();
        let mut first = simulated_motions(model, &experiments, &start);
        if let Err(error) = &first
            && let Some(fit) = physical_fit(model.robot(), torques, weighted)
        {
            warnings.push(format!(
                "the parameters of {} cannot be simulated ({error}): the motions are simulated with the nearest ones that a \
                 robot can have",
                weighted.method.name()
            ));
            start = fit.chi;
            first = simulated_motions(model, &experiments, &start);
        }
        let mut motions =
            first.map_err(|error| refused(format!("its motions cannot be simulated: {error}")))?;
        let rows =
            ObserveSettings { acceleration_noise: Vec::new(), keep_rows: true, ..recorded.settings.clone() };
        let by = BySimulation { recorded, recording, rows: &rows, refused: &refused };
        let (estimate, changes) = match method {
            Identification::Didim => {
                let found = by.didim(&experiments, &start, r_sigma)?;
                warnings.extend(not_converged(&found));
                if let Ok(last) = simulated_motions(model, &experiments, &found.estimate.chi()) {
                    motions = last;
                }
                (found.estimate, found.changes)
            }
            _ => (by.instrumental_variables(&motions, torques, weighted)?, Vec::new()),
        };
        let apart = apart(&motions, &recorded.motions);
        warnings.extend(far(&apart, recorded, &motions));
        let compared_with = weighted.method.name().to_owned();
        Ok(Outcome {
            estimate,
            simulated: SimulatedStates { compared_with, values, apart, changes },
            warnings,
        })
    }
}

/// What both methods work on.
struct BySimulation<'a> {
    recorded: &'a Recorded,
    recording: &'a Path,
    /// How rows are made of motions.
    rows: &'a ObserveSettings,
    /// The failure that a message is.
    refused: &'a dyn Fn(String) -> Failure,
}

impl BySimulation<'_> {
    /// Direct and inverse dynamic identification from a start.
    fn didim(
        &self,
        experiments: &[Experiment<'_>],
        start: &[f64],
        r_sigma: Option<f64>,
    ) -> Result<DidimEstimate, Failure> {
        let estimate = EstimateSettings { r_sigma, ..EstimateSettings::default() };
        let settings = DidimSettings { observe: self.rows.clone(), estimate, ..DidimSettings::default() };
        let model = self.recorded.dynamics.model();
        didim(model, experiments, start, &settings).map_err(|error| match error {
            DidimError::Observe(error) => observe_failure(self.recording, &error),
            other => (self.refused)(format!("its motions cannot be simulated: {other}")),
        })
    }

    /// Instruments of simulated motions, with the errors that the weighted estimate has of its rows.
    fn instrumental_variables(
        &self,
        simulated: &[Motion],
        torques: &Observation,
        weighted: &Estimate,
    ) -> Result<Estimate, Failure> {
        let model = self.recorded.dynamics.model();
        let instruments = Instruments::new(model, simulated);
        let observation =
            observe(model, &self.recorded.motions, Equations::Torque, Some(&instruments), self.rows, None)
                .map_err(|error| observe_failure(self.recording, &error))?;
        let errors = errors(&observation, weighted);
        let found =
            instrumental_variables(&observation, &errors).map_err(|e| (self.refused)(e.to_string()))?;
        Ok(found.described(torques, weighted))
    }
}

/// What is said of an iteration that did not come to its end.
fn not_converged(found: &DidimEstimate) -> Option<String> {
    match &found.stopped {
        Some(why) => Some(format!(
            "DIDIM stopped after {} iterations, because the next parameters cannot be simulated ({why}): these are the last \
             ones, and they are not converged",
            found.changes.len()
        )),
        None if !found.converged => Some(format!(
            "DIDIM has not converged in {} iterations: the last one changed the parameters by {} of their size",
            found.changes.len(),
            percent(found.changes.last().copied().unwrap_or(f64::NAN))
        )),
        None => None,
    }
}

/// The error of each group of an observation, as an estimate has it.
fn errors(observation: &Observation, estimate: &Estimate) -> Vec<f64> {
    let of = |trajectory, equation| {
        let alike = estimate.errors.iter().find(|e| (e.trajectory, e.equation) == (trajectory, equation));
        alike.and_then(|e| e.sigma).filter(|sigma| *sigma > 0.0).unwrap_or(1.0)
    };
    observation.groups.iter().map(|g| of(g.trajectory, g.equation)).collect()
}

/// The joint that is simulated farthest from where it was, where that is too far.
fn far(apart: &[f64], recorded: &Recorded, motions: &[Motion]) -> Option<String> {
    let moving = |j: &usize| motions.iter().any(|m| !m.fixed.contains(j));
    let worst = (0..apart.len()).filter(moving).max_by(|&a, &b| apart[a].total_cmp(&apart[b]))?;
    (apart[worst] > FAR).then(|| {
        format!(
            "joint {} is simulated {} of its motion away from where it was recorded: the plan, its time, or the robot's \
             controller (`nominal: kp, kd, ki`) is another one",
            joint_number(recorded.dynamics.model().robot(), worst),
            percent(apart[worst])
        )
    })
}

/// What was simulated and how well, for a person.
pub(super) fn words(simulated: &SimulatedStates) -> String {
    let worst = simulated.apart.iter().fold(0.0_f64, |m, &a| m.max(a));
    let mut text = format!(
        "the planned motions were simulated from the values of {}; simulated and measured positions are {} apart at most",
        simulated.compared_with,
        percent(worst)
    );
    if !simulated.changes.is_empty() {
        let changes: Vec<String> = simulated.changes.iter().map(|c| significant(*c, 2)).collect();
        text.push_str(&format!("; change in each iteration: {}", changes.join(", ")));
    }
    text
}
