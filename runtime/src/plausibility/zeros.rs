//! Zeros of encoders that are off: the table counts angles from other postures than the controller.

use super::judged::Judged;
use crate::estimation::PhysicalFit;
use crate::far_off::{INSTANTS, Instants, LEAST, zeros};
use crate::model::JointIndex;
use crate::signal::{Decimator, Motion};

/// Rows of a joint that is slower than this part of its top speed are left out: which way its friction points is not certain.
const SLOW: f64 = 0.02;

/// The zeros that leave far less of the torques, rad; `own` is the fit with those that were declared.
pub(super) fn other_zeros(judged: &Judged<'_>, own: &PhysicalFit) -> Option<Vec<(JointIndex, f64)>> {
    let found = zeros(judged.model, &instants(judged, own)?, judged.settings.threads)?;
    let any_is_far = found.of.iter().any(|(_, by)| by.abs() > LEAST);
    any_is_far.then(|| found.of.into_iter().map(|(joint, by)| (JointIndex(joint), by)).collect())
}

/// Some instants of all motions, filtered as the rows of the equations are.
fn instants(judged: &Judged<'_>, own: &PhysicalFit) -> Option<Instants> {
    let n = judged.model.robot().joints();
    let mut states = [0, 1, 2].map(|_| vec![Vec::new(); n]);
    let mut torques: Vec<Vec<f64>> = vec![Vec::new(); n];
    for motion in judged.motions {
        let Motion { q, dq, ddq, torque, rate, edge_samples, .. } = motion;
        let decimator = Decimator::for_rows(*rate, judged.settings.band, judged.settings.rate).ok()?;
        for j in 0..n {
            let [own_q, own_dq, own_ddq] = &mut states;
            let signals = [(&q[j], &mut own_q[j]), (&dq[j], &mut own_dq[j]), (&ddq[j], &mut own_ddq[j])];
            for (signal, rows) in signals.into_iter().chain([(&torque[j], &mut torques[j])]) {
                let valid = signal.len().saturating_sub(2 * edge_samples);
                let input = &signal[(*edge_samples).min(signal.len())..][..valid];
                let first = rows.len();
                rows.resize(first + decimator.kept_rows(0..valid).count, 0.0);
                decimator.decimate_run(input, &mut rows[first..]);
            }
        }
    }
    let count = torques.first().map_or(0, Vec::len);
    let every = count.div_ceil(INSTANTS).max(1);
    let kept: Vec<usize> = (0..count).step_by(every).collect();
    let fastest: Vec<f64> =
        states[1].iter().map(|dq| dq.iter().fold(0.0, |most: f64, x| most.max(x.abs()))).collect();
    let moves = |j: &usize, t: usize| states[1][*j][t].abs() > SLOW * fastest[*j];
    let rows = |&t: &usize| (0..n).filter(|j| moves(j, t)).map(|j| (j, torques[j][t])).collect();
    // What the rows of each joint are told by: what the declared robot leaves of them.
    let sigma = (0..n)
        .map(|j| {
            let rms = (torques[j].iter().map(|x| x * x).sum::<f64>() / count.max(1) as f64).sqrt();
            rms * own.per_equation.get(j).copied().flatten().unwrap_or(1.0)
        })
        .collect();
    Some(Instants {
        torques: kept.iter().map(rows).collect(),
        states: states.each_ref().map(|of| of.iter().map(|x| kept.iter().map(|&t| x[t]).collect()).collect()),
        sigma,
        parameters: judged.model.robot().base.len(),
        known: judged.model.robot().fixed_base(),
    })
}
