//! Observation: from motions to orthogonal factors of [W Y], one for each trajectory, block of time and equation.

mod block;
mod error;
mod merge;
mod noise_of_columns;
mod observation;
mod prepared;
mod reversals;
// Its plans are for the evaluator, which needs the feature.
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

use crate::model::{JointIndex, Model, ParameterKind, Robot};
use crate::signal::Motion;
use prepared::Prepared;
use row_plan::{MotionRows, motion_rows};

/// Observes motions: evaluates the model at the full rate in blocks, decimates Y and every column of W with one
/// linear-phase filter, leaves out the rows that say nothing, and reduces the rest to orthogonal factors. Of the torque
/// equations the unknown moments at which dry friction changes its sign are eliminated.
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
    let source = |(trajectory, motion)| source::source(equations, model, trajectory, motion, extra);
    let sources = motions.iter().enumerate().map(source).collect::<Result<Vec<_>, _>>()?;
    let rows = motion_rows(model.robot(), motions, settings, equations)?;
    let prepared: Vec<Prepared<'_>> = sources
        .into_iter()
        .zip(rows)
        .zip(motions)
        .map(|((source, MotionRows { decimator, grid, selection }), motion)| {
            let own = source.equations();
            let reversals = match equations {
                Equations::Torque => reversals::columns(model.robot(), motion, &decimator, grid),
                Equations::Power { .. } => vec![Vec::new(); own.len()],
            };
            Prepared { source, motion, decimator, grid, equations: own, selection, reversals }
        })
        .collect();
    if prepared.iter().all(|p| p.selection.iter().all(|s| s.left_out.used == 0)) {
        let left_out = prepared.iter().flat_map(|p| &p.selection).map(|s| &s.left_out);
        return Err(ObserveError::NoRows { reason: select::why_nothing(left_out, motions, settings.band) });
    }
    let (mut blocks, mut rows) = work::run(&prepared, settings, progress);
    let mut groups = work::merge(&prepared, &blocks, settings.threads);
    reversals::eliminate(&prepared, &mut groups, &mut blocks, rows.as_mut());
    let robot = model.robot();
    let (unknowns, exact) = unknowns(robot, equations, extra);
    let joint = |rows: &LeftOut| match equations {
        Equations::Torque => Some(robot.joint_number(JointIndex(rows.equation))),
        Equations::Power { .. } => None,
    };
    let numbered = |s: &select::Selection| LeftOut { joint: joint(&s.left_out), ..s.left_out.clone() };
    Ok(Observation {
        equations,
        exact,
        fixed: robot.fixed_base(),
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

/// Names of the unknowns, and whether their columns have no measuring errors.
fn unknowns(
    robot: &Robot,
    equations: Equations,
    extra: Option<&dyn ExtraColumns>,
) -> (Vec<String>, Vec<bool>) {
    let mut unknowns: Vec<String> = robot.base.iter().map(|p| p.name.to_string()).collect();
    if let (Some(extra), Equations::Torque) = (extra, equations) {
        unknowns.extend(extra.names().iter().cloned());
    }
    let exact = |kind: ParameterKind| {
        let constant = matches!(kind, ParameterKind::Off | ParameterKind::KR);
        (constant || kind.is_coulomb()) && equations == Equations::Torque
    };
    let mut exact: Vec<bool> = robot.base.iter().map(|p| exact(robot.standard[p.standard].kind)).collect();
    exact.resize(unknowns.len(), false);
    (unknowns, exact)
}
