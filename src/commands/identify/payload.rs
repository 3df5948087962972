//! `identify --payload-only`: the payload that a robot carries, beyond a model of it without one.

use std::path::Path;

use dynid_runtime::estimation::observe::{Equations, Observation, ObserveSettings, observe};
use dynid_runtime::estimation::{PayloadFit, ReferenceModel, payload_of};
use dynid_runtime::model::Model;
use dynid_runtime::model_file::{Identified, difference};
use dynid_runtime::prediction::{Predictor, observed_errors};
use dynid_runtime::report::percent;
use serde::Serialize;

use super::Arguments;
use super::load::{PayloadJson, payload_table};
use crate::failure::Failure;
use crate::output::{print, write_json};
use crate::recorded::{Observed, left_out_words, observe_failure, read_observed};
use crate::saved::{known_parameters, read_model};

/// Squared distance of the fitted numbers from a body, in standard deviations for each determined one, above which they are
/// said to be none. Of ten, one in a thousand gets as far by noise.
const NO_BODY: f64 = 3.0;

/// Finds it, prints, writes.
pub(super) fn run(arguments: &Arguments, path: &Path) -> Result<(), Failure> {
    let identified = read_model(path)?;
    let observed = read_observed(&arguments.recording, &arguments.sampling, &[Equations::Torque])?;
    let model = observed.recorded.dynamics.model();
    let robot = model.robot();
    if let Some(what) = identified.table.as_ref().and_then(|table| difference(table, robot)) {
        return Err(Failure::Input(format!(
            "{} is a model of another robot than {} ({what}): identify the robot without payload with the table that the \
             recording names",
            path.display(),
            arguments.recording.recording.display(),
        )));
    }
    let chi = known_parameters(&identified, robot, path)?;
    let covariance = identified.base_covariance(robot);
    if covariance.diagonal().iter().all(|v| *v <= 0.0) {
        return Err(Failure::Input(format!(
            "{}: it has no standard deviations: identify the robot without payload with --method idim-wls",
            path.display()
        )));
    }
    let rows = without_laws(&observed, &identified, &chi, &arguments.recording.recording)?;
    let reference = ReferenceModel { chi, covariance };
    let found = payload_of(robot, &rows, &reference)
        .map_err(|error| Failure::Data(format!("{}: {error}", arguments.recording.recording.display())))?;
    let errors = [&reference.chi, &found.chi].map(|chi| observed_errors(&rows, chi).relative_error);
    if arguments.json.as_deref() != Some(Path::new("-")) {
        print(&words(&observed, &found, errors));
    }
    if let Some(to) = &arguments.json {
        let all = PayloadOnly {
            robot: robot.name.to_string(),
            payload: PayloadJson::of(&found.body),
            free: found.free,
            distance: found.cost,
            determined: found.determined,
            relative_error_without: errors[0],
            relative_error: errors[1],
        };
        write_json(to, &all)?;
    }
    Ok(())
}

/// The rows of the recording, the torques of the model's laws taken out.
fn without_laws(
    observed: &Observed,
    identified: &Identified,
    chi: &[f64],
    recording: &Path,
) -> Result<Observation, Failure> {
    let model: &dyn Model = observed.recorded.dynamics.model();
    if identified.effects.is_empty() && identified.delay == 0.0 {
        return observed
            .observations
            .first()
            .cloned()
            .ok_or_else(|| Failure::Data("nothing was observed".to_owned()));
    }
    let refused = |what: String| Failure::Data(format!("{}: {what}", recording.display()));
    if !observed.whole {
        let why = "too long for a model with laws to be taken out of it: choose a part with --from and --to";
        return Err(refused(why.to_owned()));
    }
    let bare = Predictor { chi, effects: &[], delay: 0.0 };
    let full = Predictor { chi, effects: &identified.effects, delay: identified.delay };
    let mut motions = observed.recorded.motions.clone();
    for motion in &mut motions {
        let of =
            |predictor: &Predictor<'_>| predictor.torques(model, motion).map_err(|e| refused(e.to_string()));
        let (with, without) = (of(&full)?, of(&bare)?);
        let laws = with.iter().flatten().zip(without.iter().flatten());
        for (torque, (a, b)) in motion.torque.iter_mut().flatten().zip(laws) {
            *torque -= a - b;
        }
    }
    let settings = ObserveSettings { keep_rows: true, ..observed.recorded.settings.clone() };
    observe(model, &motions, Equations::Torque, None, &settings, None)
        .map_err(|error| observe_failure(recording, &error))
}

fn words(observed: &Observed, found: &PayloadFit, errors: [Option<f64>; 2]) -> String {
    let mut text = format!("{}\n", observed.recorded.heading());
    for line in left_out_words(&observed.recorded.rows) {
        text.push_str(&format!("{line}\n"));
    }
    text.push_str(&format!(
        "\n{}",
        payload_table(&found.body, observed.recorded.dynamics.model().robot().flange().map_or(0, |k| k + 1))
    ));
    text.push_str(&format!(
        "\n\nrelative error of the torques {} without it, {} with it",
        percent(errors[0]),
        percent(errors[1])
    ));
    let mass = &found.body.mass;
    if mass.sigma.is_some_and(|sigma| mass.value.abs() < 3.0 * sigma) {
        text.push_str("\nwarning: the mass is not more than its uncertainty: there may be no payload");
    }
    if found.cost > NO_BODY * found.determined as f64 {
        text.push_str(
            "\nwarning: what was fitted is farther from a body than its uncertainty: friction or laws of the robot may have \
             changed since the model was made; `dynid diagnose --reference` tells which",
        );
    }
    text
}

#[derive(Debug, Serialize)]
struct PayloadOnly {
    robot: String,
    payload: PayloadJson,
    /// The ten numbers before they were made a body.
    free: [f64; 10],
    /// Squared distance of these from the body, in standard deviations.
    distance: f64,
    /// How many directions among the ten numbers are determined.
    determined: usize,
    relative_error_without: Option<f64>,
    relative_error: Option<f64>,
}
