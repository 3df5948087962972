//! A recording reduced where it lies: a triangle for each motion, or why there is none.

use std::panic::{AssertUnwindSafe, catch_unwind};

use dynid::failure::Failure;
use dynid::recorded::{observe_failure, recording_failure};
use dynid::speeds::speed_words;
use dynid::verdict;
use dynid_runtime::estimation::observe::{Equations, ObserveSettings};
use dynid_runtime::estimation::{
    EstimateSettings, ObserveRecordingError, ObservedRecording, RecordedSettings, Reduced, estimate,
    observe_recording,
};
use dynid_runtime::plausibility::Judged;
use dynid_runtime::recording::{Conditions, Side, conditions};

use crate::error::FleetError;
use crate::fetch::{Fetched, fetch};
use crate::stamp::Stamps;

/// Most motions of a recording that have rows of their own: each is 15 to 30 kB, which travel and are kept.
const MOST_MOTIONS: usize = 32;

/// What became of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Its motions are used.
    Used,
    /// It was read, but no such robot can have made it, or it says nothing.
    Refused,
    /// It cannot be read.
    Unreadable,
    /// dynid failed on it: a mistake of the program.
    Failed,
}

impl Outcome {
    /// As it stands in tables.
    pub fn name(self) -> &'static str {
        match self {
            Outcome::Used => "used",
            Outcome::Refused => "refused",
            Outcome::Unreadable => "unreadable",
            Outcome::Failed => "failed",
        }
    }
}

/// A motion of a recording, or the recording that has none.
#[derive(Debug, Clone)]
pub struct Motion {
    /// Its name; `None` where the recording gave none.
    pub name: Option<String>,
    /// [`Reduced`] as bytes.
    pub factor: Option<Vec<u8>>,
    /// Equations that were used.
    pub rows: u64,
    /// Samples of the whole recording.
    pub samples: u64,
    /// Rows of the recording's files that cannot be right.
    pub left_out: u64,
    /// Band of the equations, Hz.
    pub band: Option<f64>,
    /// ||Y - W chi|| / ||Y|| of the recording with its own parameters.
    pub relative_error: Option<f64>,
    /// What became of the recording.
    pub outcome: Outcome,
    /// What to know about it, or why it is not used.
    pub message: Option<String>,
    /// The name that the robot's table has.
    pub table_name: Option<String>,
    /// Mean temperature of the recording, °C, and mean of its load, where it says them.
    pub conditions: Conditions,
    /// [`Stamps`] of the recording's files as text.
    pub files: Option<String>,
}

/// Reduces the recording at a path or an address: a row for each of its motions, at least one. Whatever is wrong with it
/// is told in the row.
pub fn reduce(recording: &str, table: Option<&str>, band: Option<f64>) -> Vec<Motion> {
    let mut stamps = Stamps::default();
    let reduced = catch_unwind(AssertUnwindSafe(|| reduced(recording, table, band, &mut stamps)));
    let mut motions = match reduced {
        Ok(Ok(motions)) => motions,
        Ok(Err((outcome, message))) => vec![none(outcome, message)],
        Err(_) => vec![none(Outcome::Failed, "dynid failed on this recording; please report it".to_owned())],
    };
    let files = stamps.to_text();
    motions.iter_mut().for_each(|motion| motion.files.clone_from(&files));
    motions
}

fn none(outcome: Outcome, message: String) -> Motion {
    let message = Some(message);
    Motion {
        name: None,
        factor: None,
        rows: 0,
        samples: 0,
        left_out: 0,
        band: None,
        relative_error: None,
        outcome,
        message,
        table_name: None,
        conditions: Conditions::default(),
        files: None,
    }
}

/// Why a recording gives nothing.
pub type Why = (Outcome, String);

/// The failure of a command as that of a recording.
pub fn of_failure(failure: Failure) -> Why {
    let all_the_same = " (--implausible goes on all the same)";
    match failure {
        Failure::Input(words) => (Outcome::Unreadable, words),
        Failure::Data(words) => (Outcome::Refused, words.replace(all_the_same, "").replace(". .", ".")),
    }
}

/// An error of reading as that of a recording.
pub fn of_reading(error: FleetError) -> Why {
    (Outcome::Unreadable, error.to_string())
}

fn reduced(
    recording: &str,
    table: Option<&str>,
    band: Option<f64>,
    stamps: &mut Stamps,
) -> Result<Vec<Motion>, Why> {
    let fetched = fetch(recording, table, stamps).map_err(of_reading)?;
    let model = fetched.dynamics.model();
    // Recordings go beside each other, so that each needs one thread only.
    let rows = ObserveSettings { threads: 1, ..ObserveSettings::default() };
    let settings = RecordedSettings { band, cutoff: None, rows };
    let observed = observe_recording(&fetched.manifest, model, None, &[Equations::Torque], &settings, None)
        .map_err(|error| of_failure(observing(&fetched, error)))?;
    let Some(observation) = observed.observations.first() else {
        return Err((Outcome::Refused, "it gives no equations".to_owned()));
    };
    let found = estimate(observation, &EstimateSettings { r_sigma: None, ..EstimateSettings::default() });
    if found.degrees_of_freedom == 0 {
        let (rows, count) = (found.rows, model.robot().base.len());
        return Err((Outcome::Refused, format!("{rows} equations cannot determine {count} parameters")));
    }
    let mut words = speed_words(&observed.speeds, model.robot());
    words.extend(doubts(&fetched, &observed, &found).map_err(of_failure)?);
    words.extend(found.warnings.iter().map(ToString::to_string));
    words.extend(observed.left_out.iter().map(|what| format!("left out: {what}")));
    let conditions = conditions(&fetched.manifest).unwrap_or_else(|error| {
        words.push(format!("temperature and load are not known: {error}"));
        Conditions::default()
    });
    let message = (!words.is_empty()).then(|| words.join("; "));
    let row = |k: Option<usize>, name: &str| {
        let factor = Reduced::of(observation, &found, model.robot(), k);
        Motion {
            name: Some(name.to_owned()),
            rows: factor.rows() as u64,
            factor: Some(factor.to_bytes()),
            samples: observation.samples as u64,
            left_out: observed.rows.left_out,
            band: Some(observed.settings.band),
            relative_error: found.relative_error,
            outcome: Outcome::Used,
            message: message.clone(),
            table_name: Some(model.robot().name.to_string()),
            conditions,
            files: None,
        }
    };
    let names = &observation.trajectories;
    if names.len() > MOST_MOTIONS {
        return Ok(vec![row(None, &format!("{} motions", names.len()))]);
    }
    Ok(names.iter().enumerate().map(|(k, name)| row(Some(k), name)).collect())
}

fn observing(fetched: &Fetched, error: ObserveRecordingError) -> Failure {
    match error {
        ObserveRecordingError::Recording(error) => recording_failure(error),
        ObserveRecordingError::Observe(error) => observe_failure(&fetched.path, &error),
        other => Failure::Data(other.to_string()),
    }
}

/// Whether such a robot can have made the recording, as `dynid identify` asks.
fn doubts(
    fetched: &Fetched,
    observed: &ObservedRecording,
    found: &dynid_runtime::estimation::Estimate,
) -> Result<Vec<String>, Failure> {
    let Some(torques) = observed.observations.first() else { return Ok(Vec::new()) };
    let judged = Judged {
        model: fetched.dynamics.model(),
        motions: &observed.motions,
        settings: &observed.settings,
        motor_side: fetched.manifest.side == Side::Motor,
    };
    verdict::check(&fetched.path, &judged, torques, found)
}
