//! `identify --loaded`: gains of the drives from a recording without and one with a payload.

use std::path::Path;

use dynid_runtime::estimation::observe::Equations;
use dynid_runtime::estimation::{DriveGain, DriveGains, DriveGainsError, KnownPayload, drive_gains};
use dynid_runtime::model::{JointIndex, JointKind, Robot};
use dynid_runtime::model_file::difference;
use dynid_runtime::recording::Side;
use dynid_runtime::report::{percent, significant};
use serde::Serialize;

use super::Arguments;
use super::load::{self, PayloadJson, payload_table};
use crate::failure::Failure;
use crate::output::{print, table, write_json};
use crate::recorded::{Observed, left_out_words, read_observed};

/// Finds them, prints, writes.
pub(super) fn run(arguments: &Arguments, loaded: &Path) -> Result<(), Failure> {
    let known = match &arguments.load.payload {
        Some(path) => load::read(path)?,
        None => KnownPayload::default(),
    };
    let read = |source| read_observed(source, &arguments.sampling, &[Equations::Torque]);
    let without = read(&arguments.recording)?;
    let with = read(&arguments.recording.other(loaded))?;
    let [a, b] = [&without, &with].map(|o| o.recorded.dynamics.model().robot());
    if let Some(what) = difference(a, b) {
        return Err(Failure::Input(format!(
            "{} is of {}, and {} of another robot ({what}): gains need two recordings of one robot",
            arguments.recording.recording.display(),
            a.name,
            loaded.display()
        )));
    }
    let ([unloaded_rows], [loaded_rows]) = (&without.observations[..], &with.observations[..]) else {
        return Err(Failure::Data("nothing was observed".to_owned()));
    };
    let found = drive_gains(a, unloaded_rows, loaded_rows, &known)
        .map_err(|error| refused(&error, arguments.load.payload.as_deref(), loaded))?;
    if arguments.json.as_deref() != Some(Path::new("-")) {
        print(&words(&[&without, &with], &found, &known));
    }
    if let Some(path) = &arguments.json {
        write_json(path, &GainsJson::of(a, &found))?;
    }
    Ok(())
}

fn refused(error: &DriveGainsError, payload: Option<&Path>, loaded: &Path) -> Failure {
    match (error, payload) {
        (DriveGainsError::Payload(_), Some(path)) => Failure::Input(format!("{}: {error}", path.display())),
        _ => Failure::Data(format!("{}: {error}", loaded.display())),
    }
}

/// Value, standard deviation, and a word.
fn parts(gain: &DriveGain) -> (Option<f64>, Option<f64>, &'static str) {
    match gain {
        DriveGain::Determined { value, sigma } => (Some(*value), Some(*sigma), "determined"),
        DriveGain::Negative { value, sigma } => (Some(*value), Some(*sigma), "negative"),
        DriveGain::Undetermined => (None, None, "undetermined"),
        DriveGain::NoRows => (None, None, "no_rows"),
    }
}

fn words(recordings: &[&Observed; 2], found: &DriveGains, known: &KnownPayload) -> String {
    let robot = recordings[0].recorded.dynamics.model().robot();
    let mut text = String::new();
    for (observed, what) in recordings.iter().zip(["without payload", "with payload"]) {
        text.push_str(&format!("{} ({what})\n", observed.recorded.heading()));
        for line in left_out_words(&observed.recorded.rows) {
            text.push_str(&format!("{line}\n"));
        }
    }
    text.push_str(&format!(
        "total least squares, errors {} of the torques\n\n",
        percent(found.relative_error)
    ));
    let joint_of_gain = |j: usize| robot.joint_number(JointIndex(j)).to_string();
    let kinds: Vec<JointKind> =
        robot.frames.iter().map(|f| f.kind).filter(|k| *k != JointKind::Fixed).collect();
    let rows = found.gains.iter().enumerate().map(|(j, gain)| {
        let (value, sigma, _) = parts(gain);
        let number = |x: Option<f64>, digits| x.map_or_else(|| "-".to_owned(), |x| significant(x, digits));
        let force = kinds.get(j).map_or("N.m", |kind| kind.torque_unit());
        let said = match gain {
            DriveGain::Determined { .. } if found.absolute => format!("{force} for 1 of the recording"),
            DriveGain::Determined { .. } => "ratio".to_owned(),
            DriveGain::Undetermined => "undetermined: the payload does not load this joint".to_owned(),
            DriveGain::Negative { .. } => {
                "below zero: the recording's torque or position has the other sign".to_owned()
            }
            DriveGain::NoRows => "undetermined: it does not move in both recordings".to_owned(),
        };
        vec![joint_of_gain(j), number(value, 4), number(sigma, 2), said]
    });
    text.push_str(&table(&["joint", "gain", "sigma", "<"], rows.collect()));
    match &found.payload {
        Some(body) => text.push_str(&format!("\n\n{}", payload_table(body, robot.flange().map_or(0, |k| k + 1)))),
        None => text.push_str(
            "\n\nratios of the gains only: their scale needs the mass of the payload (`mass: ..` in the file of --payload), or values that the robot's table knows",
        ),
    }
    if let Some(joints) = coupled(recordings, robot) {
        text.push_str(&format!("\nwarning: {joints}"));
    }
    if !found.absolute && known.centre.is_some() {
        text.push_str("\nits centre was used; a payload without mass is not told");
    }
    text
}

/// What to know of joints whose torque several motors make up.
fn coupled(recordings: &[&Observed; 2], robot: &Robot) -> Option<String> {
    if recordings.iter().all(|o| o.recorded.side != Side::Motor) {
        return None;
    }
    let n = robot.joints();
    let own = |j: usize, motor: usize| robot.drive.gear.get(motor * n + j).is_some_and(|g| *g != 0.0);
    let shared: Vec<String> = (0..n)
        .filter(|&j| (0..n).any(|motor| motor != j && own(j, motor)))
        .map(|j| robot.joint_number(JointIndex(j)).to_string())
        .collect();
    (!shared.is_empty()).then(|| {
        format!(
            "the gear brings several motors to joint {}: its gain is one of all of them together, right only where theirs are \
             off by the same factor",
            shared.join(", ")
        )
    })
}

#[derive(Debug, Serialize)]
struct GainsJson {
    robot: String,
    /// Whether gains have units; else they are ratios.
    absolute: bool,
    gains: Vec<GainJson>,
    payload: Option<PayloadJson>,
    base_parameters: Vec<BaseJson>,
    relative_error: Option<f64>,
}

#[derive(Debug, Serialize)]
struct GainJson {
    joint: String,
    gain: Option<f64>,
    sigma: Option<f64>,
    state: &'static str,
}

#[derive(Debug, Serialize)]
struct BaseJson {
    name: String,
    value: f64,
}

impl GainsJson {
    fn of(robot: &Robot, found: &DriveGains) -> Self {
        let gains = found.gains.iter().enumerate().map(|(j, gain)| {
            let (value, sigma, state) = parts(gain);
            GainJson { joint: robot.joint_number(JointIndex(j)).to_string(), gain: value, sigma, state }
        });
        let base = robot.base.iter().zip(&found.base);
        Self {
            robot: robot.name.to_string(),
            absolute: found.absolute,
            gains: gains.collect(),
            payload: found.payload.as_ref().map(PayloadJson::of),
            base_parameters: base.map(|(b, v)| BaseJson { name: b.name.to_string(), value: *v }).collect(),
            relative_error: found.relative_error,
        }
    }
}
