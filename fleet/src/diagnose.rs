//! A recording against its robot's reference: which physics the reference lacks.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use dynid::commands::diagnose::diagnosis_failure;
use dynid::commands::diagnose::reference::of as reference_of;
use dynid_runtime::diagnosis::{Diagnosis, Reference, Settings, Silent, diagnose as diagnosed};
use dynid_runtime::estimation::Reduced;
use dynid_runtime::model::Robot;
use dynid_runtime::model_file::{self, fingerprint};
use dynid_runtime::recording::{Loader, Trajectory};

use crate::fetch::{Fetched, fetch};
use crate::reduce::{Outcome, Why, of_failure, of_reading};
use crate::stamp::Stamps;

/// What a robot is compared with.
#[derive(Debug, Clone, Copy)]
pub enum Against<'a> {
    /// The text of a saved model.
    Model(&'a str),
    /// [`Reduced`] as bytes: recordings of the robot from before.
    Factor(&'a [u8]),
}

/// A row of the findings.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FindingRow {
    /// The effect; `None` where nothing was found, or the recording cannot be diagnosed.
    pub effect: Option<String>,
    /// Numbers of its joints, `2` or `2 3`.
    pub joints: Option<String>,
    /// One minus the probability that it is chance, all tries counted.
    pub confidence: Option<f64>,
    /// Relative error of its joints on held-out motion, without it and with it.
    pub held_out: Option<[f64; 2]>,
    /// For a person.
    pub sentence: String,
}

/// Diagnoses the first `rows` rows of a recording against what is known of its robot. A row for each finding; one without
/// an effect where there is none.
pub fn diagnose(recording: &str, table: Option<&str>, against: Against<'_>, rows: usize) -> Vec<FindingRow> {
    let told = |sentence: String| vec![FindingRow { sentence, ..FindingRow::default() }];
    match catch_unwind(AssertUnwindSafe(|| found(recording, table, against, rows))) {
        Ok(Ok(diagnosis)) if diagnosis.findings.is_empty() => told(if diagnosis.verdict.is_empty() {
            "Nothing stands out.".into()
        } else {
            diagnosis.verdict.join(" ")
        }),
        Ok(Ok(diagnosis)) => rows_of(&diagnosis),
        Ok(Err((outcome, why))) => told(format!("Not diagnosed, {}: {why}", outcome.name())),
        Err(_) => told("dynid failed on this recording; please report it".to_owned()),
    }
}

fn rows_of(diagnosis: &Diagnosis) -> Vec<FindingRow> {
    let row = |finding: &dynid_runtime::diagnosis::Finding| FindingRow {
        effect: Some(finding.effect.clone()),
        joints: Some(finding.joints.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")),
        confidence: Some(finding.confidence),
        held_out: Some([finding.held_out_before, finding.held_out_after]),
        sentence: finding.sentence.clone(),
    };
    diagnosis.findings.iter().map(row).collect()
}

fn found(recording: &str, table: Option<&str>, against: Against<'_>, rows: usize) -> Result<Diagnosis, Why> {
    let fetched = fetch(recording, table, &mut Stamps::default()).map_err(of_reading)?;
    let model = fetched.dynamics.model();
    let trajectories = beginning(&fetched, rows)?;
    let mut settings = Settings::default();
    settings.threads = 1;
    settings.reference = Some(Arc::new(reference(against, model.robot())?));
    diagnosed(model, &trajectories, &[], &settings, &Silent)
        .map_err(|error| of_failure(diagnosis_failure(&fetched.path, &error)))
}

/// The first rows of a recording: a diagnosis holds all of its rows.
fn beginning(fetched: &Fetched, rows: usize) -> Result<Vec<Trajectory>, Why> {
    let unreadable =
        |error: dynid_runtime::recording::RecordingError| (Outcome::Unreadable, error.to_string());
    let mut loader =
        Loader::new(&fetched.manifest, fetched.dynamics.model().robot(), rows).map_err(unreadable)?;
    let mut trajectories: Vec<Trajectory> = Vec::new();
    let mut read = 0;
    while read < rows
        && let Some(next) = loader.next_trajectory().map_err(unreadable)?
    {
        read += next.time.len();
        trajectories.push(next);
    }
    Ok(trajectories)
}

fn reference(against: Against<'_>, robot: &Robot) -> Result<Reference, Why> {
    let refused = |why: String| (Outcome::Refused, why);
    match against {
        Against::Model(text) => {
            let saved = model_file::read(text).map_err(|error| refused(format!("the reference: {error}")))?;
            let its = saved.table.as_ref().unwrap_or(robot);
            reference_of(&saved, its, std::path::Path::new("the reference"), robot).map_err(of_failure)
        }
        Against::Factor(bytes) => {
            let reduced = Reduced::from_bytes(bytes).map_err(|error| refused(error.to_string()))?;
            if reduced.fingerprint() != fingerprint(robot) {
                return Err(refused(
                    "the reference is of another robot table: give both days one".to_owned(),
                ));
            }
            let found = reduced.solve();
            Reference::new(found.chi(), Vec::new(), 0.0, found.covariance, false)
                .map_err(|error| refused(error.to_string()))
        }
    }
}
