//! What shows an identification row by row: its report and its file of residuals.

use dynid_runtime::model::Robot;
use dynid_runtime::model_file::Identified;
use dynid_runtime::prediction::{Predictor, evaluate, row_states};

use super::{Arguments, physical};
use crate::compared::Compared;
use crate::errors::prediction_failure;
use crate::failure::Failure;
use crate::output::{self, warn};
use crate::pages::Prior;
use crate::pages::identification::{Told, page};
use crate::provenance::Provenance;
use crate::recorded::Recorded;

/// Writes those of them that were asked for; `line` are the words of the command.
pub(super) fn write(
    arguments: &Arguments,
    line: &[String],
    recorded: &Recorded,
    whole: bool,
    identified: &Identified,
) -> Result<(), Failure> {
    let failed = |error| prediction_failure(&arguments.recording.recording, &error);
    let model = recorded.dynamics.model();
    let robot = model.robot();
    let chi = identified.chi(robot).unwrap_or_else(|_| vec![0.0; robot.base.len()]);
    let predictor = Predictor { chi: &chi, effects: &[], delay: 0.0 };
    let (motions, settings) = (&recorded.motions, &recorded.settings);
    let evaluation = evaluate(model, &[predictor], motions, settings, &[]).map_err(failed)?;
    let states = row_states(model, &chi, motions, settings).map_err(failed)?;
    let compared = Compared { robot, evaluation: &evaluation, states: &states, models: &["predicted"] };
    if let Some(path) = &arguments.residuals {
        if !whole {
            warn(&format!("{}: the recording is long: only its beginning is in it", path.display()));
        }
        compared.write(path, &recorded.joints)?;
    }
    if let Some(path) = &arguments.report {
        let mut from = Provenance::of(line);
        from.recording(&arguments.recording.recording, arguments.recording.robot.as_deref())?;
        if let Some(prior) = &arguments.prior {
            from.file(prior)?;
        }
        let prior = prior(arguments, robot)?;
        let told = Told { identified, compared, whole, prior: prior.as_ref(), from: &from };
        output::write(path, &page(recorded, told))?;
    }
    Ok(())
}

/// What was known of the parameters beforehand: the prior that was given, else the nominal values of the robot.
fn prior(arguments: &Arguments, robot: &Robot) -> Result<Option<Prior>, Failure> {
    Ok(match &arguments.prior {
        Some(path) => physical::standard_of(path, robot)?.map(|standard| {
            let values = robot.base_from_standard(&standard);
            Prior { name: "prior", values: values.into_iter().map(|v| Some((v, None))).collect() }
        }),
        None => Prior::nominal(robot),
    })
}
