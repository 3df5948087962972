//! Mistakes in the description of a recording that explain it far better than any missing physics.

use std::path::Path;

use dynid_runtime::estimation::observe::{Equations, ObserveSettings, observe};
use dynid_runtime::estimation::{EstimateSettings, RecordedSettings, estimate};
use dynid_runtime::plausibility::Judged;
use dynid_runtime::recording::Side;
use dynid_runtime::signal::prepare_all;

use crate::arguments::DiagnosisOptions;
use crate::failure::Failure;
use crate::recorded::Measured;
use crate::verdict::check_mistakes;

/// Refuses a recording with a wrong sign, order, unit or robot: every law that is then found is a part of the mistake.
///
/// Motion that cannot be prepared, or determines nothing, is left to the diagnosis, which says why.
///
/// # Errors
/// [`Failure::Data`] with the mistake, and what to change.
pub fn check(path: &Path, measured: &Measured, options: &DiagnosisOptions) -> Result<(), Failure> {
    let model = measured.dynamics.model();
    let settings =
        RecordedSettings { band: options.band, cutoff: options.cutoff, rows: ObserveSettings::default() };
    let Ok((preparation, settings)) = settings.chosen(&measured.trajectories) else { return Ok(()) };
    let Ok((motions, _)) = prepare_all(&measured.trajectories, &preparation) else { return Ok(()) };
    let Ok(torques) = observe(model, &motions, Equations::Torque, None, &settings, None) else {
        return Ok(());
    };
    let found = estimate(&torques, &EstimateSettings::default());
    if found.degrees_of_freedom == 0 {
        return Ok(());
    }
    let motor_side = measured.side == Side::Motor;
    let judged = Judged { model, motions: &motions, settings: &settings, motor_side };
    check_mistakes(path, &judged, &torques, &found)
}
