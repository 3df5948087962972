//! What the report of a diagnosis has besides it.

use dynid_runtime::diagnosis::Diagnosis;

use super::compare::fitted;
use super::{Arguments, simulated};
use crate::failure::Failure;
use crate::pages::Prior;
use crate::pages::diagnosis::{Extras, Tested};
use crate::provenance::Provenance;
use crate::recorded::Measured;
use crate::saved::read_model;

/// Both models on the recording, the recording by simulation, what was known before, where all of it comes from.
pub(super) fn of(
    arguments: &Arguments,
    words: &[String],
    measured: &Measured,
    diagnosis: &Diagnosis,
    tested: Option<Tested>,
) -> Result<Extras, Failure> {
    let robot = measured.dynamics.model().robot();
    Ok(Extras {
        fitted: fitted(measured, diagnosis, &arguments.sampling),
        tested,
        forward: simulated(measured, diagnosis, arguments.closed_loop),
        prior: match &arguments.reference {
            Some(path) => Some(Prior::saved("reference", &read_model(path)?, robot)),
            None => Prior::nominal(robot),
        },
        from: if arguments.report.is_some() { provenance(arguments, words)? } else { Provenance::default() },
        ..Extras::of(robot)
    })
}

/// What the report says of its files.
fn provenance(arguments: &Arguments, words: &[String]) -> Result<Provenance, Failure> {
    let mut from = Provenance::of(words);
    let source = &arguments.recording;
    for path in [Some(&source.recording), arguments.baseline.as_ref(), arguments.test.as_ref()] {
        path.map_or(Ok(()), |path| from.recording(path, source.robot.as_deref()))?;
    }
    for path in [&arguments.reference, &arguments.laws] {
        path.as_ref().map_or(Ok(()), |path| from.file(path))?;
    }
    Ok(from)
}
