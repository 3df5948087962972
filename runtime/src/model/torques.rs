//! Inverse dynamics with known parameters: tau = IDM(q, dq, ddq) chi.
//! Equation numbers are those of Gautier and Briot.

use super::dynamics::Model;
use super::states::States;

/// Torques of base parameters `chi` at every sample: IDM chi of (4), `[j][t]`, N.m or N.
///
/// `chi` has one value per base parameter, in the model's order. Friction, rotor inertias and offsets are included.
///
/// # Panics
/// Where `chi` or the signals do not have the model's shape: a bug of the caller.
pub fn torques(model: &dyn Model, chi: &[f64], states: States<'_>) -> Vec<Vec<f64>> {
    let samples = states.samples();
    let mut out = vec![0.0; states.q.len() * samples];
    model.torque_block(chi, states, samples, &mut out);
    if samples == 0 {
        return vec![Vec::new(); states.q.len()];
    }
    out.chunks_exact(samples).map(<[f64]>::to_vec).collect()
}

/// [`torques`] at one state: n values.
///
/// # Panics
/// Where `chi` or the state do not have the model's shape: a bug of the caller.
pub fn torques_at(model: &dyn Model, chi: &[f64], q: &[f64], dq: &[f64], ddq: &[f64]) -> Vec<f64> {
    let mut torque = vec![0.0; model.robot().joints()];
    model.torque(chi, q, dq, ddq, &mut torque);
    torque
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
        let states: Vec<[Vec<f64>; 3]> = (0..197).map(|_| random_state(n, &mut random)).collect();
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
