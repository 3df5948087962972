//! Reading a saved model: every field is checked before anything is computed with it.

use super::error::FileError;
use super::fingerprint::fingerprint;
use super::identified::{Identified, NamedParameter, SCHEMA};
use super::table;
use crate::diagnosis::BetweenMotions;

/// Reads a saved model from the text of its file.
///
/// # Errors
/// The place of the first mistake: line and column where the text is no saved model, the path of a field where the
/// field is there and cannot be right, or a schema that is newer than this program.
pub fn read(text: &str) -> Result<Identified, FileError> {
    #[derive(serde::Deserialize)]
    struct Version {
        #[serde(default)]
        schema_version: u32,
    }
    let syntax = |error: serde_json::Error| {
        let place = format!("{}:{}", error.line(), error.column());
        let text = error.to_string();
        let what = text.rsplit_once(" at line ").map_or(text.as_str(), |(what, _)| what);
        FileError::new(place, &format!("not a saved model: {what}"))
    };
    let version: Version = serde_json::from_str(text).map_err(syntax)?;
    if version.schema_version > SCHEMA {
        let what = format!(
            "{}: this dynid reads models up to schema {SCHEMA}: a newer one wrote it",
            version.schema_version
        );
        return Err(FileError::new("schema_version".to_owned(), &what));
    }
    let mut identified: Identified = serde_json::from_str(text).map_err(syntax)?;
    // Files from before schema 1 had zeros where nothing was known.
    if identified.schema_version == 0 {
        identified.condition_number = identified.condition_number.filter(|c| *c > 0.0);
    }
    check(&identified)?;
    Ok(identified)
}

/// Checks a saved model. The effects of one without a table can only be checked with the robot it names:
/// [`crate::effects::EffectTerm::check`].
///
/// # Errors
/// The path of the first field that cannot be, and why.
pub fn check(identified: &Identified) -> Result<(), FileError> {
    let wrong = |field: &str, what: String| Err(FileError::new(field.to_owned(), &what));
    if !(identified.band.is_finite() && identified.band > 0.0) {
        return wrong("band", format!("{}: it must be a positive number of Hz", identified.band));
    }
    if !identified.delay.is_finite() {
        return wrong("delay", "it is not a finite number of seconds".to_owned());
    }
    if identified.delay_sigma.is_some_and(|sigma| !(sigma.is_finite() && sigma >= 0.0)) {
        return wrong("delay_sigma", "it must be a number of seconds, not below zero".to_owned());
    }
    check_parameters("base_parameters", &identified.base_parameters)?;
    if let Some(essential) = &identified.essential_parameters {
        check_parameters("essential_parameters.parameters", &essential.parameters)?;
    }
    if let Some(covariance) = &identified.covariance {
        covariance.check()?;
    }
    let impossible = |differs: &Option<BetweenMotions>| differs.is_some_and(|d| !d.is_possible());
    if let Some(j) = identified.between_motions.iter().position(impossible) {
        let what = "statistics must not be negative, freedom and stretch must be positive".to_owned();
        return wrong(&format!("between_motions[{j}]"), what);
    }
    if let Some(recording) = &identified.recording {
        let is_digest =
            recording.sha256.len() == 64 && recording.sha256.bytes().all(|byte| byte.is_ascii_hexdigit());
        if !is_digest {
            return wrong("recording.sha256", "it must have 64 hexadecimal digits".to_owned());
        }
        if let (Some(from), Some(to)) = (recording.from, recording.to)
            && from >= to
        {
            return wrong("recording.from", format!("{from} s is not before `to`, {to} s"));
        }
    }
    let Some(robot) = &identified.table else {
        if identified.schema_version > 0 {
            return wrong("table", "it is not there: the model does not say of which robot it is".to_owned());
        }
        return Ok(());
    };
    table::check(robot)?;
    if let Some(speeds) = &identified.standstill {
        let (found, joints) = (speeds.len(), robot.joints());
        if found != joints {
            return wrong("standstill", format!("{found} speeds, but the robot has {joints} joints"));
        }
        if let Some(j) = speeds.iter().position(|v| !(v.is_finite() && *v >= 0.0)) {
            return wrong(&format!("standstill[{j}]"), "it must be a speed, not below zero".to_owned());
        }
    }
    let (found, joints) = (identified.between_motions.len(), robot.joints());
    if found != 0 && found != joints {
        return wrong("between_motions", format!("{found} joints, but the robot has {joints}"));
    }
    let stated = identified.fingerprint.as_deref().unwrap_or("");
    let own = fingerprint(robot);
    if stated != own {
        return wrong(
            "fingerprint",
            format!("'{stated}', but that of the table is {own}: the file was edited"),
        );
    }
    if let Err(missing) = identified.chi(robot) {
        return wrong("base_parameters", format!("{missing} of the table is not there"));
    }
    if identified.base_parameters.len() != robot.base.len() {
        let (found, known) = (identified.base_parameters.len(), robot.base.len());
        return wrong("base_parameters", format!("{found}, but the table has {known}"));
    }
    if identified.per_joint.len() != robot.joints() {
        return wrong(
            "per_joint",
            format!("{} values for {} joints", identified.per_joint.len(), robot.joints()),
        );
    }
    for (k, term) in identified.effects.iter().enumerate() {
        term.check(robot).map_err(|e| FileError::new(format!("effects[{k}].{}", e.field), &e.what))?;
    }
    Ok(())
}

fn check_parameters(list: &str, parameters: &[NamedParameter]) -> Result<(), FileError> {
    for (k, p) in parameters.iter().enumerate() {
        let wrong = |field: &str, what: &str| Err(FileError::new(format!("{list}[{k}].{field}"), what));
        if !p.value.is_finite() {
            return wrong("value", "it is not a finite number");
        }
        if p.sigma.is_some_and(|s| !(s.is_finite() && s >= 0.0)) {
            return wrong("sigma", "it must not be negative");
        }
        if parameters[..k].iter().any(|other| other.name == p.name) {
            return wrong("name", &format!("{} is there twice", p.name));
        }
    }
    Ok(())
}
