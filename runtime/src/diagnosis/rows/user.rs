//! Columns of a law that the user wrote down.

use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::free::values;
use crate::diagnosis::rows::series::Series;
use crate::effects::UserLaw;

/// The columns of a law with a shape in one motion; `None` where the robot has not all of its variables.
pub(in crate::diagnosis) fn user_columns(
    context: &Context<'_>,
    signal: usize,
    law: UserLaw,
    shape: &[f64],
) -> Option<Vec<Series>> {
    let variables = law.variables(context.model.robot()).ok()?;
    let seen: Vec<Vec<f64>> = variables.iter().map(|v| values(context, signal, *v)).collect();
    let samples = context.signals[signal].len();
    let mut columns = vec![vec![0.0; samples]; law.constants().len()];
    let (mut at, mut out) = (vec![0.0; variables.len()], vec![0.0; columns.len()]);
    for t in 0..samples {
        for (value, series) in at.iter_mut().zip(&seen) {
            *value = series[t];
        }
        law.columns(&at, shape, None, &mut out);
        for (column, &value) in columns.iter_mut().zip(&out) {
            column[t] = value;
        }
    }
    Some(columns.into_iter().map(|c| vec![(law.joint(), c)]).collect())
}
