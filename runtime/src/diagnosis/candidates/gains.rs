//! Gains of the drives that a body shows.
//!
//! What is wrong with the gain of a drive is part of the parameters of an unloaded robot, and cannot be told from them there.
//! A body that is taken up shows it: each joint feels the same body, and weighs it with its own gain (Gautier and Briot
//! 2014). Beside a body that was not there before, the body's torque on each joint may therefore differ by a factor that is
//! known to be near one: it is fitted and never named.

use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::GAIN_DEVIATION;

/// A column per joint, over all rows; none where nothing is carried that was not carried before.
pub(in crate::diagnosis) fn gain_columns(context: &Context<'_>, design: &Design) -> Vec<Vec<f64>> {
    if context.carried().iter().all(|body| body.in_baseline) {
        return Vec::new();
    }
    let mut out = vec![vec![0.0; design.rows.len()]; design.joints];
    for k in (0..context.signals.len()).filter(|&k| context.signals[k].is_target) {
        let torques = context.of_new_bodies(k);
        for (j, column) in out.iter_mut().enumerate() {
            for r in design.of_signal(j, k).into_iter().flat_map(|(range, _)| range) {
                column[r] = design.smooth(k, &torques[j], design.rows[r].centre);
            }
        }
    }
    out
}

/// How much gains differ from one, given what fits with a deviation of `before` say of those that the body shows: value and
/// variance. One step of expectation and maximisation for a variance of random effects (Laird and Ware 1982), and no more
/// than what drives have.
pub(in crate::diagnosis) fn deviation_of_gains(of: &[(f64, f64)], before: f64) -> f64 {
    if of.is_empty() {
        return before;
    }
    let mean = of.iter().map(|(value, variance)| value * value + variance).sum::<f64>() / of.len() as f64;
    mean.sqrt().min(GAIN_DEVIATION)
}
