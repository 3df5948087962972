//! Inverse dynamics with known parameters: tau = IDM(q, dq, ddq) chi.
//! Equation numbers are those of Gautier and Briot.

use super::dynamics::Model;
use super::states::States;

/// Samples whose regressors are held at a time.
const BLOCK: usize = 64;

/// Torques of base parameters `chi` at every sample: IDM chi of (4), `[j][t]`, N.m or N.
///
/// `chi` has one value per base parameter, in the model's order. Friction, rotor inertias and offsets are included.
///
/// # Panics
/// Where `chi` or the signals do not have the model's shape: a bug of the caller.
pub fn torques<'a>(model: &dyn Model, chi: &[f64], states: States<'a>) -> Vec<Vec<f64>> {
    let pattern = model.pattern();
    let samples = states.samples();
    let mut torques = vec![vec![0.0; samples]; states.q.len()];
    let mut entries = vec![0.0; pattern.columns.len() * BLOCK];
    for first in (0..samples).step_by(BLOCK) {
        let count = BLOCK.min(samples - first);
        let part = |signals: &[&'a [f64]]| -> Vec<&'a [f64]> {
            signals.iter().map(|x| &x[first..first + count]).collect()
        };
        let (q, dq, ddq) = (part(states.q), part(states.dq), part(states.ddq));
        model.idm_block(States { q: &q, dq: &dq, ddq: &ddq }, BLOCK, &mut entries);
        for (j, torque) in torques.iter_mut().enumerate() {
            for e in pattern.rows[j]..pattern.rows[j + 1] {
                let parameter = chi[pattern.columns[e]];
                let column = &entries[e * BLOCK..e * BLOCK + count];
                for (torque, entry) in torque[first..first + count].iter_mut().zip(column) {
                    *torque += entry * parameter;
                }
            }
        }
    }
    torques
}

/// [`torques`] at one state, with [`Model::idm`]: n values.
///
/// # Panics
/// Where `chi` or the state do not have the model's shape: a bug of the caller.
pub fn torques_at(model: &dyn Model, chi: &[f64], q: &[f64], dq: &[f64], ddq: &[f64]) -> Vec<f64> {
    let pattern = model.pattern();
    let mut entries = vec![0.0; pattern.columns.len()];
    model.idm(q, dq, ddq, &mut entries);
    pattern
        .rows
        .windows(2)
        .map(|row| (row[0]..row[1]).map(|e| entries[e] * chi[pattern.columns[e]]).sum())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::StateSlices;
    use crate::simulation::testing::{arm, random_state};
    use rand::SeedableRng;

    #[test]
    fn many_samples_have_the_torques_of_each() {
        let (model, chi) = arm();
        let n = model.robot().joints();
        let mut random = rand_pcg::Pcg64::seed_from_u64(2);
        let states: Vec<[Vec<f64>; 3]> = (0..3 * BLOCK + 5).map(|_| random_state(n, &mut random)).collect();
        let signal = |k: usize| -> Vec<Vec<f64>> {
            (0..n).map(|j| states.iter().map(|state| state[k][j]).collect()).collect()
        };
        let (q, dq, ddq) = (signal(0), signal(1), signal(2));
        let all = torques(&model, &chi, StateSlices::new(&q, &dq, &ddq).states());
        for (t, [q, dq, ddq]) in states.iter().enumerate() {
            for (j, one) in torques_at(&model, &chi, q, dq, ddq).into_iter().enumerate() {
                assert!((all[j][t] - one).abs() < 1e-11 * (1.0 + one.abs()), "joint {j}, sample {t}");
            }
        }
    }

    #[test]
    fn no_samples_have_no_torques() {
        let (model, chi) = arm();
        let none = vec![Vec::new(); model.robot().joints()];
        let torques = torques(&model, &chi, StateSlices::new(&none, &none, &none).states());
        assert_eq!(torques, none);
    }
}
