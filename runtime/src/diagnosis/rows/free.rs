//! Columns of a law over any variables.

use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::series::Series;
use crate::effects::{Axis, FreeLaw, STANDSTILL, Seen, SinceReversal, Variable};

/// The columns of a law on joint `j` with a shape in one motion; `None` where the shape means no law.
pub(in crate::diagnosis) fn free_columns(
    context: &Context<'_>,
    signal: usize,
    j: usize,
    shape: &[f64],
) -> Option<Vec<Series>> {
    let s = &context.signals[signal];
    let law = FreeLaw::from_shape(shape, s.q.len())?;
    let values: Vec<Vec<f64>> = law.axes.iter().map(|a| values(context, signal, a.variable)).collect();
    let mut columns = vec![vec![0.0; s.len()]; law.amplitudes()];
    let (mut at, mut out) = (vec![Seen::default(); law.axes.len()], Vec::with_capacity(columns.len()));
    for t in 0..s.len() {
        for (k, axis) in law.axes.iter().enumerate() {
            at[k] = axis.seen_on(j, values[k][t]);
        }
        law.columns(&at, &mut out);
        for (column, &value) in columns.iter_mut().zip(&out) {
            column[t] = value;
        }
    }
    Some(columns.into_iter().map(|c| vec![(j, c)]).collect())
}

/// A variable at every sample of a motion.
pub(in crate::diagnosis) fn values(context: &Context<'_>, signal: usize, variable: Variable) -> Vec<f64> {
    let s = &context.signals[signal];
    let since = |j: usize, of: fn(&SinceReversal) -> f64| {
        let mut since = SinceReversal::default();
        let least = STANDSTILL * context.scales[j].speed;
        (0..s.len())
            .map(|t| {
                let travel = if t == 0 { 0.0 } else { s.q[j][t] - s.q[j][t - 1] };
                let dq = s.dq[j][t];
                since.advance(if dq.abs() > least { dq } else { 0.0 }, travel, 1.0 / s.rate);
                of(&since)
            })
            .collect()
    };
    match variable {
        Variable::Position(j) => s.q[j].clone(),
        Variable::Speed(j) => s.dq[j].clone(),
        Variable::Acceleration(j) => s.ddq[j].clone(),
        Variable::Load(j) => context.torques(signal).rigid[j].clone(),
        Variable::Torque(j) => context.drives(signal)[j].clone(),
        Variable::Time => (0..s.len()).map(|t| s.time(t)).collect(),
        Variable::TimeSinceReversal(j) => since(j, |s| s.time),
        Variable::TravelSinceReversal(j) => since(j, |s| s.travel),
    }
}

/// Whether one of the variables of curves is beyond the interval that these were fitted to, at every sample of a motion.
pub(in crate::diagnosis) fn beyond(context: &Context<'_>, signal: usize, axes: &[Axis]) -> Vec<bool> {
    let mut all = vec![false; context.signals[signal].len()];
    for axis in axes {
        let values = values(context, signal, axis.variable);
        all.iter_mut().zip(values).for_each(|(all, x)| *all |= (x - axis.centre).abs() > axis.half);
    }
    all
}
