//! Observation: from motions to orthogonal factors of [W Y], one for each trajectory, block of time and equation.

mod block;
mod error;
mod merge;
mod noise_of_columns;
mod observation;
mod prepared;
// Its plans of rows are for the evaluator, which needs the feature.
#[cfg_attr(not(feature = "diagnosis"), allow(dead_code))]
mod row_plan;
mod rows;
mod select;
mod settings;
mod source;
mod standstill;
mod stream;
#[cfg(test)]
mod tests;
mod work;

pub use error::ObserveError;
pub use observation::{EquationFactor, Observation, TimeBlock};
#[cfg(feature = "diagnosis")]
pub(crate) use row_plan::{RowPlan, row_plans, why_nothing};
pub use rows::Rows;
pub use select::LeftOut;
pub use settings::{Equations, ExtraColumns, ObserveSettings, Progress};
pub use standstill::Standstill;

use crate::model::{JointIndex, Model, ParameterKind};
use crate::signal::Motion;
use prepared::Prepared;

/// Observes motions: evaluates the model at the full rate in blocks, decimates Y and every column of W with one
/// linear-phase filter, leaves out the rows that say nothing, and reduces the rest to orthogonal factors.
///
/// Neither W nor any of its columns is ever held at the full rate.
///
/// # Errors
/// Motions of another robot or with channels of unequal length; more than 32 joints; a band or rate that is not
/// positive; [`ObserveError::NoRows`] where no row is left, with the reason.
pub fn observe(
    model: &dyn Model,
    motions: &[Motion],
    equations: Equations,
    extra: Option<&dyn ExtraColumns>,
    settings: &ObserveSettings,
    progress: Option<Progress<'_>>,
) -> Result<Observation, ObserveError> {
    for (what, value) in [("band", settings.band), ("rate", settings.rate.unwrap_or(1.0))] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(ObserveError::Frequency { what, value });
        }
    }
    let detected = crate::signal::StandstillSpeeds::of(motions);
    let mut prepared = Vec::with_capacity(motions.len());
    for (trajectory, motion) in motions.iter().enumerate() {
        let source = source::source(equations, model, trajectory, motion, extra)?;
        let decimator = row_plan::decimator(motion.rate, settings)?;
        let samples = motion.q.first().map_or(0, Vec::len);
        let valid = motion.edge_samples..samples.saturating_sub(motion.edge_samples).max(motion.edge_samples);
        let grid = decimator.kept_rows(valid);
        let candidates = select::Candidates {
            trajectory,
            drive: &model.robot().drive,
            motion,
            decimator: &decimator,
            grid,
            detected: &detected,
            settings,
        };
        let selection = select::select(&candidates, equations)?;
        let columns = source.equations();
        prepared.push(Prepared { source, motion, decimator, grid, equations: columns, selection });
    }
    if prepared.iter().all(|p| p.selection.iter().all(|s| s.left_out.used == 0)) {
        let left_out = prepared.iter().flat_map(|p| &p.selection).map(|s| &s.left_out);
        let duration = |m: &Motion| m.q.first().map_or(0, Vec::len) as f64 / m.rate;
        let longest = motions.iter().map(duration).fold(0.0, f64::max);
        let reason = select::why_nothing(left_out, motions.is_empty(), longest, settings.band);
        return Err(ObserveError::NoRows { reason });
    }
    let (blocks, rows) = work::run(&prepared, settings, progress);
    let groups = work::merge(&prepared, &blocks, settings.threads);
    let robot = model.robot();
    let mut unknowns: Vec<String> = robot.base.iter().map(|p| p.name.to_string()).collect();
    if let (Some(extra), Equations::Torque) = (extra, equations) {
        unknowns.extend(extra.names().iter().cloned());
    }
    let exact = |kind| {
        matches!(kind, ParameterKind::Off | ParameterKind::Fc | ParameterKind::Fcm)
            && equations == Equations::Torque
    };
    let mut exact: Vec<bool> = robot.base.iter().map(|p| exact(robot.standard[p.standard].kind)).collect();
    exact.resize(unknowns.len(), false);
    let joint = |rows: &LeftOut| match equations {
        Equations::Torque => Some(robot.joint_number(JointIndex(rows.equation))),
        Equations::Power { .. } => None,
    };
    let numbered = |s: &select::Selection| LeftOut { joint: joint(&s.left_out), ..s.left_out.clone() };
    Ok(Observation {
        equations,
        exact,
        base: robot.base.len(),
        unknowns,
        trajectories: motions.iter().map(|m| m.name.clone()).collect(),
        rates: prepared.iter().map(|p| p.motion.rate / p.decimator.factor() as f64).collect(),
        bands: prepared.iter().map(|p| row_plan::band_of(&p.decimator, p.motion.rate)).collect(),
        noise_of_columns: noise_of_columns::noise_of_columns(
            model,
            &prepared,
            equations,
            &settings.acceleration_noise,
        ),
        groups,
        blocks,
        left_out: prepared.iter().flat_map(|p| p.selection.iter().map(numbered)).collect(),
        samples: motions.iter().map(|m| m.q.first().map_or(0, Vec::len)).sum(),
        rows,
    })
}
